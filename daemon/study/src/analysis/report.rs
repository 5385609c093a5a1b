//! The report: one page with everything, and each picture and table as a file.

use super::candidates::Selection;
use super::compare::{Analysis, AnalysisError};
use super::drilling::Drilling;
use super::order::Order;
use super::picture::{self, Execution, LEGEND, Shown, draw_order, elbow, heat, warping};
use crate::cluster::{MotionClusters, Table};
use andon_learn::html::{document, escaped};
use andon_learn::warp::Warp;
use std::fmt::Write as _;

/// The number of the person whose matrix the paper shows.
const PERSON_OF_PAPER: u32 = 5;

/// A report of an analysis.
#[derive(Clone, Debug)]
pub struct Report {
    /// One self-contained HTML page.
    pub page: String,
    /// Name and content of each picture (SVG) and table (CSV).
    pub files: Vec<(String, String)>,
}

/// Draws an analysis. `source` says what was analysed.
///
/// # Errors
/// If an IU is too long to be compared.
pub fn report(
    analysis: &Analysis,
    drilling: Option<&Drilling>,
    selection: Option<&Selection>,
    order: Option<&Order>,
    source: &str,
) -> Result<Report, AnalysisError> {
    let mut page = Page { html: String::new(), files: Vec::new() };
    page.head(analysis, source);
    page.matrices(analysis);
    page.elbow(&analysis.motion);
    page.clusters(analysis);
    if let Some(drilling) = drilling {
        page.drilling(drilling);
    }
    if let Some(selection) = selection {
        page.selection(selection);
    }
    if let Some(order) = order {
        page.order(order);
    }
    page.traces(analysis)?;
    Ok(Report { page: document(&format!("Analysis of {source}"), &page.html), files: page.files })
}

struct Page {
    html: String,
    files: Vec<(String, String)>,
}

impl Page {
    fn add(&mut self, html: &str) {
        self.html += html;
        self.html.push('\n');
    }

    fn heading(&mut self, text: &str) {
        self.add(&format!("<h2>{}</h2>", escaped(text)));
    }

    fn figure(&mut self, file: &str, svg: String, how_to_read: &str) {
        self.add(&format!("<figure>{svg}<figcaption>{}</figcaption></figure>", escaped(how_to_read)));
        self.files.push((format!("{file}.svg"), svg));
    }

    fn head(&mut self, analysis: &Analysis, source: &str) {
        self.add(&format!(
            "<h1>Which interactions are alike</h1><p>{}: {} Interaction Units (IUs) of {} kinds by {} people, compared by DTW of their motion features \
             and by their context.</p>",
            escaped(source),
            analysis.samples.len(),
            analysis.kinds.len(),
            analysis.people().len()
        ));
        let mut rows = String::from(
            "<table><tr><th>IU</th><th class=\"l\">description</th><th class=\"l\">name of the runs</th><th>executions</th><th>frames of the barycentre</th></tr>",
        );
        let mut csv = String::from("iu,description,name of the runs,executions,frames of the barycentre\n");
        for (index, kind) in analysis.kinds.iter().enumerate() {
            let count = analysis.samples.iter().filter(|sample| sample.kind == index).count();
            let frames = analysis.barycentres[index].len();
            // Writing to a string cannot fail, here and below.
            let _ = write!(
                rows,
                "<tr><td>u{}</td><td class=\"l\">{}</td><td class=\"l\">{}</td><td>{count}</td><td>{frames}</td></tr>",
                index + 1,
                escaped(&kind.label),
                escaped(&kind.what)
            );
            let _ = writeln!(
                csv,
                "u{},{},{},{count},{frames}",
                index + 1,
                quoted(&kind.label),
                quoted(&kind.what)
            );
        }
        self.add(&format!("<div class=\"scroll\">{rows}</table></div>"));
        self.files.push(("kinds.csv".to_owned(), csv));
    }

