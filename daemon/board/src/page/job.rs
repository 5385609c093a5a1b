//! One job: its versions, what it was taught from, its report, what its steps are called, and what its runs measured.

use shm_schemas::VerdictMeasure;

use super::engineer::{self, button, check, is_in_force, numbered, order_form, task};
use super::plot;
use super::technician::heads;
use crate::access::Visitor;
use crate::address::{Address, Page};
use crate::board::Board;
use crate::desk::{KnownJob, Measured, Version};
use crate::html::Html;
use crate::told::number;
use crate::words::Table;

const NOTHING_MEASURED: &str = "<section id=\"measured\"></section>";

/// What changes.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    task(html, board, words);
    versions(html, board, words, address);
    match readable(board, address) {
        Some(job) => {
            names(html, words, job);
            measured(html, words, job);
        }
        // A page that is the first to be asked for has them once the files were read.
        None => {
            html.raw("<section id=\"names\"></section>").raw(NOTHING_MEASURED);
        }
    }
}

/// The job of the page, if there is one and it has no fault.
fn readable<'b>(board: &'b Board, address: &Address) -> Option<&'b KnownJob> {
    board.desk.job(&address.at).filter(|job| job.fault.is_empty())
}

/// The whole page.
pub(super) fn draw_whole(
    html: &mut Html,
    board: &Board,
    words: &Table,
    address: &Address,
    visitor: &Visitor,
) {
    let list = Address { at: String::new(), ..address.on(Page::Engineer) };
    html.raw("<main><p class=\"turns\">").link(&list.link(), words.say("engineer.back")).raw("</p>");
    html.element("<h1>", words.say("label.job"), " ").element("", &address.at, "</h1>");
    order_form(html, address, visitor);
    draw(html, board, words, address);
    form(html, "id=\"naming\" class=\"none\"", address, visitor);
    html.raw("</form>");
    if board.desk.job(&address.at).is_none_or(|job| job.fault.is_empty()) {
        again(html, words, address, visitor);
    }
    html.raw("</main>");
}

/// What its steps are called. The names belong to a form that stands apart, so that new ones are drawn and nobody loses what they are typing.
fn names(html: &mut Html, words: &Table, job: &KnownJob) {
    html.element("<section id=\"names\"><h2>", words.say("engineer.names"), "</h2><div class=\"order\">");
    for (number, name) in (1..).zip((0..).map_while(|step| job.names.step_name(step, words))) {
        let attributes = "form=\"naming\" name=\"step\" required maxlength=\"60\"";
        numbered(html, words, ("s", "label.step", number), attributes, &name);
    }
    html.element(
        "<button form=\"naming\" name=\"do\" value=\"name\">",
        words.say("engineer.save"),
        "</button>",
    );
    html.raw("</div></section>");
}

/// What its runs measured, step by step, beside what is right.
fn measured(html: &mut Html, words: &Table, job: &KnownJob) {
    if job.measured.is_empty() {
        html.raw(NOTHING_MEASURED);
        return;
    }
    html.element("<section id=\"measured\"><h2>", words.say("engineer.measured"), "</h2><p>");
    html.element("", words.say("engineer.measured_help"), "</p><div class=\"wide\"><table><thead><tr>");
    heads(html, words, &["step_column", "measured", "shown", "runs"]);
    html.raw("</tr></thead><tbody>");
    for of_step in job.measured.chunk_by(|one, other| one.step == other.step) {
        let has_several = of_step.iter().any(|measured| measured.iu != of_step[0].iu);
        for (row, measured) in of_step.iter().enumerate() {
            html.raw("<tr>");
            if row == 0 {
                let step = u32::from(measured.step) + 1;
                let name = job.names.step_name(measured.step, words).unwrap_or_default();
                html.raw("<th scope=\"rowgroup\" rowspan=\"").text(&of_step.len().to_string()).raw("\">");
                html.text(&format!("{step}. {name}")).raw("</th>");
            }
            html.raw("<td>");
            if has_several {
                html.text(words.say("level.iu")).raw(" ").text(&(measured.iu + 1).to_string());
                html.text(words.say("label.colon"));
            }
            html.text(words.say(&format!("measure.{}", measured.measure.name()))).raw("</td><td>");
            html.text(&shown(words, measured)).raw("</td><td>");
            plot::runs(html, &measured.values, measured.right);
            html.raw("</td></tr>");
        }
    }
    html.raw("</tbody></table></div></section>");
}

