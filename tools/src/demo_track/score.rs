//! The score: tempo, form, harmony and every note of the demo track.
//!
//! Times are in steps (sixteenth notes) within bars. A step is a whole number of samples, so every onset is exact.
//! Pitches are MIDI note numbers (69 = 440 Hz). E minor / G major, 112.5 beats per minute.
//!
//! | bars    | part      | content |
//! |---------|-----------|--------------|
//! | 0..8    | intro     | pads; bells far left and far right; from bar 4 the theme's first phrase on bells |
//! | 8..12   | build     | kick, hats, rising melody, opening filter, snare roll |
//! | 12..20  | full one  | all instruments, the whole theme |
//! | 20..24  | breakdown | one bar left only, one right only, one alternating by the beat, then near silence |
//! | 24..36  | full two  | the theme in thirds, a second theme with left and right stabs, the theme's answer |
//! | 36..40  | outro     | drums thin out; pads and bells lead back to bar 0 |

pub const SAMPLE_RATE: u32 = 48_000;
/// Samples per sixteenth note, which makes exactly 112.5 beats per minute.
pub const STEP: usize = 6_400;
/// Sixteenth notes per bar (4/4).
pub const STEPS: usize = 16;
pub const BAR: usize = STEP * STEPS;
pub const BARS: usize = 40;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Note {
    /// Onset in samples from the start of the piece.
    pub start: usize,
    /// Samples until the release.
    pub length: usize,
    /// MIDI note number.
    pub pitch: u8,
    /// Loudness, 0..=1.
    pub velocity: f32,
    /// Pan, -1 (left) ..= 1 (right).
    pub pan: f32,
}

impl Note {
    /// Creates a note of `steps` sixteenths at `step` of `bar`.
    fn new(bar: usize, step: usize, steps: usize, pitch: u8, velocity: f32, pan: f32) -> Self {
        Self { start: bar * BAR + step * STEP, length: steps * STEP, pitch, velocity, pan }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drum {
    Kick,
    Clap,
    Snare,
    ClosedHat,
    OpenHat,
    Shaker,
    Crash,
    /// Low tom; the pitch glides down.
    LowTom,
    HighTom,
    /// Noise that rises for two bars.
    Riser,
    /// Noise that swells and fades like a wave, for three bars.
    Surf,
    /// A low boom on the first beat of a loud part.
    Impact,
}

#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub drum: Drum,
    /// Onset in samples.
    pub start: usize,
    /// Loudness, 0..=1.
    pub velocity: f32,
    /// Pan, -1 (left) ..= 1 (right).
    pub pan: f32,
}

/// A bass note and five upper voices.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    pub bass: u8,
    pub voices: [u8; 5],
}

const E_MINOR_9: Chord = Chord { bass: 28, voices: [55, 59, 62, 66, 71] };
const C_MAJOR_9: Chord = Chord { bass: 36, voices: [55, 59, 62, 64, 71] };
const G_ADD_9: Chord = Chord { bass: 31, voices: [55, 57, 62, 67, 71] };
const D_ADD_9: Chord = Chord { bass: 38, voices: [54, 57, 62, 64, 69] };
const A_MINOR_9: Chord = Chord { bass: 33, voices: [55, 60, 64, 67, 71] };
const B_MINOR_7: Chord = Chord { bass: 35, voices: [54, 57, 62, 66, 69] };
const D_SUS_4: Chord = Chord { bass: 38, voices: [55, 57, 62, 67, 69] };

const VERSE: [Chord; 4] = [E_MINOR_9, C_MAJOR_9, G_ADD_9, D_ADD_9];
const RISE: [Chord; 4] = [A_MINOR_9, B_MINOR_7, C_MAJOR_9, D_SUS_4];
const BREAK: [Chord; 4] = [C_MAJOR_9, A_MINOR_9, E_MINOR_9, D_SUS_4];
const BRIDGE: [Chord; 4] = [C_MAJOR_9, D_ADD_9, E_MINOR_9, B_MINOR_7];
const HOME: [Chord; 4] = [C_MAJOR_9, D_ADD_9, G_ADD_9, D_SUS_4];

const FORM: [[Chord; 4]; BARS / 4] = [VERSE, VERSE, RISE, VERSE, VERSE, BREAK, VERSE, BRIDGE, VERSE, HOME];

