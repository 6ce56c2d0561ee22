//! The times of beats, and the patterns of instruments in a bar.

use super::synth::Random;

/// The times of beats, and how a beat is divided.
pub(super) struct Time {
    pub(super) beats: Vec<f32>,
    /// The index of the first downbeat.
    pub(super) first: usize,
    pub(super) bar: usize,
    pub(super) tempo: f32,
    has_drums: bool,
    pub(super) ternary: bool,
    /// Where the second half of a beat and of a half beat begin.
    swing: [f32; 2],
}

/// Strokes of a bar: the position in beats and the loudness.
pub(super) type Pattern = Vec<(f32, f32)>;

impl Time {
    pub(super) fn new(seconds: f32, has_drums: bool, random: &mut Random) -> Self {
        let (bar, ternary) = match random.below(100) {
            0..=78 => (4, random.chance(0.04)),
            79..=89 => (3, false),
            90..=95 => (2, true),
            96 => (5, false),
            97 => (7, false),
            _ => (2, false),
        };
        let (middle, width) = match (bar, ternary, has_drums) {
            (3, ..) => (122.0, 0.4),
            (2, true, _) => (85.0, 0.35),
            (_, true, _) => (100.0, 0.3),
            (.., true) => (114.0, 0.34),
            (.., false) => (94.0, 0.36),
        };
        let mut tempo = 0.0;
        while !(52.0..205.0).contains(&tempo) {
            tempo = middle * (width * random.normal()).exp2();
        }
        let drift = if random.chance(0.35) { random.ratio(0.002, 0.012) } else { 0.0 };
        let ramp = if random.chance(0.1) { random.between(-0.01, 0.01) } else { 0.0 };
        let jump = if random.chance(0.05) { random.between(0.3, 0.7) * seconds } else { seconds };
        let rubato = if !has_drums && random.chance(0.3) { random.between(0.01, 0.05) } else { 0.0 };
        let mut beats = Vec::new();
        let mut time = -random.unit() * 60.0 / tempo * bar as f32 - 2.0;
        let (mut slow, mut jumped) = (0.0, false);
        while time < seconds + 4.0 {
            beats.push(time);
            slow = 0.9 * slow + drift * random.normal();
            if time > jump && !jumped {
                (tempo, jumped) = ((tempo * random.ratio(0.75, 1.33)).clamp(55.0, 200.0), true);
            }
            let curve = (ramp * (time - 0.5 * seconds)).exp2() * (1.0 + slow + rubato * random.normal());
            time += 60.0 / (tempo * curve);
        }
        let swing = match random.below(20) {
            0..=4 if tempo < 205.0 => [random.between(0.54, 0.68), 0.5],
            5..=7 if tempo < 125.0 => [0.5, random.between(0.53, 0.66)],
            _ => [0.5, 0.5],
        };
        Self { beats, first: random.below(bar), bar, tempo, has_drums, ternary, swing }
    }

    /// Returns the time of a position in beats, counted from the first beat.
    pub(super) fn at(&self, place: f32) -> f32 {
        let whole = (place.max(0.0) as usize).min(self.beats.len() - 2);
        let mut rest = place - whole as f32;
        let bent = |rest: f32, swing: f32| {
            if rest < 0.5 { 2.0 * rest * swing } else { swing + (2.0 * rest - 1.0) * (1.0 - swing) }
        };
        if !self.ternary {
            let half = if rest < 0.5 { 0.0 } else { 0.5 };
            rest = half + 0.5 * bent(2.0 * (rest - half), self.swing[1]);
            rest = bent(rest, self.swing[0]);
        }
        self.beats[whole] + rest * (self.beats[whole + 1] - self.beats[whole])
    }

    /// Returns the number of parts of a beat that a fast instrument plays.
    pub(super) fn parts(&self, random: &mut Random) -> usize {
        let middle = if self.has_drums { 104.0 } else { 88.0 };
        let fast = 1.0 / (1.0 + ((self.tempo - middle) / 16.0).exp());
        match self.ternary {
            true if random.chance(0.1) => 6,
            true => 3,
            false if self.tempo < 80.0 && random.chance(0.2) => 8,
            false if random.chance(fast) => 4,
            false if self.tempo > 160.0 && random.chance(0.35) => 1,
            false if self.swing == [0.5; 2] && random.chance(0.04) => 3,
            false => 2,
        }
    }
}

/// Returns strokes at each of `parts` parts of the beats, which are accented by how strong their places are.
pub(super) fn every(time: &Time, parts: usize, random: &mut Random) -> Pattern {
    let accents = [random.between(0.5, 1.0), random.between(0.3, 1.0), random.between(0.4, 1.0)];
    let count = time.bar * parts;
    let gaps = random.chance(0.3).then(|| 1 << random.below(count.min(16)));
    (0..count)
        .filter(|n| gaps.is_none_or(|gaps: usize| gaps & (1 << (n % 16)) == 0))
        .map(|n| {
            let accent = match n % parts {
                0 if n == 0 => 1.0,
                0 => accents[0].max(0.6),
                part if 2 * part == parts => accents[2],
                _ => accents[1],
            };
            (n as f32 / parts as f32, accent)
        })
        .collect()
}