/// From the least to the most that was shown, in words.
fn shown(words: &Table, measured: &Measured) -> String {
    let (Some(min), Some(max)) = (measured.values.first(), measured.values.last()) else {
        return String::new();
    };
    let (per, decimals) = match measured.measure {
        VerdictMeasure::Duration => (1.0, 1),
        VerdictMeasure::Strokes => (1.0, 0),
        _ => (100.0, 0),
    };
    let [min, max] = [min, max].map(|value| number(per * value, decimals, words));
    let range = if min == max { max } else { words.fill("range.between", &[("min", &min), ("max", &max)]) };
    words.fill(&format!("unit.{}", measured.measure.name()), &[("n", &range)])
}

/// Teaching it again with what people have said.
fn again(html: &mut Html, words: &Table, address: &Address, visitor: &Visitor) {
    html.element("<section id=\"again\"><h2>", words.say("engineer.again"), "</h2>");
    html.element("<p>", words.say("engineer.again_help"), "</p>");
    form(html, "class=\"order\"", address, visitor);
    check(html, "force", words.say("engineer.doubts"));
    html.element("<button name=\"do\" value=\"again\">", words.say("engineer.again"), "</button>");
    html.raw("</form></section>");
}

/// A form about this job, which its caller ends.
fn form(html: &mut Html, attributes: &'static str, address: &Address, visitor: &Visitor) {
    engineer::form(html, attributes, address, visitor);
    html.raw("<input type=\"hidden\" name=\"job\" value=\"").text(&address.at).raw("\">");
}

/// Its versions, its runs, and what can be asked of it. One with a fault can be rolled back.
fn versions(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    html.raw("<section id=\"versions\">");
    match board.desk.job(&address.at) {
        None => drop(html.element("<p>", words.say("engineer.unknown"), "</p>")),
        Some(job) if job.fault.is_empty() => {
            keys(html, words, job);
            table(html, board, words, job);
            runs(html, words, job);
        }
        Some(job) => {
            html.element("<p class=\"now check\" lang=\"en\">\u{25b2} ", &job.fault, "</p>");
            if !job.earlier.is_empty() {
                table(html, board, words, job);
            }
        }
    }
    html.raw("</section>");
}

fn keys(html: &mut Html, words: &Table, job: &KnownJob) {
    html.raw("<p class=\"keys\">");
    button(html, "whatif", &job.name, words.say("engineer.whatif"));
    if job.has_report {
        html.raw("<a class=\"button\" href=\"/engineer/made/report.html?at=").text(&job.name).raw("\">");
        html.text(words.say("engineer.report")).raw("</a>");
    }
    html.raw("</p>");
}

fn table(html: &mut Html, board: &Board, words: &Table, job: &KnownJob) {
    html.element("<h2>", words.say("engineer.versions"), "</h2><div class=\"wide\"><table><thead><tr>");
    heads(html, words, &["version", "taught", "runs", "steps", "use"]);
    html.raw("</tr></thead><tbody>");
    if job.fault.is_empty() {
        version(html, board, words, job, &job.version, true);
    }
    for earlier in &job.earlier {
        version(html, board, words, job, earlier, false);
    }
    html.raw("</tbody></table></div>");
}

fn runs(html: &mut Html, words: &Table, job: &KnownJob) {
    html.element("<h2>", words.say("label.runs"), "</h2><div class=\"wide\"><table><tbody>");
    for run in &job.runs {
        html.element("<tr><th scope=\"row\">", run, "</th><td>");
        button(html, "without", &format!("{}/{run}", job.name), words.say("engineer.without"));
        html.raw("</td></tr>");
    }
    html.raw("</tbody></table></div>");
}

fn version(html: &mut Html, board: &Board, words: &Table, job: &KnownJob, version: &Version, is_own: bool) {
    html.element("<tr><th scope=\"row\"><code>", &version.hash, "</code></th>");
    html.element("<td>", &version.date, "");
    if version.has_report {
        let word = words.say("engineer.report_of");
        html.raw(" <a href=\"/engineer/made/report.html?at=").text(&job.name).raw(".").text(&version.hash);
        html.raw("\" aria-label=\"").text(word).raw(" ").text(&version.date).element("\">", word, "</a>");
    }
    html.raw("</td>");
    for number in [version.runs, version.steps] {
        html.element("<td>", &number.to_string(), "</td>");
    }
    html.raw("<td>");
    let is_in_force = is_in_force(board, &version.hash);
    if is_in_force {
        html.element("\u{2713} ", words.say("engineer.in_force"), " ");
    }
    if !is_own {
        // Also one by which the line still judges: the file of the job is another one.
        let value = format!("{}/{}", job.name, version.hash);
        button(html, "back", &value, words.say("engineer.roll_back"));
    } else if !is_in_force {
        button(html, "load", &job.name, words.say("engineer.load"));
    }
    html.raw("</td></tr>");
}