pub fn chord_at(bar: usize, step: usize) -> Chord {
    match (bar, step >= STEPS / 2) {
        // The suspension before the first loud part resolves in the middle of its bar.
        (11, true) => D_ADD_9,
        _ => FORM[bar / 4 % FORM.len()][bar % 4],
    }
}

/// A note of a melody: bar within the phrase, step, length in steps, pitch.
type Melodic = (usize, usize, usize, u8);

const THEME: [Melodic; 12] = [
    (0, 0, 6, 71),
    (0, 6, 2, 74),
    (0, 8, 8, 76),
    (1, 0, 6, 76),
    (1, 6, 2, 74),
    (1, 8, 8, 71),
    (2, 0, 6, 74),
    (2, 6, 2, 71),
    (2, 8, 4, 69),
    (2, 12, 4, 71),
    (3, 0, 12, 69),
    (3, 12, 4, 66),
];
const ANSWER: [Melodic; 14] = [
    (0, 0, 6, 71),
    (0, 6, 2, 74),
    (0, 8, 8, 79),
    (1, 0, 4, 79),
    (1, 4, 2, 78),
    (1, 6, 2, 76),
    (1, 8, 4, 74),
    (1, 12, 4, 76),
    (2, 0, 6, 74),
    (2, 6, 2, 76),
    (2, 8, 8, 71),
    (3, 0, 4, 69),
    (3, 4, 4, 71),
    (3, 8, 8, 74),
];
/// The rising melody of the build, over the chords of [`RISE`].
const CLIMB: [Melodic; 11] = [
    (0, 0, 4, 69),
    (0, 4, 4, 71),
    (0, 8, 4, 72),
    (0, 12, 4, 76),
    (1, 0, 4, 71),
    (1, 4, 4, 74),
    (1, 8, 8, 78),
    (2, 0, 8, 79),
    (2, 8, 8, 76),
    (3, 0, 8, 79),
    (3, 8, 5, 78),
];
/// The second theme, syncopated, over the chords of [`BRIDGE`]. It has the highest note of the piece.
const SECOND_THEME: [Melodic; 17] = [
    (0, 0, 3, 79),
    (0, 3, 3, 78),
    (0, 6, 2, 76),
    (0, 8, 4, 74),
    (0, 12, 4, 76),
    (1, 0, 3, 78),
    (1, 3, 3, 76),
    (1, 6, 2, 74),
    (1, 8, 8, 69),
    (2, 0, 3, 79),
    (2, 3, 3, 78),
    (2, 6, 2, 76),
    (2, 8, 8, 83),
    (3, 0, 4, 81),
    (3, 4, 4, 78),
    (3, 8, 4, 74),
    (3, 12, 4, 78),
];
/// The closing phrase, over the chords of [`HOME`].
const FAREWELL: [Melodic; 7] = [
    (0, 0, 6, 71),
    (0, 6, 2, 74),
    (0, 8, 8, 76),
    (1, 0, 6, 74),
    (1, 6, 2, 71),
    (1, 8, 8, 69),
    (2, 0, 12, 71),
];

fn phrase(out: &mut Vec<Note>, bar: usize, melody: &[Melodic], velocity: f32, pan: f32) {
    out.extend(
        melody.iter().map(|&(b, step, steps, pitch)| Note::new(bar + b, step, steps, pitch, velocity, pan)),
    );
}

/// Returns the note of the E minor scale a third below `pitch`.
fn third_below(pitch: u8) -> u8 {
    const SCALE: [u8; 7] = [0, 2, 4, 6, 7, 9, 11]; // pitch classes C D E F# G A B
    let third = pitch - 3;
    if SCALE.contains(&(third % 12)) { third } else { pitch - 4 }
}

/// Pads: every chord, held until the next one.
pub fn pads() -> Vec<Note> {
    let mut notes = Vec::new();
    for bar in 0..BARS {
        let halves: &[usize] = if bar == 11 { &[0, 8] } else { &[0] };
        // The one-sided bars and the silence of the breakdown have no pads. In the last bar, the pads end early, to
        // leave time for the reverb.
        let steps = match bar {
            20 | 21 => continue,
            11 => 8,
            23 => 4,
            39 => 10,
            _ => 16,
        };
        for &half in halves {
            for (voice, &pitch) in chord_at(bar, half).voices.iter().enumerate() {
                let pan = [0.0, -0.7, 0.7, -0.4, 0.4][voice];
                notes.push(Note::new(bar, half, steps, pitch, 0.8, pan));
            }
        }
    }
    notes
}

