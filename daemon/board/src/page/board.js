// @ts-check
"use strict";

// The server draws the pages. This replaces what is new on them, and says by itself when nothing is heard of the server.

// A page without this loads itself again: what says so comes next, and becomes a comment here. A browser without scripts and one that lost the server
// before it got this are the same to it.
document.write("<!--");

/** Three beats of the server: one may be late. */
const SILENT_MS = 850;
/** A connection that is silent for so long is made anew: the network may have swallowed it. A page that is not whole is loaded again after as long. */
const RENEW_MS = 3000;
const LOOK_MS = 50;
/** What somebody uses, and what can have the focus. */
const USED = "[name], [href]";
const FOCUSED = "a[href], button, select, input:not([type=hidden]), [tabindex]";

let heard = performance.now();
let opened = heard;
/** Whether the page has its style and its other scripts, as far as they were loaded. */
let isWhole = true;
/** @type {EventSource | null} */
let source = null;

/**
 * What lies over the page.
 * @param {"lost" | "elsewhere"} id
 */
function over(id) {
    return /** @type {HTMLElement} */ (document.getElementById(id));
}

/** The name of this browser. It keeps six connections to one place for all its tabs, so the server limits the feeds of each name. */
function browser() {
    const fresh = Math.random().toString(36).slice(2);
    try {
        const known = localStorage.getItem("browser") ?? fresh;
        localStorage.setItem("browser", known);
        return known;
    } catch {
        return fresh;
    }
}

/** Begins to watch, if somebody can see this page and it does not watch. */
function watch() {
    if (source || document.hidden) {
        return;
    }
    over("elsewhere").hidden = true;
    heard = performance.now();
    source = connect();
}

function rest() {
    source?.close();
    source = null;
    over("lost").hidden = true;
}

function connect() {
    const stream = new EventSource(`${document.body.dataset.events}&browser=${browser()}`);
    opened = performance.now();
    stream.addEventListener("alive", hear);
    stream.addEventListener("show", (message) => {
        hear();
        show(message.data);
    });
    stream.addEventListener("elsewhere", () => {
        rest();
        over("elsewhere").hidden = false;
    });
    // Who looks may not see this any more: the board says so to a page that is loaded.
    stream.addEventListener("again", () => location.reload());
    return stream;
}

function hear() {
    heard = performance.now();
    over("lost").hidden = true;
    if (!isWhole && heard > RENEW_MS) {
        location.reload();
    }
}

/** @param {string} drawn elements of the page, each with its id */
function show(drawn) {
    const fresh = new DOMParser().parseFromString(drawn, "text/html").body;
    const focused = document.activeElement;
    const around = ancestors(focused);
    for (const element of Array.from(fresh.children)) {
        const shown = document.getElementById(element.id);
        if (shown) {
            follow(shown, element);
        }
    }
    if (focused && !focused.isConnected) {
        // Who uses the keyboard goes on beside what has gone.
        const rest = around.find((element) => element.isConnected && element.querySelector(FOCUSED));
        /** @type {HTMLElement | null | undefined} */ (rest?.querySelector(FOCUSED))?.focus();
    }
}

/**
 * What an element lies in, from inside to outside.
 * @param {Element | null} element
 */
function ancestors(element) {
    const found = [];
    for (let parent = element?.parentElement; parent; parent = parent.parentElement) {
        found.push(parent);
    }
    return found;
}

/**
 * Makes a node as it was drawn anew. What is in both stays in its place, with its focus, with what is marked in it, and as far as it is scrolled.
 * @param {Node} shown
 * @param {Node} fresh
 */
