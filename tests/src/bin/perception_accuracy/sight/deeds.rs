//! What is done to pictures, and what should be said of it.

use andon_perception::sight::Trouble;
use oorandom::Rand64;

/// What is done.
#[derive(Clone, Debug)]
pub(super) enum Deed {
    /// An ffmpeg filter.
    Filter(String),
    /// From the beginning the bench is empty.
    Empty,
    /// Another clip of the same person, whose parts lie elsewhere.
    OtherClip,
    /// The same picture again and again.
    Freeze,
    /// The same scene again and again, with new noise in every picture.
    Pause,
    /// Only every n-th picture is processed.
    Skip(usize),
    /// From the beginning no hand is looked for, and one would be wanted.
    HideHands,
    /// From the beginning the station has markers of other ids.
    OtherIds,
    /// From the beginning the station has markers of another dictionary.
    OtherDictionary,
}

impl std::fmt::Display for Deed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Filter(filter) => f.write_str(filter),
            Self::Skip(of) => write!(f, "one of {of}"),
            _ => Ok(()),
        }
    }
}

/// Something that is done to a clip.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) deed: Deed,
    /// What should be said of it; `None` where it is harmless.
    pub(super) expected: Option<Trouble>,
}

/// The free part of the table, four times.
pub(super) const CLEARED: &str =
    "crop=400:240:0:240,split=4[a][b][c][d];[a][b]vstack[l];[c][d]vstack,crop=240:480:0:0[r];[l][r]hstack";

/// All that is done to a clip. How strongly is drawn, between what is hard to tell from a good picture and the worst.
pub(super) fn cases(random: &mut Rand64) -> Vec<Case> {
    let mut cases = troubles(random);
    cases.extend(harmless(random));
    cases
}

fn between(random: &mut Rand64, least: f64, most: f64) -> f64 {
    least + random.rand_float() * (most - least)
}

/// A colour, brighter or darker by a factor.
fn lit(colour: [f64; 3], by: f64) -> String {
    let [red, green, blue] = colour.map(|part| (part * by).min(255.0) as u8);
    format!("0x{red:02x}{green:02x}{blue:02x}")
}

fn troubles(random: &mut Rand64) -> Vec<Case> {
    let (covers, moved) = (covers(random), moved_cameras(random));
    let bad = bad_pictures(covers, random)
        .into_iter()
        .chain(moved)
        .map(|(trouble, name, filter)| (trouble, name, Deed::Filter(filter)));
    let others = [
        (Trouble::Frozen, "frozen", Deed::Freeze),
        (Trouble::TooFewFrames, "pictures are left out", Deed::Skip(between(random, 3.0, 11.0) as usize)),
        (Trouble::NoMarkers, "markers of other ids", Deed::OtherIds),
        (Trouble::NoMarkers, "markers of another dictionary", Deed::OtherDictionary),
        (Trouble::NoHands, "a glove that no hand is seen in", Deed::HideHands),
    ];
    bad.chain(others).map(|(trouble, name, deed)| Case { name, deed, expected: Some(trouble) }).collect()
}

/// The colours of skin, paper and cloth.
fn covers(random: &mut Rand64) -> [String; 3] {
    [
        lit([106.0, 64.0, 48.0], between(random, 0.6, 2.0)),
        lit([216.0, 216.0, 208.0], between(random, 0.7, 1.1)),
        lit([32.0, 40.0, 56.0], between(random, 0.8, 2.5)),
    ]
}

