//! The steps of a job and their order, from top to bottom: one column for each hand, an arrow for each relation.

use andon_core::input::Side;
use andon_learn::job_file::{JobFile, Relation, RelationKind};
use andon_learn::recording::incidental_pairs;
use andon_learn::svg::Svg;

/// Width and height of a step, and the room beside and below it, in pixels.
const STEP: [f64; 2] = [250.0, 80.0];
const ROOM: [f64; 2] = [26.0, 60.0];

/// Above the steps are the names of the hands, below them is the legend. Between the hands run the arrows that pass other steps.
const HEAD: f64 = 44.0;
const LEGEND: f64 = 122.0;
const MARGIN: f64 = 20.0;

/// The distance of two arrows that run side by side.
const TRACK: f64 = 14.0;

/// Letters in a line of a step, at about 6.5 pixels each.
const LETTERS: usize = 36;

/// The number of names of runs that fit below the picture.
const NAMES: usize = 3;

/// Ends of arrows: they have no colour of their own, because a marker takes none from its line everywhere.
const ARROWHEADS: &str = "<defs><marker id=\"law\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"8\" markerHeight=\"8\" orient=\"auto\">\
    <path class=\"lh\" d=\"M0 0L10 5L0 10z\"/></marker><marker id=\"note\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"8\" markerHeight=\"8\" \
    orient=\"auto\"><path class=\"nh\" d=\"M0 0L10 5L0 10z\"/></marker></defs>";

/// Draws the steps of a job. `rejected` are the runs that the others would have rejected, where that was tried.
pub fn draw_order(job: &JobFile, rejected: Option<&[String]>) -> String {
    let layout = Layout::of(job);
    let [width, height] = layout.size();
    let mut svg = Svg::new(width, height, &format!("the order of the steps of {}", job.name));
    svg.add(format_args!("{ARROWHEADS}"));
    for (side, x) in [(Side::Left, layout.lanes[0]), (Side::Right, layout.lanes[1])] {
        if layout.places.iter().any(|place| place.side == side) {
            svg.text(x, MARGIN + 12.0, "n", &format!("{} hand", side.name()));
        }
    }
    let arrows = arrows(job);
    let mut track = 0.0;
    for arrow in &arrows {
        layout.arrow(&mut svg, arrow, &arrows, &mut track);
    }
    for number in 0..job.steps.len() {
        layout.step(&mut svg, job, number);
    }
    legend(&mut svg, height - LEGEND + 18.0, job, rejected);
    svg.finish()
}

/// Where a step is drawn.
struct Place {
    side: Side,
    x: f64,
    y: f64,
}

struct Layout {
    places: Vec<Place>,
    /// Where the columns of the left and of the right hand begin.
    lanes: [f64; 2],
    /// Where the arrows begin that pass other steps.
    gutter: f64,
    right: f64,
    bottom: f64,
}

impl Layout {
    /// A step is below all that come before it, and left and right are those of the person who works.
    fn of(job: &JobFile) -> Self {
        let rows = rows(job);
        let sides: Vec<Side> = (0..job.steps.len()).map(|number| side(job, number)).collect();
        let column = |number: usize| {
            let alike =
                (0..number).filter(|other| rows[*other] == rows[number] && sides[*other] == sides[number]);
            alike.count() as f64
        };
        let columns = |side: Side| {
            let of_side = (0..rows.len()).filter(|number| sides[*number] == side);
            of_side.map(|number| column(number) + 1.0).fold(0.0, f64::max)
        };
        let [across, down] = [STEP[0] + ROOM[0], STEP[1] + ROOM[1]];
        let passing = passing(job, &rows) as f64;
        let gutter = MARGIN + columns(Side::Left) * across;
        let lanes = [MARGIN, gutter + passing * TRACK + if passing > 0.0 { ROOM[0] } else { 0.0 }];
        let place = |number: usize| Place {
            side: sides[number],
            x: lanes[usize::from(sides[number] == Side::Right)] + column(number) * across,
            y: MARGIN + HEAD + rows[number] as f64 * down,
        };
        let last = rows.iter().copied().max().unwrap_or_default() as f64;
        Self {
            places: (0..rows.len()).map(place).collect(),
            lanes,
            gutter,
            right: lanes[1] + columns(Side::Right) * across,
            bottom: MARGIN + HEAD + last * down + STEP[1],
        }
    }

    fn size(&self) -> [f64; 2] {
        [(self.right + MARGIN).max(680.0), self.bottom + MARGIN + LEGEND]
    }

