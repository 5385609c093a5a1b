// @ts-check
"use strict";

// The film of an event, picture by picture at its own pace. Without this, the links and the form of the page lead through it.

(() => {
    const player = document.getElementById("player");
    if (!player) {
        return;
    }
    /** Pictures that are asked for before their time comes. A browser keeps six connections, and one is for what is new. */
    const AHEAD = 5;
    /** Pictures that are kept: those around the one that is shown. */
    const KEPT = 32;
    /** Who is later than this goes on from where it is, instead of catching up. */
    const LATE_MS = 100;

    /** @param {string} id */
    const of = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
    const slide = /** @type {HTMLInputElement} */ (of("slide"));
    const [previous, next] = ["previous", "next"].map((id) => /** @type {HTMLAnchorElement} */ (of(id)));
    const button = of("play");
    const times = (player.dataset.times ?? "").split(" ").map(Number);
    const last = times.length - 1;
    const alt = of("frame").getAttribute("alt") ?? "";
    /** @type {Map<number, Promise<HTMLImageElement>>} */
    const pictures = new Map();
    let at = Number(slide.value);
    let isPlaying = false;

    /** @param {number} frame */
    function picture(frame) {
        const known = pictures.get(frame);
        if (known) {
            return known;
        }
        const image = new Image();
        image.src = `${player?.dataset.frames}&frame=${frame}`;
        image.alt = alt;
        const loaded = image.decode().then(() => image);
        // What has failed is asked for again.
        loaded.catch(() => pictures.delete(frame));
        pictures.set(frame, loaded);
        for (const other of pictures.keys()) {
            if (pictures.size > KEPT && Math.abs(other - frame) > AHEAD) {
                pictures.delete(other);
            }
        }
        return loaded;
    }

    /**
     * Shows a picture as soon as it is there. False where it cannot be had.
     * @param {number} frame
     */
    async function show(frame) {
        at = frame;
        say();
        try {
            const image = await picture(frame);
            if (at === frame) {
                image.id = "frame";
                of("frame").replaceWith(image);
            }
            of("frame_lost").hidden = true;
            return true;
        } catch {
            of("frame_lost").hidden = false;
            return false;
        }
    }

    /** Says which picture it is, and lets the address keep it. */
    function say() {
        const seconds = (Math.abs(times[at]) / 1000).toFixed(2).replace(".", player?.dataset.decimal ?? ".");
        const second = `${times[at] < 0 ? "\u2212" : "+"}${seconds} s`;
        slide.value = String(at);
        slide.setAttribute("aria-valuetext", second);
        of("second").textContent = second;
        previous.href = link(location.href, Math.max(0, at - 1));
        next.href = link(location.href, Math.min(last, at + 1));
        if (!isPlaying) {
            history.replaceState(null, "", link(location.href, at));
            for (const other of /** @type {NodeListOf<HTMLAnchorElement>} */ (document.querySelectorAll("footer a[hreflang]"))) {
                other.href = link(other.href, at);
            }
        }
    }

    /**
     * The same address with this picture.
     * @param {string} address
     * @param {number} frame
     */
    function link(address, frame) {
        const changed = new URL(address);
        changed.searchParams.set("frame", String(frame));
        return changed.href;
    }

    /** @param {boolean} plays */
    function set(plays) {
        isPlaying = plays;
        button.textContent = (plays ? button.dataset.pause : button.dataset.play) ?? "";
    }

    async function play() {
        set(true);
        let began = performance.now() - times[at];
        while (isPlaying && at < last) {
            const frame = at + 1;
            for (let ahead = frame; ahead <= Math.min(last, at + AHEAD); ahead++) {
                picture(ahead).catch(() => undefined);
            }
            await picture(frame).catch(() => undefined);
            const early = times[frame] - (performance.now() - began);
            if (early > 0) {
                await new Promise((done) => setTimeout(done, early));
            } else if (early < -LATE_MS) {
                began -= early;
            }
            // Somebody may have paused it, or gone elsewhere.
            if (isPlaying && at === frame - 1 && !(await show(frame))) {
                break;
            }
        }
        set(false);
        say();
    }

    /**
     * Goes to a picture and stays there.
     * @param {number} frame
     */
    function go(frame) {
        set(false);
        show(Math.max(0, Math.min(last, frame)));
    }

    button.hidden = false;
    of("go").hidden = true;
    button.addEventListener("click", () => {
        if (isPlaying) {
            go(at);
            return;
        }
        at = at < last ? at : 0;
        play();
    });
    slide.addEventListener("input", () => go(Number(slide.value)));
    for (const [step, by] of /** @type {[HTMLElement, number][]} */ ([[previous, -1], [next, 1]])) {
        step.addEventListener("click", (event) => {
            event.preventDefault();
            go(at + by);
        });
    }
    // Every form of the page leads back to the picture that is shown.
    document.addEventListener("formdata", (event) => event.formData.set("frame", String(at)));
    const shown = /** @type {HTMLImageElement} */ (of("frame"));
    const isLost = () => (of("frame_lost").hidden = false);
    shown.addEventListener("error", isLost);
    if (shown.complete && shown.naturalWidth === 0) {
        isLost();
    }
})();
