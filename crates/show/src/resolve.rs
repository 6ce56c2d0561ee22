//! Resolves a cue list for a song: musical moments become seconds.

use super::bar_lines::BarLines;
use super::cue_list::{Anchor, CueList, Entry, Length, Setting, Step, Transition, TransitionKind};
use super::timeline::{Clip, Move, TimedTransition, Timeline};
use mariana_field::lang::{Diagnostic, Span, TransitionStyle};
use mariana_music::SongStructure;

/// The transition if neither the entry nor the scene specifies a transition.
const USUAL: Transition =
    Transition { kind: TransitionKind::Fade, length: Length::Seconds(1.0), ..Transition::CUT };
/// Duration in bars of a scene's preferred transition.
const USUAL_BARS: f64 = 1.0;

/// Resolves a cue list for a song. Returns the timeline, and a diagnostic for each entry that is left out because the
/// song lacks its moment. The timeline is `None` if all entries are left out or wait for a key. `cues` are the
/// moments in seconds when the cue key was pressed. Each press triggers the next waiting entry. `likes` returns the
/// preferred transition between two scenes, if any. Its first argument is the outgoing scene, if any.
pub fn resolve(
    cue_list: &CueList,
    song: &SongStructure,
    cues: &[f64],
    likes: impl Fn(Option<&str>, &str) -> Option<TransitionStyle>,
) -> (Option<Timeline>, Vec<Diagnostic>) {
    let lines = BarLines::of(song);
    let mut left_out = Vec::new();
    let mut clips: Vec<Clip> = Vec::new();
    for (entry, start) in cue_list.entries.iter().zip(starts(cue_list, song, cues, &lines)) {
        let start = match start {
            Ok(Some(start)) => start,
            Ok(None) => continue,
            Err(diagnostic) => {
                left_out.push(*diagnostic);
                continue;
            }
        };
        let Transition { kind, length, unfinished, by_fader } = entry.transition.unwrap_or_else(|| {
            let style = likes(clips.last().map(|clip| clip.scene.as_str()), &entry.scene);
            style.map_or(USUAL, |style| Transition::new(style, Length::Bars(USUAL_BARS)))
        });
        let seconds = lasting(length, start, &lines);
        let transition = TimedTransition { kind, seconds, unfinished, by_fader };
        let mut moves: Vec<Move> =
            entry.settings.iter().flat_map(|setting| moves_of(setting, start, &lines)).collect();
        moves.sort_by(|a, b| a.start.total_cmp(&b.start));
        let (scene, camera) = (entry.scene.clone(), entry.camera.clone());
        clips.push(Clip { start, scene, camera, transition, moves });
    }
    (Timeline::new(clips), left_out)
}

/// Returns the start of each entry in seconds, in the order of the cue list. It is `None` for an entry that waits for a
/// press of the cue key, and for an entry whose moment the song lacks.
pub(super) fn entry_starts(cue_list: &CueList, song: &SongStructure, cues: &[f64]) -> Vec<Option<f64>> {
    let starts = starts(cue_list, song, cues, &BarLines::of(song));
    starts.into_iter().map(|start| start.ok().flatten()).collect()
}

