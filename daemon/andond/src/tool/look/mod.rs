//! `andond look`: shows what the camera sees, and says what to improve.

mod findings;
mod inspector;
mod page;
mod source;
mod terminal;

use std::borrow::Cow;
use std::io::{IsTerminal as _, stdout};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_host::video::pipe::PictureFormat;
use andon_record::picture::{Decoded, encode};

use super::{ToolError, stills};
use crate::cli::Look;
use crate::picture::Veil;
use findings::sentences;
use inspector::{Inspection, Inspector};
use page::Page;
use source::Source;

/// A live page need not show more pictures than this per second, and looking at more would take time from the line.
const PAGE_HZ: f64 = 10.0;
/// What the page says depends on this many pictures: some seconds.
const PAGE_PICTURES: usize = 30;

/// The quality of its pictures as JPEG: print and skin stay smooth.
const QUALITY: u8 = 85;

/// Runs the command.
///
/// # Errors
/// A source that cannot be opened, and a picture that cannot be written.
pub fn run(arguments: &Look) -> Result<Code, ToolError> {
    for (option, path) in [("--save", &arguments.save), ("--annotated", &arguments.annotated)] {
        if let Some(path) = path {
            stills::check(option, path)?;
        }
    }
    let config = Config::load_to_learn(&arguments.config.existing()?)?;
    match arguments.page {
        Some(port) => show_page(arguments, &config, port),
        None => look_once(arguments, &config),
    }
}

/// The picture that shows most, and what was seen in it.
struct Best {
    picture: Vec<u8>,
    inspection: Inspection,
}

fn look_once(arguments: &Look, config: &Config) -> Result<Code, ToolError> {
    let mut source = Source::open(arguments.source.as_deref(), config)?;
    let mut inspector = Inspector::new(config, source.sees_hands())?;
    let until_ns = source.is_live().then_some((f64::from(arguments.seconds) * 1e9) as u64);
    let mut best: Option<Best> = None;
    let mut inspections = Vec::new();
    while let Some(view) = source.next()? {
        let inspection = inspector.inspect(&view)?;
        if best.as_ref().is_none_or(|best| inspection.shows() > best.inspection.shows()) {
            best = Some(Best { picture: view.picture.to_vec(), inspection: inspection.clone() });
        }
        let is_over = until_ns.is_some_and(|until_ns| view.at_ns >= until_ns);
        inspections.push(inspection);
        if is_over {
            break;
        }
    }
    let format = source.format();
    let Some(mut best) = best else { return Err(ToolError::NothingSeen(source.name())) };
    if let Some(mut veil) = veil(arguments, config) {
        veil.hide(format, &mut best.picture)?;
    }
    let annotated = inspector.annotated(format, &best.picture, &best.inspection)?;
    if let Some(path) = &arguments.save {
        stills::write(path, format, &best.picture)?;
    }
    if let Some(path) = &arguments.annotated {
        stills::write(path, format, &annotated)?;
    }
    if stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
        print!("{}", terminal::picture(&annotated, format));
    }
    print!("{}", report(&source.name(), format, &inspections, config));
    for path in arguments.save.iter().chain(&arguments.annotated) {
        println!("{}", path.display());
    }
    Ok(Code::Stopped)
}

/// What hides in pictures of the station's camera what may not be seen. A film that somebody names is theirs.
fn veil(arguments: &Look, config: &Config) -> Option<Veil> {
    if arguments.source.is_some() { None } else { Veil::new(&config.record) }
}

/// The sentences below one another, with what to improve marked.
fn report(name: &str, format: PictureFormat, inspections: &[Inspection], config: &Config) -> String {
    let lines = sentences(inspections, config, format);
    let count = inspections.len();
    let pictures = if count == 1 { "one picture".to_owned() } else { format!("{count} pictures") };
    let width = lines.iter().map(|line| line.about.chars().count()).max().unwrap_or_default();
    let mut text = format!("{name}: {} x {} pixels, {pictures}\n", format.width, format.height);
    for line in lines {
        let mark = if line.is_good { "ok     " } else { "IMPROVE" };
        text += &format!("  {mark}  {:width$}  {}\n", line.about, line.sentence);
    }
    text
}

/// Shows the source in a page until it is interrupted; a recording begins again at its end.
fn show_page(arguments: &Look, config: &Config, port: u16) -> Result<Code, ToolError> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let mut veil = veil(arguments, config);
    let page = Page::serve(address, config).map_err(|source| ToolError::Page { address, source })?;
    println!("http://{}/ shows it on this machine; stop with Ctrl-C", page.address());
    loop {
        let mut source = Source::open(arguments.source.as_deref(), config)?;
        let mut inspector = Inspector::new(config, source.sees_hands())?;
        show_source(&mut source, &mut inspector, veil.as_mut(), &page, config)?;
        if source.is_live() {
            return Ok(Code::Stopped);
        }
    }
}

fn show_source(
    source: &mut Source,
    inspector: &mut Inspector,
    mut veil: Option<&mut Veil>,
    page: &Page,
    config: &Config,
) -> Result<(), ToolError> {
    let format = source.format();
    let mut inspections: Vec<Inspection> = Vec::new();
    let name = source.name();
    let mut next_ns = 0;
    while let Some(view) = source.next_at_its_time()? {
        if view.at_ns < next_ns {
            continue;
        }
        next_ns = view.at_ns + (1e9 / PAGE_HZ) as u64;
        let inspection = inspector.inspect(&view)?;
        let mut picture = Cow::Borrowed(view.picture);
        if let Some(veil) = &mut veil {
            veil.hide(format, picture.to_mut())?;
        }
        if page.wants_picture() {
            let pixels = inspector.annotated(format, &picture, &inspection)?;
            let PictureFormat { width, height, .. } = format;
            // One that cannot be encoded is not shown.
            if let Ok(jpeg) = encode(&Decoded { width, height, pixels }, QUALITY) {
                page.show(jpeg, [width, height]);
            }
        }
        if inspections.len() == PAGE_PICTURES {
            inspections.remove(0);
        }
        inspections.push(inspection);
        page.say(&name, sentences(&inspections, config, format));
    }
    Ok(())
}

/// The name of a recording, without its folder.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
