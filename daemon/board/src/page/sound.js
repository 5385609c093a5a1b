// @ts-check
"use strict";

// Two short tones once the worker's page says that something is wrong. A browser lets no page sound that nobody has touched, unless it is told to.

(() => {
    const HERTZ = 880;
    const LENGTH_S = 0.18;
    const context = new AudioContext();
    const wake = () => void context.resume().catch(() => undefined);
    for (const touch of ["pointerdown", "keydown"]) {
        addEventListener(touch, wake);
    }

    /** @param {number} after seconds from now on */
    function tone(after) {
        const [from, to] = [context.currentTime + after, context.currentTime + after + LENGTH_S];
        const [oscillator, volume] = [context.createOscillator(), context.createGain()];
        oscillator.frequency.value = HERTZ;
        // It swells and fades, so that it does not click.
        volume.gain.setValueAtTime(0, from);
        volume.gain.linearRampToValueAtTime(0.4, from + LENGTH_S / 4);
        volume.gain.linearRampToValueAtTime(0, to);
        oscillator.connect(volume).connect(context.destination);
        oscillator.start(from);
        oscillator.stop(to);
    }

    const isFault = () => document.getElementById("view")?.className === "fault";
    let was = isFault();
    new MutationObserver(() => {
        const is = isFault();
        // Where it may not sound yet, nothing is kept to be heard later.
        if (is && !was && context.state === "running") {
            tone(0);
            tone(2 * LENGTH_S);
        }
        was = is;
    }).observe(document.body, { childList: true, subtree: true });
})();
