//! Measures how fast frames are looked at: as many as possible, and at the rate of a camera. One line of JSON.

use crate::clip::{pixel_format, raw};
use crate::errors::Errors;
use crate::truth::Truth;
use crate::{Error, perceiver};
use andon_perception::config::{HandsConfig, MarkerSearch, ModelSize, ThreadsConfig};
use andon_perception::detections::Side;
use andon_perception::{ImageView, Perceiver, PixelFormat};
use rustix::time::{ClockId, clock_gettime};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Where the hand of the clips works.
const FROM_S: &str = "4";
/// The rate of a camera.
const RATE_HZ: f64 = 30.0;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A clip with its truth beside it.
    clip: PathBuf,
    /// Width and height of the picture.
    #[arg(long, num_args = 2, default_values_t = [640, 480])]
    size: Vec<usize>,
    /// Hands in the picture: the second one is the first one mirrored.
    #[arg(long, default_value_t = 1)]
    hands: usize,
    /// The landmark model: full, quantised or lite.
    #[arg(long, default_value = "quantised", value_parser = crate::detected::model_size)]
    landmarks: ModelSize,
    /// The format of a frame: bgr, yuyv or nv12.
    #[arg(long, default_value = "bgr", value_parser = pixel_format)]
    pixels: PixelFormat,
    /// Look for markers in the whole picture of every frame.
    #[arg(long)]
    whole: bool,
    /// Threads that look at a frame side by side.
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Frames of the clip, which are shown to and fro.
    #[arg(long, default_value_t = 90)]
    frames: usize,
    /// How often they are shown as fast as possible; the median of these rounds counts.
    #[arg(long, default_value_t = 5)]
    rounds: usize,
    /// Leave out the round at the rate of a camera.
    #[arg(long)]
    fast_only: bool,
}

impl Arguments {
    /// The ffmpeg filter that makes the picture.
    pub(crate) fn filter(&self) -> String {
        let [width, height] = [self.size[0], self.size[1]];
        let doubled = if self.hands == 2 { "split[a][b];[b]hflip[c];[a][c]hstack," } else { "" };
        format!(
            "{doubled}scale={width}:{height}:force_original_aspect_ratio=decrease,pad={width}:{height}:-1:-1"
        )
    }

    fn pictures(&self) -> Result<Vec<Vec<u8>>, Error> {
        let mut decoder = Command::new("ffmpeg");
        decoder.args(["-v", "error", "-ss", FROM_S, "-i"]).arg(&self.clip);
        decoder.args(["-vf", &self.filter(), "-frames:v", &self.frames.to_string()]);
        let (name, bytes) = raw(self.pixels, self.size[0], self.size[1]);
        decoder.args(["-f", "rawvideo", "-pix_fmt", name, "-"]).stdout(Stdio::piped());
        let mut child = decoder.spawn()?;
        let mut pipe = child.stdout.take().ok_or("ffmpeg has no output")?;
        let mut pictures = Vec::new();
        for _ in 0..self.frames {
            let mut picture = vec![0; bytes];
            pipe.read_exact(&mut picture)?;
            pictures.push(picture);
        }
        child.wait()?;
        Ok(pictures)
    }
}

pub(crate) fn run(arguments: &Arguments, runtime: &Path) -> Result<(), Error> {
    let mut show = Show::new(arguments, runtime)?;
    // The hands are found and every part has its memory.
    show.round(None)?;
    let (mut rate_hz, mut cpu_ms) = (Errors::default(), Errors::default());
    for _ in 0..arguments.rounds {
        let (began, cpu) = (Instant::now(), cpu_time());
        show.round(None)?;
        rate_hz.push(arguments.frames as f64 / began.elapsed().as_secs_f64());
        cpu_ms.push(1e3 * (cpu_time() - cpu).as_secs_f64() / arguments.frames as f64);
    }
    let (began, cpu) = (Instant::now(), cpu_time());
    let late_ms = if arguments.fast_only { Errors::default() } else { show.round(Some(RATE_HZ))? };
    let share = (cpu_time() - cpu).as_secs_f64() / began.elapsed().as_secs_f64();
    let pictures_mib = show.pictures.iter().map(Vec::len).sum::<usize>() as f64 / 1_048_576.0;
    println!(
        "{}",
        serde_json::json!({
            "frames_per_s": rate_hz.median(),
            "cpu_ms": cpu_ms.median(),
            "core_share": share,
            "p50_ms": late_ms.median(),
            "p99_ms": late_ms.quantile(0.99),
            "memory_mib": memory_mib() - pictures_mib,
            "hands_seen": show.hands as f64 / show.shown as f64,
        })
    );
    Ok(())
}

/// Pictures and who looks at them.
pub(crate) struct Show {
    pictures: Vec<Vec<u8>>,
    size: [usize; 2],
    pixels: PixelFormat,
    perceiver: Perceiver,
    shown: u64,
    hands: usize,
}

impl Show {
    pub(crate) fn new(arguments: &Arguments, runtime: &Path) -> Result<Self, Error> {
        let truth = Truth::beside(&arguments.clip, &crate::clip::Change::default())?;
        let sides = [Side::Right, Side::Left][..arguments.hands.clamp(1, 2)].to_vec();
        let hands = HandsConfig { sides, landmark_model: arguments.landmarks, ..HandsConfig::default() };
        let threads = ThreadsConfig { count: arguments.threads };
        let search = if arguments.whole { MarkerSearch::Whole } else { MarkerSearch::Near };
        Ok(Self {
            pictures: arguments.pictures()?,
            size: [arguments.size[0], arguments.size[1]],
            pixels: arguments.pixels,
            perceiver: perceiver(runtime, &truth, hands, search, threads)?,
            shown: 0,
            hands: 0,
        })
    }

    /// Shows every picture once, forwards and backwards in turn, so that nothing leaps. Returns how long each took, in milliseconds.
    pub(crate) fn round(&mut self, rate_hz: Option<f64>) -> Result<Errors, Error> {
        let mut took_ms = Errors::default();
        let count = self.pictures.len() as u64;
        let began = Instant::now();
        for number in 0..count {
            if let Some(rate_hz) = rate_hz {
                let due = Duration::from_secs_f64(number as f64 / rate_hz);
                std::thread::sleep(due.saturating_sub(began.elapsed()));
            }
            let is_forth = (self.shown / count).is_multiple_of(2);
            let picture = &self.pictures[if is_forth { number } else { count - 1 - number } as usize];
            let [width, height] = self.size;
            let image = ImageView::new(width, height, self.pixels.bytes() * width, self.pixels, picture)?;
            let began = Instant::now();
            let captured_ns = (self.shown as f64 / RATE_HZ * 1e9) as u64;
            self.hands += self.perceiver.perceive(image, captured_ns)?.hands.len();
            took_ms.push(1e3 * began.elapsed().as_secs_f64());
            self.shown += 1;
        }
        Ok(took_ms)
    }
}

/// What all threads of this process have used.
fn cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Memory that belongs to this process alone.
fn memory_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kib.unwrap_or(f64::NAN) / 1024.0
}
