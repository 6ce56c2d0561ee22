//! The subcommand `page`: a web page that plays a song.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use clap::Args;

use super::common::{CommonArguments, OneScene, end_by_signals};
use super::files::Files;
use crate::atomic_file::AtomicFile;
use crate::export::output::refuse_to_replace;
use crate::export::print::print_line;
use crate::limits;
use crate::scenes::SceneSource;
use mariana_player::song::{Song, display_name};

/// The beginning of every page.
const BEGINNING: &str = "<!doctype html>\n<!-- A page of Mariana -->\n";
/// The elements of a page for its song, each with its content in a page without a song.
const ABOUT: [&str; 2] = ["<script id=\"own\" type=\"application/json\">", "{}"];
const SONG: [&str; 2] = ["<script id=\"song\" type=\"text/plain\">", ""];
/// The endings of songs that current browsers play.
const PLAYED: [&str; 9] = ["mp3", "ogg", "oga", "opus", "flac", "wav", "m4a", "mp4", "webm"];

#[derive(Args)]
pub(super) struct PageArguments {
    /// The song; if none is given, the built-in demo track. A .scene file is the scene to show
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The page to write; it opens without a server
    #[arg(short, long, value_name = "FILE.html")]
    output: PathBuf,
    /// The page without a song that 'scripts/site' builds [default: page.html beside the program]
    #[arg(long, value_name = "FILE.html")]
    template: Option<PathBuf>,
    #[command(flatten)]
    scene: OneScene,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: PageArguments) -> anyhow::Result<()> {
    arguments.common.start_log();
    end_by_signals();
    let (song, file) = Files::of(arguments.files)?.song_and_scene()?;
    let scene = arguments.scene.choose(file, &arguments.common)?.source;
    refuse_to_replace(&arguments.output, Some(BEGINNING))?;
    let template = read_template(arguments.template)?;
    let about = about(&song, &scene)?;
    let page = filled(&filled(&template, ABOUT, &about)?, SONG, &encoded(&song)?)?;
    let written = AtomicFile::create(&arguments.output).and_then(|file| file.write(page.as_bytes()));
    written.with_context(|| format!("{} cannot be written", arguments.output.display()))?;
    let megabytes = page.len() as f64 / 1e6;
    Ok(print_line(&format!("{}: a page of {megabytes:.1} MB", arguments.output.display()))?)
}

/// Reads the page without a song from `file`, or from a folder near the program.
fn read_template(file: Option<PathBuf>) -> anyhow::Result<String> {
    let own = std::env::current_exe().unwrap_or_default();
    let folder = own.parent().and_then(Path::parent).unwrap_or(Path::new(""));
    // Built by `scripts/site`, or installed.
    let mut places = ["site", "share/mariana"].map(|place| folder.join(place).join("page.html")).into_iter();
    let Some(file) = file.or_else(|| places.find(|place| place.is_file())) else {
        bail!("the web page is not built: run scripts/site once, or give its page.html with --template");
    };
    let page = std::fs::read_to_string(&file);
    page.with_context(|| {
        format!("{} cannot be read: give the page.html that scripts/site builds", file.display())
    })
}

/// Replaces the content of an element.
fn filled(page: &str, [start, empty]: [&str; 2], content: &str) -> anyhow::Result<String> {
    let end = "</script>";
    let Some((before, after)) = page.split_once(&format!("{start}{empty}{end}")) else {
        bail!(
            "the template already has a song, or is from another version: give the page.html that scripts/site builds"
        );
    };
    Ok(format!("{before}{start}{content}{end}{after}"))
}

/// Title, scene and text as an object of JSON that cannot end its element.
fn about(song: &Song, scene: &SceneSource) -> anyhow::Result<String> {
    let title = display_name(&song.open()?);
    let text = scene.text()?;
    let name = match scene {
        SceneSource::Shipped(name) => name.as_str(),
        _ => "orb",
    };
    SceneSource::Shipped(name.to_owned()).ready_as(&text).with_context(|| {
        format!(
            "a page holds only the text of {}, without its files: leave them out of the scene",
            scene.name()
        )
    })?;
    let about = serde_json::json!({ "title": title, "scene": name, "text": text });
    Ok(about.to_string().replace('<', "\\u003c"))
}

/// The song in base 64.
fn encoded(song: &Song) -> anyhow::Result<String> {
    if let Song::File(path) = song {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if !PLAYED.contains(&ending.as_str()) {
            bail!("browsers do not play {}: convert it to one of {}", path.display(), PLAYED.join(", "));
        }
    }
    let mut bytes = Vec::new();
    song.read(|piece| {
        bytes.extend_from_slice(piece);
        bytes.len() <= limits::PAGE_SONG_BYTES_MAX
    })?;
    if bytes.len() > limits::PAGE_SONG_BYTES_MAX {
        let megabytes = limits::PAGE_SONG_BYTES_MAX / 1_000_000;
        bail!("the song is larger than {megabytes} MB: convert it to Opus or MP3 for the page");
    }
    Ok(STANDARD.encode(bytes))
}
