//! Finds the moments of a song where the scene may change.

use crate::bar_lines::BarLines;
use crate::cue_list::{Anchor, Length, When};
use mariana_music::{Section, SongStructure};

/// Minimum time in seconds between two scene changes. A change at a drop need not wait for this time.
const SECONDS_MIN: f64 = 8.0;
/// Usual time in seconds between two scene changes in a long section: first in calm music, then in loud music.
const SECONDS_USUAL: [f64; 2] = [40.0, 24.0];
/// Scene changes within a section are at multiples of this many bars.
const BARS_STEP: f64 = 4.0;
/// Number of bars at the end of a build in which scenes do not change.
const BUILD_BARS: f64 = 8.0;
/// If a section starts at most this many bars from a drop, the scene changes at the drop only.
const SAME_BARS: f64 = 1.0;

/// Energy assumed for a song that has no sections, or whose sections differ in energy by less than [`RANGE_MIN`].
const EVEN: f32 = 0.5;
const RANGE_MIN: f32 = 0.08;
/// Percentiles of a song's energy that count as calm and as loud.
const SPREAD: [f64; 2] = [0.1, 0.9];
/// Normalized energy of the calmest section.
const CALMEST: f32 = 0.15;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reason {
    Start,
    Section,
    Drop,
    /// The scene changes within a long section.
    Long,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Change<'a> {
    pub(super) when: When,
    /// The moment in seconds.
    pub(super) time: f64,
    pub(super) reason: Reason,
    pub(super) letter: Option<&'a str>,
    /// Energy before the change, 0..1. The next field is the energy after the change.
    pub(super) before: f32,
    pub(super) energy: f32,
}

/// Returns the changes of a song, sorted by time. The first change is at the start of the song.
pub(super) fn changes<'a>(song: &'a SongStructure, lines: &BarLines) -> Vec<Change<'a>> {
    let spread = Spread::of(song);
    let first = song.sections.first();
    let mut changes = vec![Change {
        when: at(Anchor::Start),
        time: 0.0,
        reason: Reason::Start,
        letter: first.map(|section| section.letter.as_str()),
        before: 0.0,
        energy: first.map_or(EVEN, |section| section.energy),
    }];
    let mut of_letter: Vec<&str> = Vec::new();
    for (index, section) in song.sections.iter().enumerate() {
        of_letter.push(&section.letter);
        if index > 0
            && !in_build(song, lines, section.start)
            && near_drop(song, lines, section.start).is_none()
        {
            let number = of_letter.iter().filter(|letter| **letter == section.letter).count() as u32;
            let anchor = Anchor::Section(section.letter.clone(), number);
            changes.push(change(song, at(anchor), section.start, Reason::Section));
        }
        changes.extend(within(song, lines, section));
    }
    for (index, time) in song.drops.iter().enumerate() {
        changes.push(change(song, at(Anchor::Drop(index as u32 + 1)), *time, Reason::Drop));
    }
    changes.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut kept: Vec<Change<'a>> = Vec::new();
    for change in changes {
        while let Some(last) = kept.last().filter(|last| change.time - last.time < SECONDS_MIN) {
            let gives_way =
                change.reason == Reason::Drop && !matches!(last.reason, Reason::Drop | Reason::Start);
            let is_weaker = change.reason == Reason::Section && last.reason == Reason::Long;
            if !(gives_way || is_weaker) {
                break;
            }
            kept.pop();
        }
        let room = kept.last().is_none_or(|last| change.time - last.time >= SECONDS_MIN);
        if room && (kept.is_empty() || song.seconds - change.time >= SECONDS_MIN)
            || change.reason == Reason::Drop
        {
            kept.push(change);
        }
    }
    for change in &mut kept {
        change.energy = spread.over_the_song(change.energy);
    }
    let energies: Vec<f32> = kept.iter().map(|change| change.energy).collect();
    for (change, before) in kept.iter_mut().skip(1).zip(energies) {
        change.before = before;
    }
    kept
}

/// The range of a song's energy. Energies are scaled to this range, so that verses differ from choruses even in a
/// song that is loud throughout.
struct Spread {
    least: f32,
    most: f32,
}

impl Spread {
    fn of(song: &SongStructure) -> Self {
        let mut sections: Vec<(f32, f64)> =
            song.sections.iter().map(|section| (section.energy, section.end - section.start)).collect();
        sections.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = sections.iter().map(|(_, seconds)| seconds).sum();
        // Weight sections by duration, so that a short calm ending does not make the rest of the song count as loud.
        let at = |fraction: f64| {
            let mut gone = 0.0;
            let found = sections.iter().find(|(_, seconds)| {
                gone += seconds;
                gone >= fraction * all
            });
            found.or(sections.last()).map_or(EVEN, |(energy, _)| *energy)
        };
        Self { least: at(SPREAD[0]), most: at(SPREAD[1]) }
    }

    fn over_the_song(&self, energy: f32) -> f32 {
        let range = self.most - self.least;
        // A song without contrast is neither calm nor loud.
        if range < RANGE_MIN || !range.is_finite() {
            return EVEN;
        }
        CALMEST + (1.0 - CALMEST) * ((energy - self.least) / range).clamp(0.0, 1.0)
    }
}

fn at(anchor: Anchor) -> When {
    When { anchor, offset: Length::ZERO }
}

fn change(song: &SongStructure, when: When, time: f64, reason: Reason) -> Change<'_> {
    let section = song.sections.iter().rev().find(|section| section.start <= time + 0.05);
    let energy = section.map_or(EVEN, |section| section.energy);
    let letter = section.map(|section| section.letter.as_str());
    Change { when, time, reason, letter, before: energy, energy }
}

fn within<'a>(song: &'a SongStructure, lines: &BarLines, section: &Section) -> Vec<Change<'a>> {
    let calm = 1.0 - f64::from(section.energy);
    let usual = SECONDS_USUAL[1] + (SECONDS_USUAL[0] - SECONDS_USUAL[1]) * calm;
    let pieces = ((section.end - section.start) / usual).round().max(1.0);
    if pieces < 2.0 || song.beats.is_empty() {
        return Vec::new();
    }
    let (first, last) = (lines.bar_at(section.start).round(), lines.bar_at(section.end).round());
    let step = ((last - first) / pieces / BARS_STEP).round().max(1.0) * BARS_STEP;
    let bars = (1..pieces as u32).map(|piece| first + f64::from(piece) * step);
    let fits =
        |bar: &f64| *bar >= 1.0 && *bar + BARS_STEP <= last && !in_build(song, lines, lines.time_of(*bar));
    let of_bar = |bar: f64| change(song, at(Anchor::Bar(bar as u32)), lines.time_of(bar), Reason::Long);
    bars.filter(fits).map(of_bar).collect()
}

/// True if `time` is in the last [`BUILD_BARS`] bars of a build.
pub(super) fn in_build(song: &SongStructure, lines: &BarLines, time: f64) -> bool {
    song.builds.iter().any(|build| {
        let first = build.start.max(lines.time_of(lines.bar_at(build.end) - BUILD_BARS));
        time > first - 0.05 && time < build.end - 0.05
    })
}

fn near_drop(song: &SongStructure, lines: &BarLines, time: f64) -> Option<f64> {
    let bars = |drop: f64| (lines.bar_at(drop) - lines.bar_at(time)).abs();
    song.drops.iter().copied().find(|drop| bars(*drop) <= SAME_BARS)
}
