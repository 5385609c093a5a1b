//! The report as a page.

use super::noticed::cells;
use super::order;
use super::report::{IuReport, TeachReport, range};
use super::statement::Statement;
use crate::distribution::STRIP;
use crate::html::{document, escaped};
use crate::job_file::JobFile;

/// The report of a job as one self-contained HTML page. `picture` is the drawing of its steps and their order, as SVG.
pub fn page(report: &TeachReport, picture: &str) -> String {
    let job = &report.job;
    let title = format!("Job {} “{}”", job.id, job.name);
    let mut body = format!("<h1>{}</h1>", escaped(&title));
    body += &summary(report);
    body += "<h2>The steps and their order</h2>";
    body += &figure(
        picture,
        "How to read it: each step is below those that come before it, in the column of the hand that does it. What all runs show is law where \
         the evidence is enough; otherwise another order is only noted.",
    );
    body += &list("ol", order::steps(job).map(|(name, sentences)| step(&name, &sentences)));
    body += &list("ul", report.findings().iter().map(Statement::html));
    body += "<h2>What was learned of each IU</h2>";
    body += &learned(report);
    if report.has_measures() {
        body += "<h2>What would be noticed</h2>";
        body += &noticed(report);
    }
    body += "<h2>The recordings</h2>";
    body += &recordings(job);
    document(&title, &body)
}

/// The one sentence, what to do about each doubt, and the notes.
fn summary(report: &TeachReport) -> String {
    let class = if report.is_trusted() { "say" } else { "say no" };
    let lines: String = report.summary().iter().map(|line| format!("<div>{}</div>", line.html())).collect();
    let notes = list("ul", report.warnings().iter().map(Statement::html));
    let strip =
        if report.has_distributions() { format!("<figcaption>{STRIP}</figcaption>") } else { String::new() };
    format!("<div class=\"{class}\">{lines}</div>{strip}{notes}")
}

fn step(name: &str, sentences: &[String]) -> String {
    let sentences = list("ul", sentences.iter().map(|sentence| escaped(sentence)));
    format!("{}{sentences}", escaped(name))
}

fn learned(report: &TeachReport) -> String {
    let cells = |iu: &IuReport| {
        let [name, number] = place(&report.job, iu);
        let context = escaped(&report.words(iu.taught.context));
        let seconds = range(iu.taught.frames, |frames| report.seconds(frames)).replace(' ', "\u{a0}");
        let reversals = range(iu.taught.reversals, |count| count.to_string());
        let distance = format!("{:.2}\u{a0}±\u{a0}{:.2}", iu.distance[0], iu.distance[1]);
        let threshold = iu.threshold_words();
        vec![
            name,
            number,
            context,
            iu.taught.demonstrations.to_string(),
            seconds,
            reversals,
            distance,
            threshold,
        ]
    };
    let head = ["step", "IU", "what touches what", "shown", "seconds", "reversals", "distance", "threshold"];
    table(
        &head,
        &["step", "what touches what"],
        report.ius.iter().map(cells),
        "How to read it: one row for each Interaction Unit (IU), the time in which a hand touches the same objects. Shown is the number of \
         demonstrations. Seconds and reversals of the motion are from the minimum to the maximum that is right. Distance is how far the motions of \
         the demonstrations are from the learned one (DTW), mean and standard deviation. Threshold is the maximum that is right.",
    )
}

fn noticed(report: &TeachReport) -> String {
    let rows = report.ius.iter().filter_map(|iu| {
        let name = place(&report.job, iu);
        Some(name.into_iter().chain(cells(&iu.taught, report.rate_hz())?).collect())
    });
    let head =
        ["step", "IU", "strokes", "seconds", "path cm", "lateral cm", "stroke cm", "place cm", "degrees"];
    let table = table(
        &head,
        &["step"],
        rows,
        "How to read it: the smallest difference from what was shown that would be noticed: by how much less, and by how much more. Any is a \
         difference that is not looked for.",
    );
    format!("{table}{}", list("ul", report.promise().iter().map(|line| escaped(line))))
}

fn recordings(job: &JobFile) -> String {
    let rows = job.provenance.sources.iter().map(|source| {
        let used = if source.left_out { "left out" } else { "yes" };
        vec![escaped(&source.name), used.to_owned(), source.sha256.chars().take(16).collect()]
    });
    let head = ["name", "used", "SHA-256 begins with"];
    table(
        &head,
        &head,
        rows,
        "How to read it: the recordings that the job was taught from; one that was left out disagrees with the others.",
    )
}

fn place(job: &JobFile, iu: &IuReport) -> [String; 2] {
    let step = format!("{}. {}", iu.activity + 1, job.step_name(usize::from(iu.activity)));
    [escaped(&step), (iu.iu + 1).to_string()]
}

/// A table of cells that are HTML already, with how to read it. The columns with the names in `words` hold words, the others numbers.
fn table(
    head: &[&str],
    words: &[&str],
    rows: impl Iterator<Item = Vec<String>>,
    how_to_read: &str,
) -> String {
    let row = |tag: &str, cells: &mut dyn Iterator<Item = String>| {
        let cell = |(name, cell): (&&str, String)| {
            let class = if words.contains(name) { " class=\"l\"" } else { "" };
            format!("<{tag}{class}>{cell}</{tag}>")
        };
        let cells: String = head.iter().zip(cells).map(cell).collect();
        format!("<tr>{cells}</tr>")
    };
    let head = row("th", &mut head.iter().map(|cell| (*cell).to_owned()));
    let rows: String = rows.map(|cells| row("td", &mut cells.into_iter())).collect();
    format!(
        "<div class=\"scroll\"><table>{head}{rows}</table></div><figcaption>{}</figcaption>",
        escaped(how_to_read)
    )
}

fn figure(svg: &str, how_to_read: &str) -> String {
    format!("<figure>{svg}<figcaption>{}</figcaption></figure>", escaped(how_to_read))
}

/// A list of items that are HTML already; nothing where there is none.
fn list(kind: &str, items: impl Iterator<Item = String>) -> String {
    let items: String = items.map(|item| format!("<li>{item}</li>")).collect();
    if items.is_empty() { items } else { format!("<{kind}>{items}</{kind}>") }
}
