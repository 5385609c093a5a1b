// @ts-check
"use strict";

// The server draws the pages. This replaces what is new on them, and says by itself when nothing is heard of the server.

/** Three beats of the server: one may be late. */
const SILENT_MS = 850;
/** A connection that is silent for so long is made anew: the network may have swallowed it. */
const RENEW_MS = 3000;
const LOOK_MS = 50;

const lost = /** @type {HTMLElement} */ (document.getElementById("lost"));
const address = document.body.dataset.events ?? "/events";
let heard = performance.now();
let opened = heard;
let source = connect();

function connect() {
    const stream = new EventSource(address);
    opened = performance.now();
    stream.addEventListener("alive", hear);
    stream.addEventListener("show", (message) => {
        hear();
        show(message.data);
    });
    return stream;
}

function hear() {
    heard = performance.now();
    lost.hidden = true;
}

/** @param {string} drawn elements of the page, each with its id */
function show(drawn) {
    const fresh = new DOMParser().parseFromString(drawn, "text/html").body;
    for (const element of Array.from(fresh.children)) {
        const shown = document.getElementById(element.id);
        // What is as it was is left alone, with its focus and whatever is marked in it.
        if (shown && shown.outerHTML !== element.outerHTML) {
            replace(shown, element);
        }
    }
}

/**
 * @param {HTMLElement} shown
 * @param {Element} fresh
 */
function replace(shown, fresh) {
    const focus = shown.contains(document.activeElement) ? document.activeElement?.getAttribute("href") : null;
    shown.replaceWith(document.importNode(fresh, true));
    if (focus) {
        /** @type {HTMLElement | null} */ (document.querySelector(`a[href="${CSS.escape(focus)}"]`))?.focus();
    }
}

function look() {
    const now = performance.now();
    lost.hidden = now - heard < SILENT_MS;
    const isSilent = now - Math.max(heard, opened) > RENEW_MS;
    const isRefused = source.readyState === EventSource.CLOSED && now - opened > 1000;
    if (isSilent || isRefused) {
        source.close();
        source = connect();
    }
}

setInterval(look, LOOK_MS);