function follow(shown, fresh) {
    if (shown.isEqualNode(fresh)) {
        return;
    }
    if (!(shown instanceof Element && fresh instanceof Element)) {
        shown.nodeValue = fresh.nodeValue;
        return;
    }
    for (const { name } of Array.from(shown.attributes).filter(({ name }) => !fresh.hasAttribute(name))) {
        shown.removeAttribute(name);
    }
    for (const { name, value } of Array.from(fresh.attributes)) {
        // An image that is given its address again is loaded again.
        if (shown.getAttribute(name) !== value) {
            shown.setAttribute(name, value);
        }
    }
    let next = shown.firstChild;
    for (const child of Array.from(fresh.childNodes)) {
        const same = counterpart(next, child);
        if (same) {
            removeUntil(next, same);
            follow(same, child);
            next = same.nextSibling;
        } else {
            shown.insertBefore(document.importNode(child, true), next);
        }
    }
    removeUntil(next, null);
}

/**
 * What a node stands for: its id, or else what its first input, button or link says or leads to. Nothing of another thing may stay in its place, as a
 * tick, the focus, or a button that is just being pressed.
 * @param {ChildNode} node
 */
function meaning(node) {
    if (!(node instanceof Element)) {
        return node.nodeName;
    }
    if (node.id) {
        return `${node.nodeName} ${node.id}`;
    }
    const first = node.matches(USED) ? node : node.querySelector(USED);
    const said = ["name", "value", "href"].map((name) => first?.getAttribute(name) ?? "");
    return [node.nodeName, ...said].join(" ");
}

/**
 * The node among these siblings that was drawn for the same.
 * @param {ChildNode | null} first
 * @param {ChildNode} fresh
 */
function counterpart(first, fresh) {
    const wanted = meaning(fresh);
    let node = first;
    while (node && meaning(node) !== wanted) {
        node = node.nextSibling;
    }
    return node;
}

/**
 * @param {ChildNode | null} first
 * @param {ChildNode | null} end which stays, as all behind it do
 */
function removeUntil(first, end) {
    for (let node = first; node && node !== end; ) {
        const next = node.nextSibling;
        node.remove();
        node = next;
    }
}

function look() {
    if (!source) {
        return;
    }
    const now = performance.now();
    over("lost").hidden = now - heard < SILENT_MS;
    const isSilent = now - Math.max(heard, opened) > RENEW_MS;
    const isRefused = source.readyState === EventSource.CLOSED && now - opened > 1000;
    if (isSilent || isRefused) {
        source.close();
        source = connect();
    }
}

/** Between two pictures: a hand is followed, and the line has better things to do. */
const PICTURE_MS = 150;
const NO_PICTURE_MS = 1000;
let pictures = 0;

/**
 * The next picture is asked for when this one is shown, so that a slow browser gets fewer and none too late.
 * @param {HTMLImageElement} picture
 */
function see(picture) {
    if (!document.hidden) {
        const next = new URL(picture.src);
        // What has the same address is not loaded again.
        next.searchParams.set("picture", String(++pictures));
        picture.src = next.href;
    }
}

/** @param {HTMLImageElement} picture */
function keepSeeing(picture) {
    const alt = picture.alt;
    const again = () => see(picture);
    picture.addEventListener("load", () => {
        picture.alt = alt;
        setTimeout(again, PICTURE_MS);
    });
    picture.addEventListener("error", () => {
        picture.alt = picture.dataset.none ?? "";
        setTimeout(again, NO_PICTURE_MS);
    });
    document.addEventListener("visibilitychange", again);
    again();
}

addEventListener(
    "error",
    ({ target }) => {
        isWhole &&= !(target instanceof HTMLLinkElement || target instanceof HTMLScriptElement);
    },
    true,
);
document.addEventListener("DOMContentLoaded", () => {
    // A page that nobody sees gives its connection back. One that made way for another watches again once somebody turns to it.
    document.addEventListener("visibilitychange", () => (document.hidden ? rest() : watch()));
    for (const turned of ["focus", "pointerdown", "keydown"]) {
        addEventListener(turned, watch);
    }
    const picture = document.getElementById("picture");
    if (picture instanceof HTMLImageElement) {
        keepSeeing(picture);
    }
    watch();
    setInterval(look, LOOK_MS);
});