    fn step(&self, svg: &mut Svg, job: &JobFile, number: usize) {
        let (place, step) = (&self.places[number], &job.steps[number]);
        let hand = if place.side == Side::Left { "lb" } else { "rb" };
        let need = if step.is_required { "" } else { " ob" };
        svg.add(format_args!(
            "<rect class=\"{hand}{need}\" x=\"{:.1}\" y=\"{:.1}\" width=\"{}\" height=\"{}\" rx=\"8\"/>",
            place.x, place.y, STEP[0], STEP[1]
        ));
        let name = job.step_name(number);
        // The column says the hand.
        let name = name.split_once(": ").map_or(name.as_str(), |(_, parts)| parts);
        for (line, y) in wrapped(&format!("{}. {name}", number + 1)).iter().zip([19.0, 35.0]) {
            svg.text(place.x + 10.0, place.y + y, "n", line);
        }
        let need = if step.is_required { "required" } else { "optional" };
        let once = if step.is_once { ", only once" } else { "" };
        let runs = if step.runs == 1 { "run has it" } else { "runs have it" };
        svg.text(place.x + 10.0, place.y + 54.0, "s", &format!("{need}{once}; {} {runs}", step.runs));
        let ends = drawn(job, number).filter(|relation| relation.kind == RelationKind::End);
        let ends: Vec<String> = ends.map(|relation| (relation.activity + 1).to_string()).collect();
        if !ends.is_empty() {
            let have = if ends.len() == 1 { "has" } else { "have" };
            svg.text(
                place.x + 10.0,
                place.y + 70.0,
                "s",
                &format!("only when {} {have} ended", ends.join(", ")),
            );
        }
    }

    /// An arrow from the step that comes before; one that would pass other steps runs between the hands.
    fn arrow(&self, svg: &mut Svg, arrow: &Arrow, all: &[Arrow], track: &mut f64) {
        let (from, to) = (&self.places[arrow.from], &self.places[arrow.to]);
        let leaving = all.iter().filter(|other| other.from == arrow.from).map(|other| other.to);
        let coming = all.iter().filter(|other| other.to == arrow.to).map(|other| other.from);
        let [x1, x2] = [self.end(from, leaving, arrow.to), self.end(to, coming, arrow.from)];
        let [y1, y2] = [from.y + STEP[1], to.y];
        let (class, head) = if arrow.is_law { ("la", "law") } else { ("na", "note") };
        let half = ROOM[1] / 2.0;
        let path = if y2 - y1 <= ROOM[1] + 1.0 {
            format!("M{x1:.1} {y1:.1}C{x1:.1} {:.1} {x2:.1} {:.1} {x2:.1} {y2:.1}", y1 + half, y2 - half)
        } else {
            let x = self.gutter + *track;
            *track += TRACK;
            let (out, back) = (y1 + half, y2 - half);
            format!(
                "M{x1:.1} {y1:.1}C{x1:.1} {out:.1} {x:.1} {y1:.1} {x:.1} {:.1}L{x:.1} {:.1}C{x:.1} {y2:.1} {x2:.1} {back:.1} {x2:.1} {y2:.1}",
                y1 + ROOM[1],
                y2 - ROOM[1]
            )
        };
        svg.add(format_args!("<path class=\"{class}\" marker-end=\"url(#{head})\" d=\"{path}\"/>"));
    }

    /// Where an arrow meets a step that is joined to these others, so that no two meet it in one point. Beside each other as the others are.
    fn end(&self, step: &Place, others: impl Iterator<Item = usize>, other: usize) -> f64 {
        let position = |number: usize| (self.places[number].x, number);
        let others: Vec<(f64, usize)> = others.map(position).collect();
        let before = others.iter().filter(|one| **one < position(other)).count();
        step.x + STEP[0] * (before + 1) as f64 / (others.len() + 1) as f64
    }
}