    fn matrices(&mut self, analysis: &Analysis) {
        let people = analysis.people();
        let group = |kind: usize| format!("u{}", kind + 1);
        let chosen =
            people.iter().copied().find(|person| *person == PERSON_OF_PAPER).or(people.first().copied());
        if let Some(person) = chosen {
            let matrix = analysis.single_subject(person);
            self.heading(&format!("Single-subject confidence matrix, person {person}"));
            self.figure(
                "single_subject",
                heat(&matrix, "single-subject confidence matrix", group),
                &format!(
                    "How to read it: each cell compares two executions (kind u, repetition r) by person {person}; {LEGEND}. Dark blocks on the diagonal \
                     mean that the person repeats a kind in the same way. A dark block off the diagonal means that two kinds have the same motion."
                ),
            );
            self.files.push(("single_subject.csv".to_owned(), matrix.csv()));
        }
        for &person in people.iter().filter(|person| Some(**person) != chosen) {
            let name = format!("single_subject_{person}");
            let matrix = analysis.single_subject(person);
            self.files
                .push((format!("{name}.svg"), heat(&matrix, "single-subject confidence matrix", group)));
            self.files.push((format!("{name}.csv"), matrix.csv()));
        }
        let matrix = analysis.multi_subject();
        self.heading("Multi-subject confidence matrix");
        self.figure(
            "multi_subject",
            heat(&matrix, "multi-subject confidence matrix", group),
            &format!(
                "How to read it: each cell is the mean distance between all repetitions of one kind by one person and those of another kind or person \
                 (people {} in this order within each block); {LEGEND}. A block of one shade means that it does not matter who did it. A light stripe through a block is a person who does it differently.",
                people.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
            ),
        );
        self.files.push(("multi_subject.csv".to_owned(), matrix.csv()));
    }

    fn elbow(&mut self, MotionClusters { wcss, k, .. }: &MotionClusters) {
        self.heading("Number of motion clusters");
        self.figure(
            "elbow",
            elbow(wcss, *k),
            "How to read it: the sum of squared distances to the nearest centroid (WCSS) falls with the number of clusters; beyond the elbow, more \
             clusters gain little. The elbow is the point furthest below the straight line from the first point to the last.",
        );
        let mut csv = String::from("k,wcss\n");
        for (k, wcss) in (1..).zip(wcss) {
            let _ = writeln!(csv, "{k},{wcss:.3}");
        }
        self.files.push(("elbow.csv".to_owned(), csv));
    }

    fn clusters(&mut self, analysis: &Analysis) {
        self.heading("Clusters");
        let names = |letter: char, count: usize| -> Vec<String> {
            (1..=count).map(|number| format!("{letter}{number}")).collect()
        };
        let contexts = analysis.context.iter().max().map_or(1, |max| max + 1);
        let (both, pairs) = analysis.table_of_both();
        let tables = [
            (
                "By motion (k-means with DTW)",
                analysis.motion_table(),
                names('m', analysis.motion.k),
                "How to read it: how many executions of a kind are in each motion cluster. Kinds that share a column have the same motion, whatever objects they touch.",
            ),
            (
                "By context (DBSCAN, ε = 1)",
                analysis.context_table(),
                names('c', contexts),
                "How to read it: kinds that share a column touch the same objects, whatever their motion.",
            ),
            (
                "By both",
                both,
                pairs.iter().map(|(m, c)| format!("(m{}, c{})", m + 1, c + 1)).collect(),
                "How to read it: motion and context together distinguish two kinds if they share no column.",
            ),
        ];
        for (title, table, columns, how_to_read) in tables {
            self.table(analysis, title, &table, &columns, how_to_read);
        }
        self.files.push(("clusters.csv".to_owned(), clusters_csv(analysis)));
    }

    fn table(
        &mut self,
        analysis: &Analysis,
        title: &str,
        table: &Table,
        columns: &[String],
        how_to_read: &str,
    ) {
        let mut html = format!("<h3>{}</h3><div class=\"scroll\"><table><tr><th>IU</th>", escaped(title));
        for column in columns {
            html += &format!("<th>{column}</th>");
        }
        html += "</tr>";
        for (index, (kind, counts)) in analysis.kinds.iter().zip(&table.counts).enumerate() {
            html += &format!("<tr><td>u{} {}</td>", index + 1, escaped(&kind.label));
            for (column, count) in counts.iter().enumerate() {
                let class = match count {
                    0 => " class=\"z\"",
                    _ if table.home(index) == Some(column) => " class=\"f\"",
                    _ => "",
                };
                html += &format!("<td{class}>{count}</td>");
            }
            html += "</tr>";
        }
        self.add(&format!("{html}</table></div><figcaption>{}</figcaption>", escaped(how_to_read)));
    }