/// Bells: in the intro, single notes on alternating sides and then the theme; in the outro, the closing phrase.
pub fn bells() -> Vec<Note> {
    let mut notes = Vec::new();
    let sparks: [(usize, usize, u8, f32); 12] = [
        (0, 8, 83, -1.0),
        (0, 11, 78, -1.0),
        (1, 4, 79, 1.0),
        (1, 7, 76, 1.0),
        (1, 12, 71, 1.0),
        (2, 4, 86, -1.0),
        (2, 7, 83, -1.0),
        (2, 10, 79, -1.0),
        (3, 4, 81, 1.0),
        (3, 7, 78, 1.0),
        (3, 10, 74, 1.0),
        (3, 13, 69, 1.0),
    ];
    notes.extend(sparks.map(|(bar, step, pitch, pan)| Note::new(bar, step, 2, pitch, 0.85, pan)));
    phrase(&mut notes, 4, &THEME, 0.9, 0.0);
    phrase(&mut notes, 36, &FAREWELL, 0.75, 0.0);
    // When the theme is heard for the last time, the bells play it an octave above the lead.
    notes.extend(
        ANSWER.map(|(b, s, n, pitch)| Note::new(32 + b, s, n, pitch + 12, 0.35, [-0.6, 0.6][s / 2 % 2])),
    );
    notes
}

/// The lead: the rising melody of the build, and the themes of both loud parts.
pub fn lead() -> Vec<Note> {
    let mut notes = Vec::new();
    phrase(&mut notes, 8, &CLIMB, 0.55, 0.0);
    phrase(&mut notes, 12, &THEME, 0.8, 0.0);
    phrase(&mut notes, 16, &ANSWER, 0.85, 0.0);
    phrase(&mut notes, 24, &THEME, 0.8, -0.2);
    notes.extend(THEME.map(|(b, s, n, pitch)| Note::new(24 + b, s, n, third_below(pitch), 0.45, 0.5)));
    phrase(&mut notes, 28, &SECOND_THEME, 0.85, 0.0);
    phrase(&mut notes, 32, &ANSWER, 0.85, 0.2);
    notes.extend(ANSWER.map(|(b, s, n, pitch)| Note::new(32 + b, s, n, third_below(pitch), 0.45, -0.5)));
    notes
}

/// The arpeggio: sixteenths through the chord, changing sides.
pub fn arpeggio() -> Vec<Note> {
    const CLIMBING: [usize; 16] = [0, 2, 4, 3, 1, 3, 5, 4, 2, 4, 6, 5, 3, 5, 4, 2];
    const FALLING: [usize; 16] = [6, 4, 5, 3, 4, 2, 3, 1, 5, 3, 4, 2, 3, 1, 2, 0];
    let mut notes = Vec::new();
    for bar in 4..39 {
        for step in 0..STEPS {
            let beat = step / 4;
            let swing = if beat % 2 == 0 { -1.0 } else { 1.0 };
            // Find out if the arpeggio plays at this step, how loud, and on which side.
            let (plays, loudness, pan) = match bar {
                4..8 => (step % 4 == 2, 0.35, swing * 0.8),
                8..12 => (step % 2 == 0 || bar >= 10, 0.6, swing * 0.6),
                20 => (true, 0.8, -1.0),
                21 => (true, 0.8, 1.0),
                22 => (true, 0.8, swing),
                23 => (false, 0.0, 0.0),
                36..38 => (step % 2 == 0, 0.6, swing * 0.8),
                38 => (step % 4 == 0, 0.5, swing * 0.8),
                _ => (true, 0.85, swing * 0.75),
            };
            if !plays {
                continue;
            }
            let pattern = if bar / 2 % 2 == 0 { CLIMBING } else { FALLING };
            let voices = chord_at(bar, step).voices;
            let index = pattern[step];
            let pitch = voices[index % 5] + 12 * (index / 5) as u8 + 12;
            let accent = [1.0, 0.6, 0.8, 0.65][step % 4];
            notes.push(Note::new(bar, step, 1, pitch, loudness * accent, pan));
        }
    }
    notes
}