/// The start of each entry in seconds; `None` while it waits for a key, and a diagnostic if the entry is left out.
fn starts(
    cue_list: &CueList,
    song: &SongStructure,
    cues: &[f64],
    lines: &BarLines,
) -> Vec<Result<Option<f64>, Box<Diagnostic>>> {
    // The last entry that does not depend on a press, and the start of the entry above.
    let (mut last, mut previous): (Option<(f64, Span)>, Option<f64>) = (None, Some(0.0));
    // True if a press decides about the entry above.
    let mut is_pressed = false;
    let mut cues = cues.iter();
    let mut start = |entry: &Entry| {
        let is_cue = entry.when.anchor == Anchor::Cue;
        is_pressed = is_cue || (is_pressed && entry.when.anchor == Anchor::Previous);
        let known = match entry.when.anchor {
            Anchor::Cue => cues.next().copied(),
            _ => previous,
        };
        let start = time_of(entry, song, known, lines)?;
        previous = start;
        let Some(time) = start.filter(|_| !is_pressed) else { return Ok(start) };
        if let Some((before, span)) = last.filter(|(before, _)| time < *before) {
            let back =
                format!("this entry is at {}, before the previous entry at {}", clock(time), clock(before));
            let backwards =
                Diagnostic::warning(entry.span, back).label("left out").note(span, "the previous entry");
            return Err(Box::new(backwards.hint("sort the entries by time")));
        }
        // A song cut short is longer than its structure, and a live input has no length.
        if time > song.seconds + 1e-3 && song.seconds > 0.0 && !song.cut_short {
            let late =
                format!("the song ends at {}, before this entry at {}", clock(song.seconds), clock(time));
            let late = Diagnostic::warning(entry.span, late).label("left out");
            return Err(Box::new(late.hint("choose an earlier moment, such as `end - 4 bars`")));
        }
        last = Some((time, entry.span));
        Ok(start)
    };
    cue_list.entries.iter().map(&mut start).collect()
}

fn moves_of(setting: &Setting, start: f64, lines: &BarLines) -> Vec<Move> {
    let param = || setting.param.clone();
    let (mut begin, mut from) = (start + lasting(setting.after, start, lines), setting.from);
    if setting.steps.is_empty() {
        return vec![Move { param: param(), start: begin, seconds: 0.0, from, to: from }];
    }
    let part = |step: &Step| {
        let seconds = lasting(step.over, begin, lines);
        let part = Move { param: param(), start: begin, seconds, from, to: step.to };
        (begin, from) = (begin + seconds, step.to);
        part
    };
    setting.steps.iter().map(part).collect()
}

/// Returns the time of a moment in seconds; `None` if the moment waits for a press of the cue key. `known` is the time
/// of the press, or of the entry above.
fn time_of(
    entry: &Entry,
    song: &SongStructure,
    known: Option<f64>,
    lines: &BarLines,
) -> Result<Option<f64>, Box<Diagnostic>> {
    let missing = |sentence: String, hint: String| {
        Box::new(Diagnostic::warning(entry.span, sentence).label("left out").hint(hint))
    };
    let numbered = |what: &str, number: u32, times: &[f64]| {
        let index = (number as usize).checked_sub(1);
        index.and_then(|index| times.get(index)).copied().ok_or_else(|| {
            let hint = match times.len() {
                0 => format!("the song has no {what}s"),
                count => format!("the song has {count}: see `mariana analyze --structure`"),
            };
            missing(format!("the song has no {what} {number}"), hint)
        })
    };
    let anchor = match &entry.when.anchor {
        Anchor::Start => 0.0,
        Anchor::End => song.seconds,
        Anchor::Time(seconds) => *seconds,
        Anchor::Cue | Anchor::Previous => match known {
            Some(seconds) => seconds,
            None => return Ok(None),
        },
        Anchor::Bar(bar) => lines.time_of(f64::from(*bar)),
        Anchor::Drop(number) => numbered("drop", *number, &song.drops)?,
        Anchor::Build(number) => {
            let starts: Vec<f64> = song.builds.iter().map(|build| build.start).collect();
            numbered("build", *number, &starts)?
        }
        Anchor::Section(letter, number) => {
            let of_letter = song.sections.iter().filter(|section| section.letter == *letter);
            let starts: Vec<f64> = of_letter.map(|section| section.start).collect();
            if starts.is_empty() {
                let mut letters: Vec<&str> = song.sections.iter().map(|one| one.letter.as_str()).collect();
                letters.dedup();
                let hint = match letters.len() {
                    0 => "the song has no sections".to_owned(),
                    _ => format!("the song's sections are {}", letters.join(" ")),
                };
                return Err(missing(format!("the song has no section {letter}"), hint));
            }
            numbered(&format!("section {letter}"), *number, &starts)?
        }
    };
    Ok(Some(anchor + lasting(entry.when.offset, anchor, lines)))
}