    fn drilling(&mut self, drilling: &Drilling) {
        self.heading("Drilling in three layouts");
        self.figure(
            "drilling",
            heat(&drilling.matrix, "drilling in three layouts", |layout| format!("C{}", layout + 1)),
            &format!(
                "How to read it: each cell compares the drilling of two people in two layouts; {LEGEND}. There should be no blocks, because the layout \
                 of the parts must not matter. Mean distance {:.2} in the same layout, {:.2} between layouts, {:.2} to the other kinds of IU.",
                drilling.same_layout, drilling.other_layout, drilling.other_kinds
            ),
        );
        self.files.push(("drilling.csv".to_owned(), drilling.matrix.csv()));
    }

    fn selection(&mut self, selection: &Selection) {
        self.heading("Selection of candidates");
        self.figure(
            "selection",
            picture::selection(selection, "selection of candidates"),
            &format!(
                "How to read it: {} against the nominal activities of all names, which other people taught. Each line is the DTW distance to the \
                 reference of the IU as a share of its threshold. While the IU goes on, it is the least that it can still become. \
                 At its end it is the distance. A candidate drops out (✕) where its context differs, or where its line crosses the threshold. What remains is what was done; if \
                 nothing remains, the activity is an anomaly.",
                selection.run
            ),
        );
    }

    fn order(&mut self, order: &Order) {
        self.heading("The order of the steps");
        self.figure(
            "order",
            draw_order(&order.job, Some(&order.rejected)),
            "How to read it: each step is below those that come before it, in the column of the hand that does it. What all runs show is law where \
             the evidence is enough; otherwise another order is only noted.",
        );
    }

    fn traces(&mut self, analysis: &Analysis) -> Result<(), AnalysisError> {
        self.heading("Executions against their barycentre");
        let mut warp = Warp::new(analysis.cost);
        for (kind, barycentre) in analysis.barycentres.iter().enumerate() {
            let samples: Vec<_> = analysis.samples.iter().filter(|sample| sample.kind == kind).collect();
            let mut executions: Vec<Execution<'_>> = Vec::new();
            let mut order: Vec<(f64, usize)> = Vec::new();
            for (index, sample) in samples.iter().enumerate() {
                let mut path = Vec::new();
                warp.align(&sample.motion, barycentre, |pair| path.push(pair))?;
                executions.push((&sample.motion, path));
                order.push((warp.distance(&sample.motion, barycentre)?, index));
            }
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            let Some(&(distance, typical)) = order.get(order.len() / 2) else { continue };
            let sample = samples[typical];
            let title = format!("u{} {}", kind + 1, analysis.kinds[kind].label);
            self.add(&format!("<h3>{}</h3>", escaped(&title)));
            let name = format!("person {}, repetition {}", sample.person, sample.repetition);
            self.figure(
                &format!("traces_u{}", kind + 1),
                warping(&Shown { barycentre, executions, typical, name }, &title),
                &format!(
                    "How to read it: the orange line is the barycentre; the more executions have a value at the aligned moment, the darker the blue behind \
                     it. Directions are numbered around the circle, and 0 is rest; a_h is 1 while the hand speeds up and -1 while it slows down. Below, grey \
                     lines join the moments that DTW aligns: slanted lines mean a different pace. This execution has the median distance to the barycentre, \
                     {distance:.2}."
                ),
            );
        }
        Ok(())
    }
}

/// Quotes a field of comma-separated values.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// The clusters of each sample as comma-separated values.
fn clusters_csv(analysis: &Analysis) -> String {
    let mut csv = String::from("run,iu,person,repetition,motion cluster,context cluster\n");
    for ((sample, m), c) in analysis.samples.iter().zip(&analysis.motion.labels).zip(&analysis.context) {
        let (run, kind) = (quoted(&sample.run), sample.kind + 1);
        let _ = writeln!(csv, "{run},u{kind},{},{},m{},c{}", sample.person, sample.repetition, m + 1, c + 1);
    }
    csv
}
