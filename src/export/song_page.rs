//! A song on one page as SVG: waveform, energy, beats, sections, tempo, chords, chroma, and the director's show.

use std::fmt::Write as _;

use super::structure::{clock, summary};
use crate::show::Clip;
use mariana_music::{PITCH_CLASSES, SongStructure};

/// Width of the time axis, in pixels.
const WIDTH: f64 = 1400.0;
/// Width of the rows' names to the left of the time axis, in pixels.
const LEFT: f64 = 70.0;
/// Upper edge and height of each row, in pixels.
const SECTIONS: (f64, f64) = (60.0, 40.0);
const WAVE: (f64, f64) = (110.0, 110.0);
const ENERGY: (f64, f64) = (230.0, 70.0);
const BEATS: (f64, f64) = (310.0, 40.0);
const TEMPO: (f64, f64) = (360.0, 70.0);
const CHORDS: (f64, f64) = (440.0, 24.0);
const CHROMA: (f64, f64) = (474.0, 168.0);
const SHOW: (f64, f64) = (652.0, 26.0);
const AXIS: f64 = 700.0;
const HEIGHT: f64 = 730.0;

const COLUMNS_MAX: usize = 1400;

/// Fill colours, assigned to sections and to scenes in the order in which they first appear.
const FILLS: [&str; 8] =
    ["#7fb3d5", "#f0b27a", "#82e0aa", "#d7bde2", "#f7dc6f", "#f1948a", "#76d7c4", "#ccd1d1"];

pub(super) fn page(name: &str, structure: &SongStructure, show: &[Clip]) -> String {
    let mut svg = String::new();
    let total = WIDTH + LEFT + 20.0;
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {HEIGHT}\" width=\"{total}\" \
         height=\"{HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"24\" font-size=\"16\">{}</text>\n<text x=\"{LEFT}\" y=\"44\" fill=\"#555\">{}</text>\n",
        escaped(name),
        escaped(&summary(structure)),
    );
    let rows = [
        ("sections", SECTIONS),
        ("wave", WAVE),
        ("energy", ENERGY),
        ("beats", BEATS),
        ("tempo", TEMPO),
        ("chords", CHORDS),
        ("show", SHOW),
    ];
    for (row, (top, height)) in rows {
        let _ =
            writeln!(svg, "<text x=\"4\" y=\"{:.1}\" fill=\"#555\">{row}</text>", top + height / 2.0 + 4.0);
    }
    let x = |time: f64| LEFT + WIDTH * (time / structure.seconds.max(1e-3)).clamp(0.0, 1.0);
    sections(&mut svg, structure, &x);
    curves(&mut svg, structure, &x);
    beats(&mut svg, structure, &x);
    pitches(&mut svg, structure, &x);
    scenes(&mut svg, show, structure.seconds, &x);
    axis(&mut svg, structure.seconds, &x);
    svg.push_str("</svg>\n");
    svg
}

fn sections(svg: &mut String, structure: &SongStructure, x: &dyn Fn(f64) -> f64) {
    let mut letters: Vec<&str> = Vec::new();
    for section in &structure.sections {
        let number = letters.iter().position(|letter| *letter == section.letter).unwrap_or(letters.len());
        if number == letters.len() {
            letters.push(&section.letter);
        }
        let (left, right) = (x(section.start), x(section.end));
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.1}\" y=\"{}\" width=\"{:.1}\" height=\"{}\" fill=\"{}\" stroke=\"white\"/>\
             <text x=\"{:.1}\" y=\"{}\" font-size=\"16\" text-anchor=\"middle\">{}</text>",
            SECTIONS.0,
            right - left,
            SECTIONS.1,
            FILLS[number % FILLS.len()],
            (left + right) / 2.0,
            SECTIONS.0 + 26.0,
            section.letter,
        );
    }
    for build in &structure.builds {
        let (top, bottom) = (WAVE.0, ENERGY.0 + ENERGY.1);
        let _ = writeln!(
            svg,
            "<polygon points=\"{:.1},{bottom} {:.1},{bottom} {:.1},{top}\" fill=\"#f9e79f\" opacity=\"0.7\"/>",
            x(build.start),
            x(build.end),
            x(build.end),
        );
    }
    for drop in &structure.drops {
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {}V{}\" stroke=\"#c0392b\" stroke-width=\"2\"/>\
             <text x=\"{:.1}\" y=\"{}\" fill=\"#c0392b\">drop</text>",
            x(*drop),
            WAVE.0,
            BEATS.0 + BEATS.1,
            x(*drop) + 3.0,
            WAVE.0 + 10.0,
        );
    }
}

