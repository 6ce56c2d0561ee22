//! Finds the moments of a song where the scene or the camera may change.

use super::character::{Character, Characters};
use crate::bar_lines::BarLines;
use crate::cue_list::{Anchor, Length, When};
use mariana_music::{Section, SongStructure};

/// Minimum time in seconds between two changes that nothing in the music calls for: at most four in a minute.
const FREE_SECONDS_MIN: f64 = 16.0;
/// Time in seconds for which a picture is held: first in calm music without contrast, then in loud music of full
/// contrast.
const HOLD_SECONDS: [f64; 2] = [34.0, 17.0];
/// How much of the energy shortens the hold in a song without contrast.
const WITHOUT_CONTRAST: f32 = 0.5;
/// A section's start changes the picture if the last change was at least this part of the hold ago.
const BORDER_HOLD: f64 = 0.5;
/// Minimum time in seconds between two changes. A change at a drop need not wait for this time.
const SECONDS_MIN: f64 = 12.0;
/// Nothing but a drop changes the picture in this time before the end of the song, in seconds.
const END_SECONDS: f64 = 8.0;
/// Changes within a section are at multiples of this many bars.
const BARS_STEP: f64 = 4.0;
/// Number of bars at the end of a build in which nothing changes.
const BUILD_BARS: f64 = 8.0;
/// If a section starts at most this many bars from a drop, the scene changes at the drop only.
const SAME_BARS: f64 = 1.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reason {
    Start,
    Section,
    Drop,
    /// The last change was long ago.
    Long,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Change<'a> {
    pub(super) when: When,
    /// The moment in seconds.
    pub(super) time: f64,
    pub(super) reason: Reason,
    pub(super) letter: Option<&'a str>,
    /// Energy before the change, 0..1.
    pub(super) before: f32,
    /// The music after the change.
    pub(super) music: Character,
}

/// Returns the changes of a song, sorted by time. The first change is at the start of the song.
pub(super) fn changes<'a>(song: &'a SongStructure, lines: &BarLines) -> Vec<Change<'a>> {
    let characters = Characters::of(song);
    let hold = |time: f64| hold(characters.at(song, time).energy(), characters.contrast);
    let mut wanted = vec![change(song, &characters, at(Anchor::Start), 0.0, Reason::Start)];
    wanted.extend(
        borders(song, lines).map(|(when, time)| change(song, &characters, when, time, Reason::Section)),
    );
    for (index, time) in song.drops.iter().enumerate() {
        let when = at(Anchor::Drop(index as u32 + 1));
        wanted.push(change(song, &characters, when, *time, Reason::Drop));
    }
    wanted.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut kept: Vec<Change<'a>> = Vec::new();
    for change in wanted {
        let since = |kept: &[Change<'a>]| kept.last().map_or(f64::INFINITY, |last| change.time - last.time);
        if change.reason == Reason::Drop {
            while since(&kept) < SECONDS_MIN && kept.last().is_some_and(|last| last.reason == Reason::Section)
            {
                kept.pop();
            }
            kept.push(change);
        } else if since(&kept) >= SECONDS_MIN.max(BORDER_HOLD * hold(change.time))
            && (kept.is_empty() || song.seconds - change.time >= END_SECONDS)
        {
            kept.push(change);
        }
    }
    let ends: Vec<f64> = kept.iter().skip(1).map(|next| next.time).chain([song.seconds]).collect();
    let mut all = Vec::new();
    for (change, end) in kept.into_iter().zip(ends) {
        let start = change.time;
        all.push(change);
        all.extend(
            between(song, lines, start, end, hold(start))
                .into_iter()
                .map(|(when, time)| self::change(song, &characters, when, time, Reason::Long)),
        );
    }
    let energies: Vec<f32> = all.iter().map(|change| change.music.energy()).collect();
    for (change, before) in all.iter_mut().skip(1).zip(energies) {
        change.before = before;
    }
    all
}

/// Returns how long a picture is held, in seconds.
fn hold(energy: f32, contrast: f32) -> f64 {
    let liveliness = energy * (WITHOUT_CONTRAST + (1.0 - WITHOUT_CONTRAST) * contrast);
    HOLD_SECONDS[0] + (HOLD_SECONDS[1] - HOLD_SECONDS[0]) * f64::from(liveliness.clamp(0.0, 1.0))
}

/// Returns the starts of all sections but the first, except during builds and next to drops.
fn borders<'a>(song: &'a SongStructure, lines: &'a BarLines) -> impl Iterator<Item = (When, f64)> + 'a {
    let of_letter = |letter: &str, until: usize| {
        let before: &[Section] = song.sections.get(..=until).unwrap_or_default();
        before.iter().filter(|section| section.letter == letter).count() as u32
    };
    let starts = song.sections.iter().enumerate().skip(1);
    let fits = |section: &Section| {
        !in_build(song, lines, section.start) && near_drop(song, lines, section.start).is_none()
    };
    starts.filter(move |(_, section)| fits(section)).map(move |(index, section)| {
        let number = of_letter(&section.letter, index);
        (at(Anchor::Section(section.letter.clone(), number)), section.start)
    })
}

/// Returns moments between two changes, such that no picture is held much longer than `hold` seconds.
fn between(song: &SongStructure, lines: &BarLines, start: f64, end: f64, hold: f64) -> Vec<(When, f64)> {
    let pieces = ((end - start) / hold).round().clamp(0.0, 1e4);
    if pieces < 2.0 || song.sections.is_empty() {
        return Vec::new();
    }
    let (first, last) = (lines.bar_at(start).round(), lines.bar_at(end).round());
    let step = ((last - first) / pieces / BARS_STEP).round().max(1.0) * BARS_STEP;
    let mut found = Vec::new();
    let mut before = start;
    let mut bar = first + step;
    while bar + BARS_STEP <= last && found.len() < pieces as usize {
        let time = lines.time_of(bar);
        let has_room = time - before >= FREE_SECONDS_MIN && end - time >= SECONDS_MIN;
        if bar >= 1.0 && has_room && !in_build(song, lines, time) {
            found.push((at(Anchor::Bar(bar as u32)), time));
            before = time;
        }
        bar += step;
    }
    found
}

fn at(anchor: Anchor) -> When {
    When { anchor, offset: Length::ZERO }
}

fn change<'a>(
    song: &'a SongStructure,
    characters: &Characters,
    when: When,
    time: f64,
    reason: Reason,
) -> Change<'a> {
    let section = song.sections.iter().rev().find(|section| section.start <= time + 0.05);
    let letter = section.or(song.sections.first()).map(|section| section.letter.as_str());
    Change { when, time, reason, letter, before: 0.0, music: characters.at(song, time) }
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
