//! `mariana analyze --structure` and `--plot`: the structure of a whole song as text, JSON or a drawing.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

use super::error::{ExportError, refuse};
use super::print::is_open;
use super::song_page::page;
use crate::atomic_file::AtomicFile;
use crate::scenes::{SceneSource, shipped_names};
use crate::show::{BarLines, PreparedShow, ShowSource};
use mariana_music::{SongListener, SongStructure, StereoFrame, Tonality};
use mariana_player::decode::DecodeError;
use mariana_player::song::{Song, display_name};
use mariana_player::source::FrameSource;
use mariana_player::stems::{Stem, separating_command, stems_of};

/// Decodes a song. Returns its name and its structure.
///
/// # Errors
/// Fails if the song cannot be decoded.
pub fn structure_of(song: &Song) -> Result<(String, SongStructure), DecodeError> {
    let mut decoder = song.open()?;
    let name = display_name(&decoder);
    let mut listener = SongListener::new(decoder.sample_rate());
    let mut block: Vec<StereoFrame> = Vec::new();
    loop {
        block.clear();
        if decoder.next_block(&mut block)? == 0 {
            return Ok((name, listener.finish()));
        }
        listener.push(&block);
    }
}

/// Prints the structure of a song to `out`, if any, as JSON or as text. Draws it in the SVG file `plot`, if any.
///
/// # Errors
/// Fails if the song cannot be decoded, or an output cannot be written. A closed pipe is no error.
pub fn print_structure(
    song: &Song,
    plot: Option<&Path>,
    out: Option<&mut dyn Write>,
    json: bool,
) -> Result<(), ExportError> {
    // Create the file first, so that an unwritable file is reported before the work.
    let plot = match plot {
        Some(path) => {
            if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("svg")) {
                return refuse(format!(
                    "{} cannot be written: --plot draws an SVG, so give it a name that ends in .svg",
                    path.display()
                ));
            }
            Some(AtomicFile::create(path)?)
        }
        None => None,
    };
    let (name, mut structure) = structure_of(song)?;
    // The analysis hears mono as it is played, on two loudspeakers. The standard measures its one channel.
    if song.open()?.info().source_channels == 1 {
        structure.loudness = structure.loudness.map(|loudness| loudness - 10.0 * 2.0_f32.log10());
    }
    if let Some(plot) = plot {
        let shipped: Vec<SceneSource> = shipped_names().into_iter().map(SceneSource::Shipped).collect();
        let (show, _) = PreparedShow::of_song(&ShowSource::Auto, &structure, &shipped)?;
        plot.write(page(&name, &structure, show.clips()).as_bytes())?;
    }
    let Some(out) = out else { return Ok(()) };
    let stems = stems_line(song);
    let text = if json {
        serde_json::to_string(&structure).map_err(|error| ExportError::Print(error.into()))? + "\n"
    } else {
        text(&name, &structure) + &stems
    };
    is_open(out.write_all(text.as_bytes()).and_then(|()| out.flush())).map(drop)
}

/// Returns a line about the stems of a song; empty if it has none and no program on the path makes them.
fn stems_line(song: &Song) -> String {
    let (stems, problems) = stems_of(song);
    let problems: String = problems.iter().map(|problem| format!("{problem}\n")).collect();
    let names: Vec<&str> = stems.iter().map(Stem::name).collect();
    match song {
        _ if !names.is_empty() => format!("stems: {}\n{problems}", names.join(", ")),
        Song::File(path) if is_installed("demucs") => {
            format!("no stems: to make them, run {}\n{problems}", separating_command(path))
        }
        _ => problems,
    }
}

fn is_installed(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

/// Formats a time as 1:20.5.
pub(super) fn clock(seconds: f64) -> String {
    let tenths = (seconds * 10.0).round().max(0.0) as u64;
    format!("{}:{:02}.{}", tenths / 600, tenths / 10 % 60, tenths % 10)
}

fn key_name(key: Tonality) -> String {
    format!("{} {}", key.root_name(), key.mode.name())
}

pub(super) fn summary(structure: &SongStructure) -> String {
    if structure.silent {
        return format!("{}, silence", clock(structure.seconds));
    }
    let tempo = match (structure.tempo, structure.meter) {
        (Some(tempo), Some(meter)) => {
            format!("{tempo:.1} beats per minute in {}, {} bars", meter.name(), bar_count(structure))
        }
        _ => "no steady beat".to_owned(),
    };
    let key = structure.key.map_or_else(|| "no key".to_owned(), key_name);
    format!("{}, {tempo}, {key}", clock(structure.seconds))
}

/// The number of bars, without a last bar of which the song has less than half.
fn bar_count(structure: &SongStructure) -> usize {
    let at_end = BarLines::of(structure).bar_at(structure.seconds);
    structure.downbeats().count().min((at_end - 0.5) as usize)
}

fn text(name: &str, structure: &SongStructure) -> String {
    let mut text = format!("{name}: {}\n", summary(structure));
    if let Some(loudness) = structure.loudness {
        let _ = writeln!(text, "integrated loudness {loudness:.1} LUFS (EBU R128)");
    }
    if structure.cut_short {
        let _ = writeln!(text, "the song is longer, but the rest was not analysed");
    }
    let lines = BarLines::of(structure);
    // A section that begins less than a bar before the first bar line begins with the upbeat to bar 1.
    let bar_of = |time: f64| {
        let bar = lines.bar_at(time + 0.01);
        (bar > 0.0 && !structure.beats.is_empty()).then_some(bar.floor().max(1.0))
    };
    for section in &structure.sections {
        let _ = write!(
            text,
            "{:>8} - {:>8}  {:<2} energy {:.2}",
            clock(section.start),
            clock(section.end),
            section.letter,
            section.energy
        );
        if let Some(bar) = bar_of(section.start) {
            let _ = write!(text, "  from bar {bar}");
        }
        text.push('\n');
    }
    for build in &structure.builds {
        let _ = writeln!(text, "{:>8} - {:>8}  build", clock(build.start), clock(build.end));
    }
    for drop in &structure.drops {
        let _ = writeln!(text, "{:>8}             drop", clock(*drop));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_music::{Meter, Section, SongBeat};

    #[test]
    fn sections_before_the_first_bar_got_bar_1_and_an_end_on_a_bar_line_another_bar() {
        let beat = |index: u32| SongBeat {
            time: 20.0 + 0.5 * f64::from(index),
            of_bar: (index % 4) as u8 + 1,
            tempo: 120.0,
        };
        let section = |start: f64, end: f64| Section { start, end, letter: "A".into(), energy: 0.5 };
        let mut structure = SongStructure {
            seconds: 36.01,
            tempo: Some(120.0),
            meter: Some(Meter::FourFour),
            beats: (0..33).map(beat).collect(),
            sections: vec![section(0.0, 19.0), section(19.0, 24.0), section(24.0, 36.0)],
            ..SongStructure::default()
        };
        assert_eq!(bar_count(&structure), 8);
        structure.seconds = 37.0;
        assert_eq!(bar_count(&structure), 9);
        let text = text("song", &structure);
        let bars: Vec<&str> =
            text.lines().skip(1).map(|line| line.split("energy 0.50").last().unwrap()).collect();
        assert_eq!(bars, ["", "  from bar 1", "  from bar 3"]);
    }

    #[test]
    fn times_are_written_in_the_form_in_which_they_are_read() {
        assert_eq!([0.0, 59.96, 80.5, 3600.0].map(clock), ["0:00.0", "1:00.0", "1:20.5", "60:00.0"]);
    }
}
