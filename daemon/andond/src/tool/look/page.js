"use strict";

// The next picture is asked for when this one is shown, so that a slow browser gets fewer and none too late.
const picture = document.getElementById("picture");
const source = document.getElementById("source");
const lines = document.getElementById("lines");
const PAUSE_MS = 100;

async function fetched(path) {
    const answer = await fetch(path, { cache: "no-store" });
    if (!answer.ok) {
        throw new Error(answer.statusText);
    }
    return answer;
}

function row(line) {
    const row = document.createElement("tr");
    row.className = line.is_good ? "good" : "improve";
    for (const words of [line.is_good ? "\u2713 ok" : "\u25b2 improve", line.about, line.sentence]) {
        row.insertCell().textContent = words;
    }
    return row;
}

async function show() {
    const blob = await (await fetched("newest.jpg")).blob();
    const said = await (await fetched("newest.json")).text();
    if (blob.size > 0 && said) {
        const words = JSON.parse(said);
        const before = picture.src;
        picture.src = URL.createObjectURL(blob);
        await picture.decode();
        URL.revokeObjectURL(before);
        source.textContent = words.source;
        source.className = "";
        lines.replaceChildren(...words.lines.map(row));
    }
}

async function run() {
    for (;;) {
        try {
            await show();
        } catch {
            source.textContent = "andond look has ended, or does not answer";
            source.className = "lost";
        }
        await new Promise((done) => setTimeout(done, PAUSE_MS));
    }
}

run();