fn curves(svg: &mut String, structure: &SongStructure, x: &dyn Fn(f64) -> f64) {
    let step = structure.energy_step;
    let middle = WAVE.0 + WAVE.1 / 2.0;
    let mut wave = String::new();
    let peaks = thinned(&structure.peaks);
    for (index, peak) in &peaks {
        let half = f64::from(peak.min(1.0)) * WAVE.1 / 2.0;
        let _ = write!(
            wave,
            "M{:.1} {:.1}v{:.1}",
            x((*index as f64 + 0.5) * step),
            middle - half,
            (2.0 * half).max(0.5)
        );
    }
    let thickness = (WIDTH / peaks.len().max(1) as f64).clamp(0.7, 8.0);
    let _ = writeln!(
        svg,
        "<path d=\"{wave}\" stroke=\"#34495e\" stroke-width=\"{thickness:.1}\" fill=\"none\"/>"
    );
    let bottom = ENERGY.0 + ENERGY.1;
    let points = thinned(&structure.energy)
        .into_iter()
        .map(|(index, value)| (x((index as f64 + 0.5) * step), bottom - f64::from(value) * ENERGY.1));
    polyline(svg, points, "stroke=\"#ca6f1e\" stroke-width=\"1.5\"");
    svg.push('\n');
}

fn polyline(svg: &mut String, points: impl Iterator<Item = (f64, f64)>, stroke: &str) {
    let points: Vec<String> = points.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = write!(svg, "<polyline points=\"{}\" fill=\"none\" {stroke}/>", points.join(" "));
}

/// Divides the values into at most [`COLUMNS_MAX`] chunks. Returns each chunk's largest value and first index.
fn thinned(values: &[f32]) -> Vec<(usize, f32)> {
    let every = values.len().div_ceil(COLUMNS_MAX).max(1);
    let largest =
        |(number, chunk): (usize, &[f32])| (number * every, chunk.iter().copied().fold(0.0, f32::max));
    values.chunks(every).enumerate().map(largest).collect()
}

fn beats(svg: &mut String, structure: &SongStructure, x: &dyn Fn(f64) -> f64) {
    let Some(middle) = structure.tempo.map(f64::from) else { return };
    let (top, height) = BEATS;
    let (mut downbeats, mut others) = (String::new(), String::new());
    for beat in &structure.beats {
        if beat.of_bar == 1 {
            let _ = write!(downbeats, "M{:.1} {top}v{height}", x(beat.time));
        } else if structure.beats.len() <= COLUMNS_MAX {
            let _ = write!(others, "M{:.1} {}v{}", x(beat.time), top + height * 0.6, height * 0.4);
        }
    }
    let _ = writeln!(svg, "<path d=\"{others}\" stroke=\"#aab7b8\" stroke-width=\"0.7\"/>");
    let _ = writeln!(svg, "<path d=\"{downbeats}\" stroke=\"#2e86c1\" stroke-width=\"0.9\"/>");
    // Draw the median tempo in the middle of the row, and tempo 0 at the lower edge.
    let y = |tempo: f64| TEMPO.0 + TEMPO.1 * (1.0 - (tempo / middle / 2.0).clamp(0.0, 1.0));
    let every = structure.beats.len().div_ceil(COLUMNS_MAX).max(1);
    let points = structure.beats.iter().step_by(every);
    polyline(svg, points.map(|beat| (x(beat.time), y(f64::from(beat.tempo)))), "stroke=\"#239b56\"");
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"10\" fill=\"#555\" text-anchor=\"end\">{middle:.0}</text>",
        LEFT - 4.0,
        y(middle) + 4.0,
    );
}