/// The bass: drones in the intro, pulses in the build, a syncopated line in the loud parts, and low plucks that
/// change sides in the breakdown.
pub fn bass() -> Vec<Note> {
    // The columns are step, length, and interval above the root.
    const LINE: [(usize, usize, u8); 7] =
        [(0, 2, 0), (3, 2, 0), (6, 2, 12), (8, 2, 0), (10, 1, 0), (11, 2, 7), (14, 2, 12)];
    let mut notes = Vec::new();
    for bar in 4..39 {
        let root = chord_at(bar, 0).bass;
        let mut add = |step, steps, interval, velocity, pan| {
            notes.push(Note::new(bar, step, steps, root + interval, velocity, pan));
        };
        match bar {
            4..8 => add(0, 15, 0, 0.35, 0.0),
            8..10 => add(0, 15, 0, 0.5, 0.0),
            10 => (0..8).for_each(|i| add(i * 2, 1, 0, 0.5 + 0.03 * i as f32, 0.0)),
            11 => (0..6).for_each(|i| add(i * 2, 1, 0, 0.7, 0.0)),
            12..20 | 24..36 => {
                LINE.iter().for_each(|&(s, n, up)| add(s, n, up, if up == 0 { 0.9 } else { 0.7 }, 0.0))
            }
            20 | 21 => {
                let side = if bar == 20 { -1.0 } else { 1.0 };
                [(0, 3), (4, 3), (8, 3), (11, 2), (14, 2)].iter().for_each(|&(s, n)| add(s, n, 0, 0.5, side));
            }
            22 => (0..4).for_each(|beat| add(beat * 4, 3, 0, 0.6, if beat % 2 == 0 { -1.0 } else { 1.0 })),
            36 | 37 => add(0, 12, 0, 0.55, 0.0),
            38 => add(0, 14, 0, 0.4, 0.0),
            _ => {}
        }
    }
    notes
}

/// Short chords on alternating sides: on the left from the second beat, on the right from the fourth beat.
pub fn stabs() -> Vec<Note> {
    let mut notes = Vec::new();
    for bar in (28..32).chain([14, 18, 34]) {
        for (step, pan) in [(4, -1.0), (7, -1.0), (12, 1.0), (15, 1.0)] {
            for pitch in chord_at(bar, step).voices {
                notes.push(Note::new(bar, step, 2, pitch, 0.8, pan));
            }
        }
    }
    notes
}

