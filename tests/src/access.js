// What is wrong with a page for people who see little, use the keyboard, or wear gloves: one sentence for each fault.
(() => {
    const faults = [];
    const shown = (element) => element.checkVisibility();
    const all = (selector) => [...document.querySelectorAll(selector)].filter(shown);
    const named = (element) => element.outerHTML.slice(0, 90);

    // Contrast by the formula of WCAG 2, of the colours that the browser has computed.
    const channels = (color) => color.match(/[\d.]+/g).map(Number);
    const part = (value) => (value /= 255) <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
    const luminance = ([r, g, b]) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
    const behind = (element) => {
        for (; element; element = element.parentElement) {
            const color = channels(getComputedStyle(element).backgroundColor);
            if (color.length < 4 || color[3] > 0) return color;
        }
        return [255, 255, 255];
    };
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let text = texts.nextNode(); text; text = texts.nextNode()) {
        const element = text.parentElement;
        if (!text.data.trim() || !shown(element)) continue;
        const style = getComputedStyle(element);
        const color = element.namespaceURI.endsWith("svg") ? style.fill : style.color;
        const [dark, light] = [channels(color), behind(element)].map(luminance).sort((one, other) => one - other);
        const contrast = (light + 0.05) / (dark + 0.05);
        if (contrast < 4.5) faults.push(`contrast of ${contrast.toFixed(2)}: ${text.data.slice(0, 60)}`);
    }

    // At 96 dots per inch 15 mm are 56 pixels. Where a mouse points, a link in a table or a sentence has the 24 of WCAG 2.2.
    const size = (element, least) => {
        const { width, height } = element.getBoundingClientRect();
        if (width < least || height < least) faults.push(`${width.toFixed()} x ${height.toFixed()} pixels: ${named(element)}`);
    };
    const isTouched = matchMedia("(pointer: coarse)").matches;
    const large = all(`button, select, summary, input:not([type=hidden]), ${isTouched ? "a" : "a.button, footer a, .turns a"}`);
    large.forEach((element) => size(element, 56));
    all("a").filter((link) => !large.includes(link)).forEach((link) => size(link, 24));

    // Headings, landmarks and languages.
    const levels = all("h1, h2, h3, h4").map((heading) => Number(heading.tagName[1]));
    if (levels.filter((level) => level === 1).length !== 1) faults.push(`headings of the first level: ${levels}`);
    levels.forEach((level, place) => place > 0 && level > levels[place - 1] + 1 && faults.push(`a level is left out: ${levels}`));
    if (all("main").length !== 1) faults.push("there is not one main");
    const landmarks = all("nav").map((nav) => nav.getAttribute("aria-label"));
    if (new Set(landmarks).size !== landmarks.length || landmarks.includes(null)) faults.push(`landmarks: ${landmarks}`);
    if (!document.documentElement.lang || !document.title.trim()) faults.push("the page has no language or no title");

    // Names of what is used, and of what is seen.
    const labelled = (field) => field.labels?.length || field.getAttribute("aria-label");
    all("select, input:not([type=hidden])").forEach((field) => labelled(field) || faults.push(`no label: ${named(field)}`));
    all("a, button").forEach((control) => control.textContent.trim() || faults.push(`no name: ${named(control)}`));
    all("img").forEach((image) => image.alt || faults.push(`no text instead: ${named(image)}`));
    all("svg").filter((svg) => !svg.closest("[aria-hidden=true]") && !svg.getAttribute("aria-label") && !svg.querySelector(":scope > title"))
        .forEach((svg) => faults.push(`no name: ${named(svg)}`));
    all("thead th").forEach((head) => head.scope || faults.push(`no scope: ${named(head)}`));

    // Order and identity.
    const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
    ids.filter((id, place) => ids.indexOf(id) !== place).forEach((id) => faults.push(`two have the id ${id}`));
    all("[tabindex]").filter((element) => element.tabIndex > 0).forEach((element) => faults.push(`an order of its own: ${named(element)}`));
    if (document.documentElement.scrollWidth > innerWidth) faults.push("it is wider than the window");
    return faults;
})()
