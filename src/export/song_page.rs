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

/// Styles of texts: remarks, the times of the axis, and the numbers and names to its left.
const GREY: &str = "fill=\"#555\"";
const TICK: &str = "fill=\"#555\" text-anchor=\"middle\"";
const LABEL: &str = "font-size=\"10\" fill=\"#555\" text-anchor=\"end\"";

pub(super) fn page(name: &str, structure: &SongStructure, show: &[Clip]) -> String {
    let total = WIDTH + LEFT + 20.0;
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {HEIGHT}\" width=\"{total}\" \
         height=\"{HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut page = Page { svg, seconds: structure.seconds };
    page.text(LEFT, 24.0, "font-size=\"16\"", name);
    page.text(LEFT, 44.0, GREY, &summary(structure));
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
        page.text(4.0, top + height / 2.0 + 4.0, GREY, row);
    }
    page.sections(structure);
    page.curves(structure);
    page.beats(structure);
    page.pitches(structure);
    page.scenes(show);
    page.axis();
    page.svg + "</svg>\n"
}

/// The part of a page that is drawn already.
struct Page {
    svg: String,
    /// Length of the song, and of the time axis.
    seconds: f64,
}

impl Page {
    /// The place of a moment on the time axis, in pixels.
    fn x(&self, time: f64) -> f64 {
        LEFT + WIDTH * (time / self.seconds.max(1e-3)).clamp(0.0, 1.0)
    }

    fn text(&mut self, x: f64, y: f64, style: &str, words: &str) {
        let _ = writeln!(self.svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" {style}>{}</text>", escaped(words));
    }

    fn path(&mut self, steps: &str, style: &str) {
        let _ = writeln!(self.svg, "<path d=\"{steps}\" {style}/>");
    }

    /// Fills a row between two moments.
    fn bar(&mut self, start: f64, end: f64, row: (f64, f64), style: &str) {
        let (left, (top, height)) = (self.x(start), row);
        let width = (self.x(end) - left).max(0.5);
        let _ = writeln!(
            self.svg,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" {style}/>"
        );
    }

    /// Draws a line through points, which are moments and heights in pixels.
    fn curve(&mut self, points: impl Iterator<Item = (f64, f64)>, stroke: &str) {
        let points: Vec<String> = points.map(|(time, y)| format!("{:.1},{y:.1}", self.x(time))).collect();
        let _ = writeln!(self.svg, "<polyline points=\"{}\" fill=\"none\" {stroke}/>", points.join(" "));
    }

    fn sections(&mut self, structure: &SongStructure) {
        let mut letters = Vec::new();
        for section in &structure.sections {
            let style = format!("fill=\"{}\" stroke=\"white\"", fill_of(&mut letters, &section.letter));
            self.bar(section.start, section.end, SECTIONS, &style);
            let middle = (self.x(section.start) + self.x(section.end)) / 2.0;
            let style = "font-size=\"16\" text-anchor=\"middle\"";
            self.text(middle, SECTIONS.0 + 26.0, style, &section.letter);
        }
        for build in &structure.builds {
            let (left, right) = (self.x(build.start), self.x(build.end));
            let triangle = format!("M{left:.1} {}H{right:.1}V{}z", ENERGY.0 + ENERGY.1, WAVE.0);
            self.path(&triangle, "fill=\"#f9e79f\" opacity=\"0.7\"");
        }
        for drop in &structure.drops {
            let x = self.x(*drop);
            let line = format!("M{x:.1} {}V{}", WAVE.0, BEATS.0 + BEATS.1);
            self.path(&line, "stroke=\"#c0392b\" stroke-width=\"2\"");
            self.text(x + 3.0, WAVE.0 + 10.0, "fill=\"#c0392b\"", "drop");
        }
    }

    fn curves(&mut self, structure: &SongStructure) {
        let step = structure.energy_step;
        let mut wave = String::new();
        let peaks = thinned(&structure.peaks);
        for (index, peak) in &peaks {
            let half = f64::from(peak.min(1.0)) * WAVE.1 / 2.0;
            let (x, top) = (self.x((*index as f64 + 0.5) * step), WAVE.0 + WAVE.1 / 2.0 - half);
            let _ = write!(wave, "M{x:.1} {top:.1}v{:.1}", (2.0 * half).max(0.5));
        }
        let thickness = (WIDTH / peaks.len().max(1) as f64).clamp(0.7, 8.0);
        self.path(&wave, &format!("stroke=\"#34495e\" stroke-width=\"{thickness:.1}\""));
        let bottom = ENERGY.0 + ENERGY.1;
        let points = thinned(&structure.energy)
            .into_iter()
            .map(|(index, value)| ((index as f64 + 0.5) * step, bottom - f64::from(value) * ENERGY.1));
        self.curve(points, "stroke=\"#ca6f1e\" stroke-width=\"1.5\"");
    }

