//! The subcommand `page`: a web page that plays a song.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use clap::Args;

use super::common::{CommonArguments, OneScene, end_by_signals};
use super::files::Files;
use super::show::{WantedShow, or_shipped, parse_show};
use crate::atomic_file::AtomicFile;
use crate::export::output::{refuse_to_replace, same_file};
use crate::export::print::print_line;
use crate::export::still::{StillRequest, write_still};
use crate::export::structure::structure_of;
use crate::export::{Output, SceneChoice, Showing};
use crate::limits;
use crate::scenes::SceneSource;
use crate::show::{PreparedShow, ShowError, ShowSource};
use mariana_music::SongStructure;
use mariana_player::song::Song;

/// The beginning of every page.
const BEGINNING: &str = "<!doctype html>\n<!-- A page of Mariana -->\n";
/// The elements of a page for its song, each with its content in a page without a song.
const ABOUT: [&str; 2] = ["<script id=\"own\" type=\"application/json\">", "{}"];
const SONG: [&str; 2] = ["<script id=\"song\" type=\"text/plain\">", ""];
/// The size of the picture that a page shows until it is loaded.
const POSTER: (u32, u32) = (960, 540);
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
    /// The page without a song that 'scripts/site' builds [default: the installed one, or the one in target/site]
    #[arg(long, value_name = "FILE.html")]
    template: Option<PathBuf>,
    #[command(flatten)]
    scene: OneScene,
    /// A show instead of one scene: 'auto' for a show that follows the song, 'demo' for the demo track's show, a .show
    /// file, or 'off' [default: auto, unless a scene is given]
    #[arg(long, value_name = "AUTO-OR-FILE", value_parser = parse_show, conflicts_with = "scene")]
    show: Option<WantedShow>,
    /// Begin the song again at its end
    #[arg(long = "loop")]
    repeats: bool,
    /// Leave out the buttons and keys for scenes, sliders and texts, for a frame in another page
    #[arg(long)]
    embed: bool,
    #[command(flatten)]
    common: CommonArguments,
}

pub(super) fn run(arguments: PageArguments) -> anyhow::Result<()> {
    arguments.common.start_log();
    end_by_signals();
    let (song, file) = Files::of(arguments.files)?.song_and_scene()?;
    refuse_to_replace(&arguments.output, Some(BEGINNING))?;
    let template_file = template_file(arguments.template)?;
    if same_file(&template_file, &arguments.output) {
        bail!("{} would replace the page without a song: choose another output", arguments.output.display());
    }
    let template = std::fs::read_to_string(&template_file).with_context(|| {
        format!("{} cannot be read: give the page.html that scripts/site builds", template_file.display())
    })?;
    if let (Some(Some(_)), Some(file)) = (&arguments.show, &file) {
        bail!("a show and the scene {} were given: give one of them", file.display());
    }
    let is_one = file.is_some() || !arguments.scene.is_default();
    let show = arguments.show.unwrap_or_else(|| (!is_one).then_some(ShowSource::Auto));
    let choice = arguments.scene.choose(file, &arguments.common)?;
    require_playable(&song)?;
    let (title, structure) = structure_of(&song)?;
    let encoded = encoded(&song)?;
    let mut about = match &show {
        Some(show) => about_show(show, &structure)?,
        None => about_scene(&choice.source)?,
    };
    about["title"] = title.into();
    about["structure"] = serde_json::to_value(&structure)?;
    (about["loop"], about["embed"]) = (arguments.repeats.into(), arguments.embed.into());
    match poster(song, &structure, choice, show) {
        Ok(poster) => about["poster"] = poster.into(),
        Err(error) => tracing::warn!("the page has no picture until it is loaded: {error:#}"),
    }
    let about = about.to_string().replace('<', "\\u003c");
    let page = filled(&filled(&template, ABOUT, &about)?, SONG, &encoded)?;
    let written = AtomicFile::create(&arguments.output).and_then(|file| file.write(page.as_bytes()));
    written.with_context(|| format!("{} cannot be written", arguments.output.display()))?;
    let megabytes = page.len() as f64 / 1e6;
    Ok(print_line(&format!("{}: a page of {megabytes:.1} MB", arguments.output.display()))?)
}