/// Converts a length that begins at `start` to seconds.
fn lasting(length: Length, start: f64, lines: &BarLines) -> f64 {
    let bars = match length {
        Length::Seconds(seconds) => return seconds,
        Length::Bars(bars) => bars,
        Length::Beats(beats) => beats / lines.beats(),
    };
    lines.time_of(lines.bar_at(start) + bars) - start
}

/// Formats a time as `1:23.5`, rounded to milliseconds, because a frame is longer than a millisecond.
pub(super) fn clock(seconds: f64) -> String {
    clock_to(seconds, 3)
}

/// Formats a time with at most `decimals` decimals, without trailing zeros.
pub(super) fn clock_to(seconds: f64, decimals: usize) -> String {
    let second = 10_u64.pow(decimals as u32);
    let all = (seconds.max(0.0) * second as f64).round() as u64;
    let (minutes, rest) = (all / (60 * second), all % (60 * second));
    let text = format!("{minutes}:{:02}.{:0decimals$}", rest / second, rest % second);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
pub(super) mod testing {
    use mariana_music::{Section, SongBeat, SongStructure, Stretch};

    /// Returns a song with 32 bars of two seconds from 0.5 s on. Its sections are A, B with a build at its end, B
    /// with a drop, and A.
    pub(crate) fn song() -> SongStructure {
        let beat = |index: usize| SongBeat {
            time: 0.5 + 0.5 * index as f64,
            of_bar: (index % 4) as u8 + 1,
            tempo: 120.0,
        };
        let section = |letter: &str, bars: [usize; 2], energy| Section {
            start: if bars[0] == 0 { 0.0 } else { 0.5 + 2.0 * bars[0] as f64 },
            end: 0.5 + 2.0 * bars[1] as f64,
            letter: letter.to_owned(),
            energy,
        };
        SongStructure {
            seconds: 64.5,
            tempo: Some(120.0),
            beats: (0..128).map(beat).collect(),
            sections: vec![
                section("A", [0, 8], 0.2),
                section("B", [8, 16], 0.5),
                section("B", [16, 24], 0.9),
                section("A", [24, 32], 0.25),
            ],
            builds: vec![Stretch { start: 24.5, end: 32.5 }],
            drops: vec![32.5],
            ..SongStructure::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::song;
    use super::*;
    use crate::parse;

    fn resolved(text: &str) -> (Timeline, Vec<String>) {
        let parsed = parse("test.show", text);
        let cue_list = parsed.cue_list.clone().unwrap_or_else(|| panic!("{}", parsed.render(false)));
        let (timeline, left_out) = resolve(&cue_list, &song(), &[3.0, 40.0], |_, to| {
            (to == "liked").then_some(TransitionStyle::Melt)
        });
        (timeline.unwrap(), left_out.into_iter().map(|one| one.message).collect())
    }

    #[test]
    fn moments_of_a_song_are_found() {
        let (timeline, left_out) = resolved(
            "at start  one\nat 0:07.25 two cut\nat bar 5 + 2 beats  three  melt over 2 bars\n\
             at section B four\nat build 1 liked\nat drop 1 - 1 bar five portal over 1 bar\n\
             at section B 2 six\nat end - 4 s seven fade over 0.5 s",
        );
        assert_eq!(left_out, [""; 0]);
        let starts: Vec<f64> = timeline.clips().iter().map(|clip| clip.start).collect();
        assert_eq!(starts, [0.0, 7.25, 9.5, 16.5, 24.5, 30.5, 32.5, 60.5]);
        let transitions: Vec<(TransitionStyle, f64)> = timeline
            .clips()
            .iter()
            .map(|clip| (clip.transition.kind.style(), clip.transition.seconds))
            .collect();
        use TransitionStyle::{Cut, Fade, Melt, Portal};
        let wanted = [
            (Fade, 0.0),
            (Cut, 0.0),
            (Melt, 4.0),
            (Fade, 1.0),
            (Melt, 2.0),
            (Portal, 2.0),
            (Fade, 1.0),
            (Fade, 0.5),
        ];
        assert_eq!(transitions, wanted);
    }

    #[test]
    fn entries_that_do_not_fit_the_song_are_left_out_and_reported() {
        let (timeline, left_out) = resolved(
            "at start one\nat section C two\nat section A 3 three\nat drop 2 four\nat 30 s five\nat bar 2 six",
        );
        assert_eq!(timeline.clips().len(), 2);
        let wanted = [
            "the song has no section C",
            "the song has no section A 3",
            "the song has no drop 2",
            "this entry is at 0:02.5, before the previous entry at 0:30",
        ];
        assert_eq!(left_out, wanted);
    }

    #[test]
    fn entries_after_the_end_of_the_song_were_accepted_without_a_warning() {
        let (timeline, left_out) =
            resolved("at end one\nat 20:00 two\nat bar 999 three\nat end + 1 bar four");
        assert_eq!(timeline.clips().len(), 1);
        let late = ["20:00", "33:16.5", "1:06.5"];
        assert_eq!(left_out, late.map(|at| format!("the song ends at 1:04.5, before this entry at {at}")));
    }

    #[test]
    fn cues_start_when_the_key_was_pressed() {
        let (timeline, left_out) = resolved(
            "at start one\nat cue two cut\nat 10 s three\nat cue + 1 bar four\nat 30 s five\nat cue six",
        );
        assert_eq!(left_out, [""; 0]);
        let clips: Vec<(f64, &str)> =
            timeline.clips().iter().map(|clip| (clip.start, clip.scene.as_str())).collect();
        assert_eq!(clips, [(0.0, "one"), (3.0, "two"), (10.0, "three"), (30.0, "five"), (42.0, "four")]);
    }

    #[test]
    fn an_entry_follows_the_entry_above() {
        let (timeline, left_out) = resolved(
            "at start one\nat previous + 4 s two\nat cue three\nat previous + 1 bar four\n\
             at previous + 1 bar five\nat 30 s six\nat cue seven\nat cue eight\nat previous + 1 s nine",
        );
        assert_eq!(left_out, [""; 0]);
        let clips: Vec<(f64, &str)> =
            timeline.clips().iter().map(|clip| (clip.start, clip.scene.as_str())).collect();
        assert_eq!(
            clips,
            [
                (0.0, "one"),
                (3.0, "three"),
                (4.0, "two"),
                (5.0, "four"),
                (7.0, "five"),
                (30.0, "six"),
                (40.0, "seven")
            ]
        );
        let cue_list =
            parse("test.show", "at start one\nat cue two\nat previous + 2 s three").cue_list.unwrap();
        assert_eq!(entry_starts(&cue_list, &song(), &[]), [Some(0.0), None, None]);
        assert_eq!(entry_starts(&cue_list, &song(), &[5.0]), [Some(0.0), Some(5.0), Some(7.0)]);
    }

    #[test]
    fn parameters_move_by_bars() {
        let (timeline, _) =
            resolved("at bar 3 one\n  set a = 0.25 -> 0.5 over 2 bars\n  set b = 3 after 1 beat");
        let clip = &timeline.clips()[0];
        let times: Vec<(f64, f64)> = clip.moves.iter().map(|one| (one.start, one.seconds)).collect();
        assert_eq!(times, [(4.5, 4.0), (5.0, 0.0)]);
        assert_eq!(["a", "b"].map(|name| clip.moved(name, 6.5).unwrap().value), [0.375, 3.0]);
    }
}