fn pitches(svg: &mut String, structure: &SongStructure, x: &dyn Fn(f64) -> f64) {
    if structure.chords.len() <= COLUMNS_MAX {
        for chord in &structure.chords {
            let Some(triad) = chord.triad else { continue };
            let (left, right) = (x(chord.start), x(chord.end));
            let minor = if triad.mode == mariana_music::Mode::Minor { "m" } else { "" };
            let name = format!("{}{minor}", triad.root_name());
            let _ = write!(svg, "<path d=\"M{left:.1} {}v{}\" stroke=\"#ccc\"/>", CHORDS.0, CHORDS.1);
            if right - left > 7.0 * name.len() as f64 {
                let _ = write!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{}\" font-size=\"10\">{name}</text>",
                    left + 2.0,
                    CHORDS.0 + 16.0
                );
            }
        }
    }
    let height = CHROMA.1 / 12.0;
    for (class, name) in PITCH_CLASSES.iter().enumerate() {
        let y = CHROMA.0 + CHROMA.1 - (class + 1) as f64 * height;
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"10\" fill=\"#555\" text-anchor=\"end\">{name}</text>",
            LEFT - 4.0,
            y + height * 0.75
        );
    }
    let every = structure.chroma.len().div_ceil(COLUMNS_MAX).max(1);
    let ends =
        structure.chroma.iter().skip(every).step_by(every).map(|unit| unit.start).chain([structure.seconds]);
    for (unit, end) in structure.chroma.iter().step_by(every).zip(ends) {
        let largest = unit.fractions.iter().copied().fold(0.0, f32::max);
        for (class, fraction) in unit.fractions.iter().enumerate() {
            let strength = if largest > 0.0 { fraction / largest } else { 0.0 };
            if strength < 0.15 {
                continue;
            }
            let _ = write!(
                svg,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{height:.1}\" fill=\"#512e5f\" opacity=\"{:.2}\"/>",
                x(unit.start),
                CHROMA.0 + CHROMA.1 - (class + 1) as f64 * height,
                (x(end) - x(unit.start)).max(0.5),
                strength * strength,
            );
        }
    }
    svg.push('\n');
}

fn scenes(svg: &mut String, clips: &[Clip], seconds: f64, x: &dyn Fn(f64) -> f64) {
    let (top, height) = SHOW;
    let mut names: Vec<&str> = Vec::new();
    let mut from = 0;
    while let Some(clip) = clips.get(from) {
        let cuts = clips[from..].iter().take_while(|other| other.scene == clip.scene).count();
        let behind = from + cuts;
        let end = clips.get(behind).map_or(seconds, |next| next.start);
        let number = names.iter().position(|name| *name == clip.scene).unwrap_or(names.len());
        if number == names.len() {
            names.push(&clip.scene);
        }
        let (left, right, whole) =
            (x(clip.start), x(end), x((clip.start + clip.transition.seconds).min(end)));
        let name = escaped(clip.scene.rsplit('/').next().unwrap_or(&clip.scene));
        let _ = write!(
            svg,
            "<polygon points=\"{left:.1},{bottom} {whole:.1},{top} {right:.1},{top} {right:.1},{bottom}\" fill=\"{}\" \
             stroke=\"white\"/>",
            FILLS[number % FILLS.len()],
            bottom = top + height,
        );
        for cut in &clips[from + 1..behind] {
            let _ = write!(svg, "<path d=\"M{:.1} {top}v{height}\" stroke=\"white\"/>", x(cut.start));
        }
        if right - left > 6.5 * name.chars().count() as f64 {
            let middle = (left + right) / 2.0;
            let _ = writeln!(
                svg,
                "<text x=\"{middle:.1}\" y=\"{}\" text-anchor=\"middle\">{name}</text>",
                top + 17.0
            );
        }
        from = behind;
    }
}

fn axis(svg: &mut String, seconds: f64, x: &dyn Fn(f64) -> f64) {
    let steps = [1.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 1800.0];
    let step = steps.into_iter().find(|step| seconds / step <= 16.0).unwrap_or(3600.0);
    for number in 0..=(seconds / step) as u32 {
        let time = f64::from(number) * step;
        let _ = writeln!(
            svg,
            "<path d=\"M{0:.1} {1}v-6\" stroke=\"#555\"/><text x=\"{0:.1}\" y=\"{2}\" fill=\"#555\" \
             text-anchor=\"middle\">{3}</text>",
            x(time),
            AXIS - 8.0,
            AXIS + 8.0,
            clock(time).trim_end_matches(".0"),
        );
    }
}

/// Escapes text for XML. Leaves out characters that XML does not allow.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in text
        .chars()
        .filter(|character| !character.is_control() && !matches!(character, '\u{fffe}' | '\u{ffff}'))
    {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_text_and_no_tags() {
        let svg = page("<b> & \u{1}co", &SongStructure::default(), &[]);
        assert!(svg.contains("&lt;b&gt; &amp; co") && svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    }
}