/// Returns the page without a song: `file`, or one near the program.
fn template_file(file: Option<PathBuf>) -> anyhow::Result<PathBuf> {
    // A shell may start the program through a link.
    let own = std::env::current_exe().and_then(|own| own.canonicalize()).unwrap_or_default();
    let folder = own.parent().unwrap_or(Path::new(""));
    // In the archive for Windows, built by `scripts/site`, installed, or in Mariana.app.
    let mut places = [".", "../site", "../share/mariana", "../Resources"]
        .map(|place| folder.join(place).join("page.html"))
        .into_iter();
    file.or_else(|| places.find(|place| place.is_file()))
        .context("the web page is not built: run scripts/site once, or give its page.html with --template")
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

/// The name and text of a scene.
fn about_scene(scene: &SceneSource) -> anyhow::Result<serde_json::Value> {
    let name = match scene {
        SceneSource::Shipped(name) => name.as_str(),
        _ => "orb",
    };
    Ok(serde_json::json!({ "scene": name, "text": text_of(scene, name)? }))
}

/// The text of a show, and its scenes that are not shipped, by their names.
fn about_show(source: &ShowSource, song: &SongStructure) -> anyhow::Result<serde_json::Value> {
    // The poster's show reports the entries that do not fit.
    let (show, _) = PreparedShow::of_song(source, song, &or_shipped(Vec::new()))?;
    if show.timeline().is_none() {
        return Err(ShowError::WaitsForKeys.into());
    }
    let mut texts = serde_json::Map::new();
    for (name, scene) in show.scenes().filter(|(_, scene)| !matches!(scene, SceneSource::Shipped(_))) {
        texts.insert(name.to_owned(), text_of(scene, "orb")?.into());
    }
    Ok(serde_json::json!({ "show": show.text(&[]), "scenes": texts }))
}

/// The text of a scene, which may use the files of the shipped scene `name` only.
fn text_of(scene: &SceneSource, name: &str) -> anyhow::Result<String> {
    let text = scene.text()?.into_owned();
    SceneSource::Shipped(name.to_owned()).ready_as(&text).with_context(|| {
        let name = scene.name();
        format!("a page holds only the text of {name}, without its files: leave them out of the scene")
    })?;
    Ok(text)
}

/// A picture of the song's first drop, or of its loudest section, as the address of its data.
fn poster(
    song: Song,
    structure: &SongStructure,
    scene: SceneChoice,
    show: Option<ShowSource>,
) -> anyhow::Result<String> {
    let loudest = structure.sections.iter().max_by(|a, b| a.energy.total_cmp(&b.energy));
    let moment = structure.drops.first().copied().or(loudest.map(|section| section.start));
    let at = moment.map_or(0.0, |moment| moment + 1.0).clamp(0.0, 0.9 * structure.seconds);
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("poster.jpg");
    let show = show.map(|show| Showing::Show(show, or_shipped(Vec::new())));
    let output = Output::Path(file.clone());
    let request = StillRequest { show, ..StillRequest::of(song, at, POSTER, scene, output) };
    write_still(&request, Default::default())?;
    Ok(format!("data:image/jpeg;base64,{}", STANDARD.encode(std::fs::read(file)?)))
}

/// Refuses files that browsers do not play.
fn require_playable(song: &Song) -> anyhow::Result<()> {
    if let Song::File(path) = song {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if !PLAYED.contains(&ending.as_str()) {
            bail!("browsers do not play {}: convert it to one of {}", path.display(), PLAYED.join(", "));
        }
    }
    Ok(())
}

/// The song in base 64.
fn encoded(song: &Song) -> anyhow::Result<String> {
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
