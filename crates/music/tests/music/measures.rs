//! Compares the analysis of synthetic songs with their true beats and sections.

use mariana_music::{Alignment, Analyzer, Features, Section, SongListener, SongStructure, StereoFrame};

use super::super::events::{f_of, matches};
use super::Truth;

pub(crate) fn structure(rate: u32, frames: &[StereoFrame]) -> SongStructure {
    let mut listener = SongListener::new(rate);
    listener.push(frames);
    listener.finish()
}

/// Returns the beats of these samples as live input, in seconds, with the number of each beat in its bar.
pub(crate) fn beats_heard(rate: u32, frames: &[StereoFrame]) -> Vec<(f64, f32)> {
    let mut beats = Vec::new();
    let mut before = (0.0, Features::SILENCE);
    Analyzer::new(rate, Alignment::Trailing).push(frames, &mut |moment| {
        let (time, last) = before;
        let (from, to) = (last.phase, moment.features.phase);
        if last.tempo > 0.0 && moment.features.tempo > 0.0 && to < from - 0.5 {
            let fraction = f64::from(to / (to + 1.0 - from));
            beats.push((moment.time - (moment.time - time) * fraction, moment.features.bar_beat));
        }
        before = (moment.time, moment.features);
    });
    beats
}

/// Returns the fraction of beats with a known bar position, and the fraction of bars that start at a true downbeat.
pub(crate) fn bars_heard(beats: &[(f64, f32)], truth: &Truth) -> [f64; 2] {
    let reported = beats.iter().filter(|(_, beat)| *beat > 0.0).count();
    let firsts: Vec<f64> = beats.iter().filter(|(_, beat)| *beat == 1.0).map(|(time, _)| *time).collect();
    let is_right = |time: &&f64| truth.downbeats.iter().any(|truly| (*time - truly).abs() < 0.07);
    let right = firsts.iter().filter(is_right).count();
    [reported as f64 / beats.len().max(1) as f64, right as f64 / firsts.len().max(1) as f64]
}

/// Returns the F-measure of times. Each time is matched with a true time within `tolerance` seconds.
pub(crate) fn f_measure(found: &[f64], truth: &[f64], tolerance: f64) -> f64 {
    f_of(matches(found, truth, tolerance))
}

pub(crate) fn borders(structure: &SongStructure) -> Vec<f64> {
    structure.sections.iter().skip(1).map(|section| section.start).collect()
}

/// Returns the pairwise F-measure of labels, sampled twice a second (Levy and Sandler 2008).
pub(crate) fn labels(structure: &SongStructure, truth: &Truth) -> f64 {
    let (mut both, mut ours, mut theirs) = (0_u32, 0_u32, 0_u32);
    let letters: Vec<(Option<&str>, Option<char>)> = (0..(structure.seconds * 2.0) as u32)
        .map(|half| {
            let time = f64::from(half) / 2.0 + 0.25;
            let section = structure.sections.iter().find(|s| (s.start..s.end).contains(&time));
            let part = truth.letters.iter().find(|(start, end, _)| (*start..*end).contains(&time));
            (section.map(|s| s.letter.as_str()), part.map(|(.., letter)| *letter))
        })
        .filter(|(_, part)| part.is_some())
        .collect();
    for (index, a) in letters.iter().enumerate() {
        for b in &letters[..index] {
            let (same, truly) = (a.0 == b.0, a.1 == b.1);
            ours += u32::from(same);
            theirs += u32::from(truly);
            both += u32::from(same && truly);
        }
    }
    2.0 * f64::from(both) / f64::from((ours + theirs).max(1))
}

/// Returns the number of sections with the letter of an earlier section that is truly another part.
pub(crate) fn false_returns(structure: &SongStructure, truth: &Truth) -> usize {
    let part = |section: &Section| truth.letter(section.start, section.end);
    let is_false = |(index, section): (usize, &Section)| {
        let before = structure.sections.iter().take(index);
        before.filter(|other| other.letter == section.letter).any(|other| part(other) != part(section))
    };
    structure.sections.iter().enumerate().filter(|entry| is_false(*entry)).count()
}
