// @ts-check
"use strict";

// Sends a recording to the line, in pieces: each once the one before it was kept, so that it costs the line little.

(() => {
    const form = /** @type {HTMLFormElement | null} */ (document.getElementById("upload"));
    const choice = /** @type {HTMLInputElement | null} */ (document.getElementById("recording"));
    const told = document.getElementById("sent");
    const [send, cancel] = Array.from(form?.querySelectorAll("button") ?? []);
    if (!form || !choice || !told || !send || !cancel) {
        return;
    }
    const PIECE_BYTES = Number(form.dataset.piece);
    const TRIES = 3;
    const AGAIN_MS = 1000;
    const NAME = 56;
    let isSending = false;
    let isStopped = false;

    /**
     * A name that the line takes, as near as possible to that of the file.
     * @param {string} name
     */
    function plain(name) {
        const spelled = name.replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[^A-Za-z0-9]+/, "");
        const dot = spelled.lastIndexOf(".");
        const ending = dot > 0 ? spelled.slice(dot) : "";
        return spelled.slice(0, spelled.length - ending.length).slice(0, NAME - ending.length) + ending;
    }

    /**
     * As letters of six bits each, which a form carries as they are.
     * @param {ArrayBuffer} bytes
     */
    function letters(bytes) {
        let text = "";
        for (const byte of new Uint8Array(bytes)) {
            text += String.fromCharCode(byte);
        }
        return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
    }

    /** @param {Record<string, string | number>} pairs */
    function post(pairs) {
        const body = new URLSearchParams(Array.from(new FormData(form ?? undefined), ([key, value]) => [key, String(value)]));
        for (const [key, value] of Object.entries(pairs)) {
            body.set(key, String(value));
        }
        return fetch("/engineer/order", { method: "POST", body, redirect: "manual" });
    }

    /**
     * What is said of a piece that is not kept; null where it is. The words of the line are English.
     * @param {Record<string, string | number>} pairs
     * @returns {Promise<(string | Node)[] | null>}
     */
    async function piece(pairs) {
        for (let left = TRIES - 1; ; left--) {
            const answer = await post(pairs).catch(() => null);
            if (answer?.ok) {
                return null;
            }
            if (answer?.status === 409) {
                const why = document.createElement("span");
                [why.lang, why.textContent] = ["en", await answer.text()];
                return [`${form?.dataset.failed} `, why];
            }
            const isTemporary = !answer || answer.status === 503;
            if (!isTemporary || left === 0) {
                return [form?.dataset.lost ?? ""];
            }
            await new Promise((resolve) => setTimeout(resolve, AGAIN_MS));
        }
    }

    /** @param {(string | Node)[]} texts */
    function say(...texts) {
        told?.replaceChildren(...texts);
    }

    /** @param {File} file */
    async function sendAll(file) {
        const about = { do: "film", film: Math.floor(Math.random() * Number.MAX_SAFE_INTEGER), name: plain(file.name), size: file.size };
        for (let at = 0; at < file.size; at += PIECE_BYTES) {
            say(`${Math.floor((100 * at) / file.size)} %`);
            const bytes = letters(await file.slice(at, at + PIECE_BYTES).arrayBuffer());
            const why = await piece({ ...about, at, piece: bytes });
            if (why) {
                say(...why);
                return;
            }
            if (isStopped) {
                await piece({ ...about, size: 0, at: 0, piece: "" });
                say(form?.dataset.stopped ?? "");
                return;
            }
        }
        say(`${form?.dataset.done} ${about.name}`);
    }

    form.addEventListener("submit", async (event) => {
        event.preventDefault();
        const file = choice.files?.[0];
        if (!file || isSending) {
            return;
        }
        if (file.size === 0 || file.size > Number(form.dataset.most)) {
            say(form.dataset.size ?? "");
            return;
        }
        [isSending, isStopped] = [true, false];
        [send.hidden, cancel.hidden] = [true, false];
        await sendAll(file).catch(() => say(form.dataset.lost ?? ""));
        isSending = false;
        [send.hidden, cancel.hidden] = [false, true];
    });
    cancel.addEventListener("click", () => {
        isStopped = true;
    });
    form.hidden = false;
})();