pub fn drums() -> Vec<Hit> {
    let mut hits = Vec::new();
    let mut hit = |drum, bar: usize, step: usize, velocity: f32, pan: f32| {
        hits.push(Hit { drum, start: bar * BAR + step * STEP, velocity, pan });
    };
    for bar in 0..BARS {
        let loud = matches!(bar, 12..20 | 24..36);
        let fill = matches!(bar, 19 | 27 | 31 | 35);
        // Shaker and hats are on opposite sides, which they swap every four bars.
        let side = if bar / 4 % 2 == 0 { 0.5 } else { -0.5 };
        for step in 0..STEPS {
            let on_beat = step % 4 == 0;
            match bar {
                8..11 if on_beat => hit(Drum::Kick, bar, step, 0.6 + 0.08 * (bar - 8) as f32, 0.0),
                11 if on_beat && step < 12 => hit(Drum::Kick, bar, step, 0.85, 0.0),
                36 | 37 if step == 0 || step == 8 => hit(Drum::Kick, bar, step, 0.55, 0.0),
                _ if loud && on_beat => hit(Drum::Kick, bar, step, 1.0, 0.0),
                _ => {}
            }
            if loud && (step == 4 || step == 12) {
                hit(Drum::Clap, bar, step, 0.9, 0.0);
            }
            if bar >= 24 && loud && step == 7 && bar % 2 == 1 {
                hit(Drum::Clap, bar, step, 0.4, 0.0);
            }
            if (loud || matches!(bar, 9..12 | 36)) && step % 4 == 2 {
                hit(if loud { Drum::OpenHat } else { Drum::ClosedHat }, bar, step, 0.7, -side * 0.5);
            }
            if loud || bar == 10 || bar == 11 {
                let accent = [0.6, 0.3, 0.0, 0.35][step % 4];
                if accent > 0.0 {
                    hit(Drum::ClosedHat, bar, step, accent, -side);
                }
            }
            if bar >= 14 && loud || bar == 36 || bar == 37 {
                hit(Drum::Shaker, bar, step, [0.5, 0.3, 0.7, 0.3][step % 4], side * 1.6);
            }
            if bar == 11 {
                // The snare roll has eighths, then sixteenths, and leaves out the last beat.
                if (step < 8 && step % 2 == 0) || (8..13).contains(&step) {
                    hit(Drum::Snare, bar, step, 0.25 + 0.045 * step as f32, 0.0);
                }
            }
        }
        if fill {
            for (step, drum, pan) in [
                (10, Drum::HighTom, -0.9),
                (11, Drum::HighTom, -0.9),
                (13, Drum::LowTom, 0.9),
                (14, Drum::LowTom, 0.9),
            ] {
                hit(drum, bar, step, 0.8, pan);
            }
        }
    }
    // The pick-up after the silence.
    hit(Drum::HighTom, 23, 14, 0.7, -1.0);
    hit(Drum::LowTom, 23, 15, 0.9, 1.0);
    hit(Drum::Riser, 10, 0, 1.0, 0.0);
    hit(Drum::Impact, 12, 0, 0.9, 0.0);
    hit(Drum::Impact, 24, 0, 0.9, 0.0);
    // The quiet parts have surf on alternating sides.
    for (bar, pan) in [(0, -0.8), (2, 0.8), (4, -0.8), (6, 0.8), (8, -0.5), (36, 0.5), (37, -0.8)] {
        hit(Drum::Surf, bar, 0, 0.5, pan);
    }
    for (bar, pan) in [(12, -0.3), (16, 0.3), (20, 0.0), (24, 0.3), (28, -0.6), (32, 0.6), (36, 0.0)] {
        hit(Drum::Crash, bar, 0, 0.8, pan);
    }
    hits
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strong beats are the first and the third of a bar.
    #[test]
    fn melodies_have_chord_tones_on_strong_beats() {
        for note in lead().iter().filter(|n| n.pan.abs() < 0.5).chain(&bells()) {
            let (bar, step) = (note.start / BAR, note.start % BAR / STEP);
            if step % 8 == 0 {
                let chord = chord_at(bar, step);
                let tones: Vec<u8> = chord.voices.iter().chain([&chord.bass]).map(|p| p % 12).collect();
                assert!(tones.contains(&(note.pitch % 12)), "bar {bar} step {step}: {}", note.pitch);
            }
        }
    }

    #[test]
    fn every_pitch_belongs_to_the_key() {
        let all = [pads(), bells(), lead(), arpeggio(), bass(), stabs()].concat();
        for note in all {
            assert!([0, 2, 4, 6, 7, 9, 11].contains(&(note.pitch % 12)), "{note:?}");
        }
    }

    #[test]
    fn the_lead_never_overlaps_itself() {
        let mut voice: Vec<Note> = lead().into_iter().filter(|n| n.pan.abs() < 0.5).collect();
        voice.sort_by_key(|n| n.start);
        for pair in voice.windows(2) {
            assert!(pair[0].start + pair[0].length <= pair[1].start, "{pair:?}");
        }
    }

    #[test]
    fn the_breakdown_has_a_left_bar_a_right_bar_and_a_silence() {
        let all = [pads(), bells(), lead(), arpeggio(), bass(), stabs()].concat();
        let in_bar = |bar: usize| all.iter().filter(move |n| n.start / BAR == bar);
        assert!(in_bar(20).count() > 0 && in_bar(20).all(|n| n.pan == -1.0));
        assert!(in_bar(21).count() > 0 && in_bar(21).all(|n| n.pan == 1.0));
        let silence = 23 * BAR + 6 * STEP..23 * BAR + 14 * STEP;
        assert!(
            !all.iter().any(|n| silence.contains(&n.start))
                && !drums().iter().any(|h| silence.contains(&h.start))
        );
    }
}