    fn beats(&mut self, structure: &SongStructure) {
        let Some(middle) = structure.tempo.map(f64::from) else { return };
        let (top, height) = BEATS;
        let (mut downbeats, mut others) = (String::new(), String::new());
        for beat in &structure.beats {
            let x = self.x(beat.time);
            if beat.of_bar == 1 {
                let _ = write!(downbeats, "M{x:.1} {top}v{height}");
            } else if structure.beats.len() <= COLUMNS_MAX {
                let _ = write!(others, "M{x:.1} {}v{}", top + height * 0.6, height * 0.4);
            }
        }
        self.path(&others, "stroke=\"#aab7b8\" stroke-width=\"0.7\"");
        self.path(&downbeats, "stroke=\"#2e86c1\" stroke-width=\"0.9\"");
        // Draw the median tempo in the middle of the row, and tempo 0 at the lower edge.
        let y = |tempo: f64| TEMPO.0 + TEMPO.1 * (1.0 - (tempo / middle / 2.0).clamp(0.0, 1.0));
        let every = structure.beats.len().div_ceil(COLUMNS_MAX).max(1);
        let points = structure.beats.iter().step_by(every);
        self.curve(points.map(|beat| (beat.time, y(f64::from(beat.tempo)))), "stroke=\"#239b56\"");
        self.text(LEFT - 4.0, y(middle) + 4.0, LABEL, &format!("{middle:.0}"));
    }

    fn pitches(&mut self, structure: &SongStructure) {
        let chords = structure.chords.iter().filter(|_| structure.chords.len() <= COLUMNS_MAX);
        for (chord, triad) in chords.filter_map(|chord| Some((chord, chord.triad?))) {
            let (left, right) = (self.x(chord.start), self.x(chord.end));
            let minor = if triad.mode == mariana_music::Mode::Minor { "m" } else { "" };
            let name = format!("{}{minor}", triad.root_name());
            self.path(&format!("M{left:.1} {}v{}", CHORDS.0, CHORDS.1), "stroke=\"#ccc\"");
            if right - left > 7.0 * name.len() as f64 {
                self.text(left + 2.0, CHORDS.0 + 16.0, "font-size=\"10\"", &name);
            }
        }
        let height = CHROMA.1 / 12.0;
        let top = |class: usize| CHROMA.0 + CHROMA.1 - (class + 1) as f64 * height;
        for (class, name) in PITCH_CLASSES.iter().enumerate() {
            self.text(LEFT - 4.0, top(class) + height * 0.75, LABEL, name);
        }
        let every = structure.chroma.len().div_ceil(COLUMNS_MAX).max(1);
        let next = structure.chroma.iter().skip(every).step_by(every).map(|unit| unit.start);
        let ends = next.chain([structure.seconds]);
        for (unit, end) in structure.chroma.iter().step_by(every).zip(ends) {
            let largest = unit.fractions.iter().copied().fold(0.0, f32::max);
            for (class, fraction) in unit.fractions.iter().enumerate() {
                let strength = if largest > 0.0 { fraction / largest } else { 0.0 };
                if strength >= 0.15 {
                    let style = format!("fill=\"#512e5f\" opacity=\"{:.2}\"", strength * strength);
                    self.bar(unit.start, end, (top(class), height), &style);
                }
            }
        }
    }

    fn scenes(&mut self, clips: &[Clip]) {
        let (top, height) = SHOW;
        let bottom = top + height;
        let mut names = Vec::new();
        let mut groups = clips.chunk_by(|a, b| a.scene == b.scene).peekable();
        while let Some([clip, cuts @ ..]) = groups.next() {
            let next = groups.peek().and_then(|next| next.first());
            let end = next.map_or(self.seconds, |next| next.start);
            let whole = self.x((clip.start + clip.transition.seconds).min(end));
            let (left, right) = (self.x(clip.start), self.x(end));
            let area = format!("M{left:.1} {bottom}L{whole:.1} {top}H{right:.1}V{bottom}z");
            let fill = fill_of(&mut names, &clip.scene);
            self.path(&area, &format!("fill=\"{fill}\" stroke=\"white\""));
            for cut in cuts {
                let line = format!("M{:.1} {top}v{height}", self.x(cut.start));
                self.path(&line, "stroke=\"white\"");
            }
            let name = clip.scene.rsplit('/').next().unwrap_or(&clip.scene);
            if right - left > 6.5 * name.chars().count() as f64 {
                self.text((left + right) / 2.0, top + 17.0, "text-anchor=\"middle\"", name);
            }
        }
    }

    fn axis(&mut self) {
        let steps = [1.0, 5.0, 10.0, 30.0, 60.0, 300.0, 600.0, 1800.0];
        let step = steps.into_iter().find(|step| self.seconds / step <= 16.0).unwrap_or(3600.0);
        for number in 0..=(self.seconds / step) as u32 {
            let time = f64::from(number) * step;
            let x = self.x(time);
            self.path(&format!("M{x:.1} {}v-6", AXIS - 8.0), "stroke=\"#555\"");
            self.text(x, AXIS + 8.0, TICK, clock(time).trim_end_matches(".0"));
        }
    }
}

/// Returns the colour of a name. `names` holds the names so far.
fn fill_of<'a>(names: &mut Vec<&'a str>, name: &'a str) -> &'static str {
    let number = names.iter().position(|known| *known == name).unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    });
    FILLS[number % FILLS.len()]
}

/// Divides the values into at most [`COLUMNS_MAX`] chunks. Returns each chunk's largest value and first index.
fn thinned(values: &[f32]) -> Vec<(usize, f32)> {
    let every = values.len().div_ceil(COLUMNS_MAX).max(1);
    let largest =
        |(number, chunk): (usize, &[f32])| (number * every, chunk.iter().copied().fold(0.0, f32::max));
    values.chunks(every).enumerate().map(largest).collect()
}

/// Escapes text for XML. Leaves out characters that XML does not allow.
fn escaped(text: &str) -> String {
    let is_allowed = |letter: &char| !letter.is_control() && !matches!(letter, '\u{fffe}' | '\u{ffff}');
    let allowed: String = text.chars().filter(is_allowed).collect();
    allowed.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
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