/// Trouble, name, filter.
fn bad_pictures(
    [skin, paper, cloth]: [String; 3],
    random: &mut Rand64,
) -> [(Trouble, &'static str, String); 8] {
    let mut draw = |least: f64, most: f64| between(random, least, most);
    [
        (Trouble::Black, "black", format!("lutyuv=y={:.0}:u=128:v=128", draw(16.0, 24.0))),
        (Trouble::White, "white", format!("lutyuv=y={:.0}:u=128:v=128", draw(235.0, 255.0))),
        (Trouble::Covered, "hand over the lens", format!("drawbox=c={skin}:t=fill")),
        (Trouble::Covered, "paper over the lens", format!("drawbox=c={paper}:t=fill")),
        (
            Trouble::Covered,
            "cloth, light on one side",
            // The filter's shade ends in a hard step. On the lens, nothing is sharp.
            format!("drawbox=c={cloth}:t=fill,vignette={:.2}:x0=0,gblur=sigma=8", draw(0.6, 1.2)),
        ),
        (Trouble::Blurred, "lens out of focus", format!("gblur=sigma={:.1}", draw(5.0, 8.0))),
        (Trouble::Blurred, "far out of focus", format!("gblur=sigma={:.1}", draw(8.0, 24.0))),
        (Trouble::Noisy, "noise of a dying sensor", format!("noise=alls={:.0}:allf=t", draw(80.0, 100.0))),
    ]
}

/// Trouble, name, filter. A camera that is moved by less takes markers less than a fifth of their side away. By more, it leaves no two of them in the
/// picture.
fn moved_cameras(random: &mut Rand64) -> [(Trouble, &'static str, String); 3] {
    let mut draw = |least: f64, most: f64| between(random, least, most);
    let [across, down] = [draw(0.05, 0.15), draw(0.05, 0.15)];
    let (turn, near) = (draw(-0.2, 0.2), draw(0.82, 0.92));
    let turn = turn + 0.1_f64.copysign(turn);
    [
        ("the camera is pushed aside", format!("scroll=hpos={across:.3}:vpos={down:.3}")),
        ("the camera is turned", format!("rotate={turn:.3}:c=gray")),
        ("the camera comes nearer", format!("crop=iw*{near:.3}:ih*{near:.3},scale=640:480")),
    ]
    .map(|(name, filter)| (Trouble::CameraMoved, name, filter))
}

fn harmless(random: &mut Rand64) -> Vec<Case> {
    let mut draw = |least: f64, most: f64| between(random, least, most);
    // A dark stripe that moves across the bench.
    let wandering = format!(
        "geq=lum='lum(X,Y)*(1-{:.2}*between(X-{:.0}*T+200,0,220))':cb='cb(X,Y)':cr='cr(X,Y)'",
        draw(0.2, 0.6),
        draw(40.0, 200.0)
    );
    let flicker =
        format!("eq=eval=frame:brightness='{:.3}*sin(2*PI*t*{:.1})'", draw(0.02, 0.12), draw(0.5, 10.0));
    let filters = [
        ("nothing", "null".to_owned()),
        ("the bench is cleared", CLEARED.to_owned()),
        ("a shadow that wanders", wandering),
        ("a lamp flickers", flicker),
        (
            "a lamp is switched on",
            format!("eq=brightness={:.3}:gamma={:.2}", draw(0.03, 0.2), draw(1.0, 1.5)),
        ),
        ("a lamp is switched off", format!("eq=gamma={:.2}", draw(0.4, 0.9))),
        ("it gets darker", format!("eq=brightness=-{:.3}", draw(0.05, 0.28))),
        (
            "a shadow over a part",
            format!("drawbox=w=iw*{:.2}:c=black@{:.2}:t=fill", draw(0.1, 0.9), draw(0.2, 0.6)),
        ),
        ("a shadow over all", format!("drawbox=c=black@{:.2}:t=fill", draw(0.2, 0.6))),
        ("some noise", format!("noise=alls={:.0}:allf=t", draw(5.0, 25.0))),
        ("a soft lens", format!("gblur=sigma={:.2}", draw(0.5, 1.4))),
    ];
    let filters = filters.map(|(name, filter)| Case { name, deed: Deed::Filter(filter), expected: None });
    let others = [
        ("a pause", Deed::Pause),
        ("an empty bench", Deed::Empty),
        ("the bench is rearranged", Deed::OtherClip),
        ("every 2nd picture is late", Deed::Skip(2)),
    ];
    let others = others.map(|(name, deed)| Case { name, deed, expected: None });
    filters.into_iter().chain(others).collect()
}