fn legend(svg: &mut Svg, y: f64, job: &JobFile, rejected: Option<&[String]>) {
    let lines = [
        ("la", "law", "law: the other order is an anomaly"),
        ("na", "note", "shown in this order only: the other one is a note"),
    ];
    for ((class, head, words), x) in lines.into_iter().zip([MARGIN, MARGIN + 290.0]) {
        svg.add(format_args!(
            "<path class=\"{class}\" marker-end=\"url(#{head})\" d=\"M{x:.1} {y:.1}h42\"/>"
        ));
        svg.text(x + 50.0, y + 4.0, "s", words);
    }
    svg.text(
        MARGIN,
        y + 24.0,
        "s",
        "Steps that no arrows join, one after the other, may come in any order. A dashed frame is an optional step.",
    );
    let used = job.provenance.sources.iter().filter(|source| !source.left_out).count();
    let strictness = job.provenance.strictness.map(|it| format!("; strictness {}", it.number()));
    let runs = format!("{}: taught by {used} runs{}", job.name, strictness.unwrap_or_default());
    svg.text(MARGIN, y + 48.0, "n", &runs);
    if let Some(rejected) = rejected {
        let share = 100.0 * rejected.len() as f64 / used.max(1) as f64;
        let names = rejected.iter().take(NAMES).map(String::as_str);
        let more = (rejected.len() > NAMES).then_some("…");
        let which: Vec<&str> = names.chain(more).collect();
        let which = if rejected.is_empty() { String::new() } else { format!(": {}", which.join(", ")) };
        let words = format!(
            "Each run judged by what the others teach: {} of {used} rejected ({share:.0} %){which}",
            rejected.len()
        );
        svg.text(MARGIN, y + 66.0, "", &words);
    }
    let pairs: Vec<String> = incidental_pairs(&job.objects).iter().map(|pair| pair.join(" and ")).collect();
    if !pairs.is_empty() {
        let words = format!("Near each other by chance only, so not counted: {}", pairs.join(", "));
        svg.text(MARGIN, y + 84.0, "s", &words);
    }
}

/// How many rows each step is below the first: one more than those before it.
fn rows(job: &JobFile) -> Vec<usize> {
    let mut rows: Vec<usize> = Vec::new();
    for step in &job.steps {
        let before = step.after.iter().filter_map(|relation| rows.get(usize::from(relation.activity)));
        let row = before.max().map_or(0, |row| row + 1);
        rows.push(row);
    }
    rows
}

/// Whether an arrow follows from two others by way of a step between: a law from laws, what is only usual from any.
fn follows(job: &JobFile, number: usize, relation: &Relation) -> bool {
    let is_usual = |relation: &Relation| relation.kind == RelationKind::Usual;
    let has = |later: usize, earlier: u16| {
        let mut before = job.steps[later].after.iter().filter(|other| other.activity == earlier);
        before.any(|other| is_usual(relation) || !is_usual(other))
    };
    let mut between = usize::from(relation.activity) + 1..number;
    between.any(|other| has(number, other as u16) && has(other, relation.activity))
}

/// The relations of a step to those before it that are drawn.
fn drawn(job: &JobFile, number: usize) -> impl Iterator<Item = &Relation> {
    job.steps[number].after.iter().filter(move |relation| {
        usize::from(relation.activity) < job.steps.len() && !follows(job, number, relation)
    })
}

/// An arrow from one step to another.
struct Arrow {
    from: usize,
    to: usize,
    is_law: bool,
}

fn arrows(job: &JobFile) -> Vec<Arrow> {
    let to_step = |to: usize| {
        drawn(job, to).map(move |relation| Arrow {
            from: relation.activity.into(),
            to,
            is_law: relation.kind != RelationKind::Usual,
        })
    };
    (0..job.steps.len()).flat_map(to_step).collect()
}

/// How many arrows pass other steps.
fn passing(job: &JobFile, rows: &[usize]) -> usize {
    arrows(job).iter().filter(|arrow| rows[arrow.to] > rows[arrow.from] + 1).count()
}

fn side(job: &JobFile, number: usize) -> Side {
    let first = job.activities.iter().find(|taught| usize::from(taught.activity) == number);
    let context = first.and_then(|taught| taught.ius.first()).map(|iu| iu.context);
    if context.is_some_and(|context| context.0[0] == Side::Left as u16) { Side::Left } else { Side::Right }
}

/// Two lines at most; what does not fit ends in dots.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.len() - 1;
        if lines[line].chars().count() + word.chars().count() < LETTERS {
            let space = if lines[line].is_empty() { "" } else { " " };
            lines[line] += &format!("{space}{word}");
        } else {
            lines.push(word.chars().take(LETTERS).collect());
        }
    }
    if lines.len() > 2 {
        lines.truncate(2);
        lines[1] += " …";
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_has_two_lines_and_loses_no_letter_unseen() {
        assert_eq!(wrapped("1  polisher at brick"), ["1  polisher at brick"]);
        let long = wrapped(
            "12  a lid with a very long name at a box with a longer one, and at a tray with yet another name",
        );
        assert_eq!(long.len(), 2);
        assert!(
            long[1].ends_with('…') && long.iter().all(|line| line.chars().count() <= LETTERS + 2),
            "{long:?}"
        );
    }
}
