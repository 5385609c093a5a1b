//! Draws which thread does what when while a frame is looked at.

use crate::Error;
use crate::speed::{self, Show};
use andon_learn::svg::Svg;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

// Its name would be that of the flattened one.
#[derive(clap::Args)]
#[group(skip)]
pub(crate) struct Arguments {
    #[command(flatten)]
    shown: speed::Arguments,
    /// The picture (.svg).
    #[arg(long)]
    out: PathBuf,
}

/// The span that holds all of a frame but what goes on beside it.
const FRAME: &str = "frame";

/// Draws the frame of median length.
pub(crate) fn run(arguments: &Arguments, runtime: &Path) -> Result<(), Error> {
    let spans = Spans::default();
    let mut show = Show::new(&arguments.shown, runtime)?;
    show.round(None)?;
    tracing::subscriber::set_global_default(spans.clone())?;
    show.round(None)?;
    let spans = std::mem::take(&mut *spans.all());
    let mut frames: Vec<&Span> = spans.iter().filter(|span| span.name == FRAME).collect();
    frames.sort_by_key(|frame| frame.ended.duration_since(frame.began));
    let frame = frames.get(frames.len() / 2).ok_or("no frame was looked at")?;
    std::fs::write(&arguments.out, draw(frame, &spans))?;
    for (name, mean_ms) in means(&spans, frames.len()) {
        println!("{name:16} {mean_ms:7.3} ms per frame");
    }
    Ok(())
}

/// What every span takes in a frame on average, in milliseconds.
fn means(spans: &[Span], frames: usize) -> BTreeMap<&'static str, f64> {
    let mut means = BTreeMap::new();
    for span in spans {
        *means.entry(span.name).or_default() += 1e3 * span.seconds() / frames as f64;
    }
    means
}

// Pixels: a page that a browser shows without scrolling sideways, and boxes that hold their names.
const WIDTH: f64 = 1100.0;
const LEFT: f64 = 110.0;
const LANE: f64 = 26.0;
const HEAD: f64 = 34.0;

fn draw(frame: &Span, spans: &[Span]) -> String {
    let shown: Vec<&Span> =
        spans.iter().filter(|span| span.began < frame.ended && span.ended > frame.began).collect();
    // Each thread has a lane for each depth at which spans lie in one another there.
    let mut lanes: Vec<(&str, usize)> = shown.iter().map(|span| (span.thread.as_str(), span.depth)).collect();
    lanes.sort_unstable();
    lanes.dedup();
    let took_ms = 1e3 * frame.seconds();
    let (scale, height) = ((WIDTH - LEFT - 20.0) / took_ms, HEAD + LANE * lanes.len() as f64 + 30.0);
    let mut svg = Svg::new(WIDTH, height, "Which thread does what when while a frame is looked at");
    svg.text(LEFT, 18.0, "n", &format!("One frame in {took_ms:.2} ms: which thread does what when"));
    for tick in 0..=took_ms as usize {
        let x = LEFT + tick as f64 * scale;
        svg.line("g", [x, HEAD], [x, height - 26.0]);
        svg.text(x, height - 10.0, "s m", &format!("{tick} ms"));
    }
    for (lane, (thread, depth)) in lanes.iter().enumerate() {
        let y = HEAD + LANE * lane as f64;
        if lane == 0 || lanes[lane - 1].0 != *thread {
            svg.line("a", [0.0, y], [WIDTH, y]);
            svg.text(4.0, y + 17.0, "n", thread);
        }
        for span in shown.iter().filter(|span| (span.thread.as_str(), span.depth) == (*thread, *depth)) {
            let at_ms = |at: Instant| 1e3 * at.saturating_duration_since(frame.began).as_secs_f64();
            let (from, to) = (at_ms(span.began), at_ms(span.ended).min(took_ms));
            let (x, width) = (LEFT + from * scale, (to - from) * scale);
            let class = if ["crop", "grey", "shrink"].contains(&span.name) { "lb" } else { "rb" };
            svg.add(format_args!(
                "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{:.1}\" width=\"{width:.1}\" height=\"{:.1}\"><title>{} {:.3} ms</title></rect>",
                y + 3.0,
                LANE - 6.0,
                span.name,
                1e3 * span.seconds()
            ));
            if width > 7.0 * span.name.len() as f64 {
                svg.text(x + 4.0, y + 17.0, "", span.name);
            }
        }
    }
    svg.finish()
}

#[derive(Clone, Debug)]
struct Span {
    name: &'static str,
    thread: String,
    depth: usize,
    began: Instant,
    ended: Instant,
}

impl Span {
    fn seconds(&self) -> f64 {
        self.ended.duration_since(self.began).as_secs_f64()
    }
}

/// Everything that was entered and left, in the order of its beginning.
#[derive(Clone, Default)]
struct Spans(Arc<Mutex<Vec<Span>>>);

thread_local! {
    /// How many spans this thread is in.
    static DEPTH: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

impl Spans {
    fn all(&self) -> std::sync::MutexGuard<'_, Vec<Span>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Subscriber for Spans {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_span() && metadata.target().starts_with("andon")
    }

    fn new_span(&self, attributes: &Attributes<'_>) -> Id {
        let (now, mut all) = (Instant::now(), self.all());
        let thread = std::thread::current().name().unwrap_or("other").to_owned();
        let name = attributes.metadata().name();
        all.push(Span { name, thread, depth: 0, began: now, ended: now });
        Id::from_u64(all.len() as u64)
    }

    fn enter(&self, id: &Id) {
        let depth = DEPTH.replace(DEPTH.get() + 1);
        if let Some(span) = self.all().get_mut(id.into_u64() as usize - 1) {
            *span = Span { depth, began: Instant::now(), ..span.clone() };
        }
    }

    fn exit(&self, id: &Id) {
        DEPTH.set(DEPTH.get().saturating_sub(1));
        if let Some(span) = self.all().get_mut(id.into_u64() as usize - 1) {
            span.ended = Instant::now();
        }
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn event(&self, _: &Event<'_>) {}
}