/// Returns random strokes, which are likelier at strong places.
pub(super) fn likely(time: &Time, density: f32, syncopated: f32, random: &mut Random) -> Pattern {
    let parts = if time.ternary {
        3
    } else if time.tempo > 140.0 {
        2
    } else {
        4
    };
    let mut pattern = Pattern::new();
    for n in 0..time.bar * parts {
        let weight = match n % parts {
            0 if n == 0 => 1.0,
            0 => 0.7,
            part if 2 * part == parts => 0.5,
            _ => 0.3,
        };
        if random.chance(density * (weight + syncopated * (0.6 - weight)) * 1.6) {
            pattern.push((n as f32 / parts as f32, random.between(0.6, 1.0)));
        }
    }
    pattern
}

fn back(time: &Time, random: &mut Random) -> Pattern {
    let places: &[f32] = match time.bar {
        4 => &[1.0, 3.0],
        2 => &[1.0],
        3 if random.chance(0.6) => &[1.0, 2.0],
        3 => &[2.0],
        5 => &[3.0],
        _ => &[2.0, 4.0],
    };
    places.iter().map(|place| (*place, 1.0)).collect()
}

pub(super) fn off(time: &Time) -> Pattern {
    let half = if time.ternary { 2.0 / 3.0 } else { 0.5 };
    (0..time.bar).map(|beat| (beat as f32 + half, 1.0)).collect()
}

pub(super) fn beats(time: &Time) -> Pattern {
    (0..time.bar).map(|beat| (beat as f32, if beat == 0 { 1.0 } else { 0.85 })).collect()
}

pub(super) fn thirds(time: &Time) -> Pattern {
    let end = time.bar as f32;
    let places = [0.0, 0.75, 1.5, 2.0, 2.75, 3.5, 4.0, 4.75];
    places.iter().filter(|place| **place < end).map(|place| (*place, 1.0)).collect()
}

pub(super) fn strong(time: &Time) -> Pattern {
    let places: &[f32] = match time.bar {
        4 => &[0.0, 2.0],
        5 => &[0.0, 3.0],
        7 => &[0.0, 3.0, 5.0],
        _ => &[0.0],
    };
    places.iter().map(|place| (*place, 1.0)).collect()
}

pub(super) fn with(mut pattern: Pattern, more: Pattern, loud: f32) -> Pattern {
    for (place, strength) in more {
        if pattern.iter().all(|(other, _)| (other - place).abs() > 0.05) {
            pattern.push((place, loud * strength));
        }
    }
    pattern
}

pub(super) fn kick_pattern(time: &Time, random: &mut Random) -> Pattern {
    let sync = random.unit();
    match random.below(20) {
        0..=4 => beats(time),
        5..=7 => strong(time),
        8..=13 => with(strong(time), likely(time, 0.35, sync, random), 0.85),
        14..=15 => with(vec![(0.0, 1.0)], likely(time, 0.4, sync, random), 0.9),
        16..=17 => with(vec![(0.0, 1.0)], thirds(time), 0.9),
        18 => likely(time, 0.5, sync, random),
        _ => vec![(0.0, 1.0)],
    }
}

pub(super) fn snare_pattern(time: &Time, random: &mut Random) -> Pattern {
    let ghosts = if random.chance(0.2) { likely(time, 0.25, 1.0, random) } else { vec![] };
    let loud = random.between(0.15, 0.4);
    let main = match random.below(20) {
        0..=14 => back(time, random),
        15 if time.bar == 4 && time.tempo < 110.0 => vec![(2.0, 1.0)],
        16 if time.tempo < 140.0 => off(time),
        17 => likely(time, 0.3, 0.8, random),
        18 => with(back(time, random), likely(time, 0.2, 1.0, random), 0.9),
        _ => back(time, random),
    };
    with(main, ghosts, loud)
}

pub(super) fn hat_pattern(time: &Time, random: &mut Random) -> Pattern {
    match random.below(20) {
        0..=11 => {
            let parts = time.parts(random);
            every(time, parts, random)
        }
        12..=13 => off(time),
        14 => beats(time),
        15 => back(time, random),
        16..=17 => {
            let half = if time.ternary { 2.0 / 3.0 } else { 0.5 };
            with(
                beats(time),
                back(time, random).iter().map(|(place, loud)| (place + half, *loud)).collect(),
                0.7,
            )
        }
        _ => likely(time, 0.6, random.unit(), random),
    }
}

pub(super) fn any_pattern(time: &Time, random: &mut Random) -> Pattern {
    match random.below(9) {
        0 => beats(time),
        1 => off(time),
        2 => back(time, random),
        3 => thirds(time),
        4 => strong(time),
        5 | 6 => {
            let parts = time.parts(random);
            every(time, parts, random)
        }
        _ => likely(time, random.between(0.2, 0.6), random.unit(), random),
    }
}
