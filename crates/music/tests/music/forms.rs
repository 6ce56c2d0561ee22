//! Songs with known forms: sections that return varied, transposed or with other instruments, and songs in which
//! nothing returns.

use mariana_music::{Mode, Tonality};

use crate::songs::{Kind, Note, Part, Song, Style, Voice};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// A A B A, twice.
    Aaba,
    /// Verses and choruses. The last chorus is one or two semitones higher.
    VerseChorus,
    Rondo,
    /// Two held chords that alternate.
    Pedals,
    /// A song that is played twice.
    Twice,
    /// Nothing returns; the instruments change.
    Through,
    /// Nothing returns; the instruments stay the same.
    ThroughPlain,
}

impl Form {
    pub(crate) const ALL: [Self; 7] = [
        Self::Aaba,
        Self::VerseChorus,
        Self::Rondo,
        Self::Pedals,
        Self::Twice,
        Self::Through,
        Self::ThroughPlain,
    ];

    fn letters(self) -> &'static str {
        match self {
            Self::Aaba => "AABAAABA",
            Self::VerseChorus => "IVCVCBC",
            Self::Rondo => "ABACADA",
            Self::Pedals => "ABABABAB",
            Self::Twice => "ABCDABCD",
            Self::Through | Self::ThroughPlain => "ABCDEFGH",
        }
    }

    /// Composes a song. Equal arguments give equal songs.
    pub(crate) fn song(self, style: Style, seed: u32) -> Song {
        let mut random = Random(seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453));
        let mode = [Mode::Major, Mode::Minor][random.below(2)];
        let key = Tonality { root: random.below(12) as u8, mode };
        let tempo = 76.0 + random.below(70) as f64;
        let slow = matches!(style, Style::SixEight | Style::HalfTime);
        let tempo = if slow { tempo.min(115.0) } else { tempo };
        let mut form: Vec<Part> = Vec::new();
        let lead = random.voice();
        for (place, letter) in self.letters().chars().enumerate() {
            let before = form.iter().find(|part| part.letter == letter).cloned();
            let part = match before {
                Some(part) => self.varied(part, place, style, &mut random),
                None => self.composed(letter, mode, style, lead, &mut random),
            };
            form.push(part);
        }
        let sway = 0.1 * random.unit();
        Song { cents: 60.0 * random.unit() - 30.0, sway, seed, ..Song::new(style, tempo, key, form) }
    }

    fn composed(self, letter: char, mode: Mode, style: Style, lead: Voice, random: &mut Random) -> Part {
        let bars = if self == Self::Pedals { 8 } else { [8, 8, 16][random.below(3)] };
        let scale: [u8; 7] = match mode {
            Mode::Major => [0, 2, 4, 5, 7, 9, 11],
            Mode::Minor => [0, 2, 3, 5, 7, 8, 10],
        };
        let degrees = [4, 8][random.below(2)];
        let minor = mode == Mode::Minor;
        let mut chords: Vec<(u8, bool)> = Vec::new();
        if self == Self::Pedals {
            chords =
                vec![if letter == 'A' { (0, minor) } else { ([5, 7, 10][random.below(3)], false) }; degrees];
        }
        while chords.len() < degrees {
            // The triads of the scale without the diminished one.
            let degree = random.below(7);
            let (root, third) = (scale[degree], (12 + scale[(degree + 2) % 7] - scale[degree]) % 12);
            let fifth = (12 + scale[(degree + 4) % 7] - scale[degree]) % 12;
            if fifth == 7 && chords.last().is_none_or(|(last, _)| *last != root) {
                chords.push((root, third == 3));
            }
        }
        let beats = style.meter().beats();
        let mut melody = Vec::new();
        let same = matches!(self, Self::ThroughPlain | Self::Aaba | Self::Pedals);
        let voice = if same { lead } else { random.voice() };
        let (mut step, mut beat) = (random.below(8) as i32, 0.0);
        while self != Self::Pedals && beat < (bars * beats) as f64 {
            let length = [0.5, 0.5, 1.0, 1.0, 2.0][random.below(5)];
            let bar = beat as usize / beats;
            step = (step + random.below(5) as i32 - 2).clamp(0, 10);
            let pitch = scale[step as usize % 7] + 12 * (step as u8 / 7);
            melody.push(Note { bar, beat: beat - (bar * beats) as f64, length, pitch, voice });
            beat += length;
        }
        let thin = letter == 'I' || random.below(5) == 0;
        Part {
            letter,
            bars,
            chords,
            drums: same || !thin,
            bass: same || !thin,
            voice,
            arpeggio: !same && random.below(2) == 0,
            loud: if same { 0.8 } else { 0.5 + 0.5 * random.unit() },
            melody,
            ..Part::default()
        }
    }

    /// Returns a part as it returns: other notes in the melody, louder or softer, sometimes with other instruments.
    fn varied(self, mut part: Part, place: usize, style: Style, random: &mut Random) -> Part {
        let beats = style.meter().beats();
        for note in &mut part.melody {
            if random.below(8) == 0 {
                note.pitch = (note.pitch + 2) % 20;
                note.beat = note.beat.floor().min(beats as f64 - 1.0);
            }
        }
        part.loud *= 0.85 + 0.3 * random.unit();
        match random.below(5) {
            0 => part.arpeggio = !part.arpeggio,
            1 => {
                let voice = random.voice();
                part.melody.iter_mut().for_each(|note| note.voice = voice);
            }
            _ => {}
        }
        if self == Self::VerseChorus && place >= 6 {
            part.raised = 1 + (random.0 >> 8 & 1) as u8;
        }
        part
    }
}

/// Composes a song with two or three loud parts, each after a build, a break, or a break with a pause.
pub(crate) fn club_song(style: Style, seed: u32) -> Song {
    let mut random = Random(seed.wrapping_mul(747_796_405).wrapping_add(77));
    let mode = [Mode::Major, Mode::Minor][random.below(2)];
    let lead = random.voice();
    let part = |letter, random: &mut Random| Form::Through.composed(letter, mode, style, lead, random);
    let bare = Part { drums: false, bass: false, loud: 0.5, ..part('R', &mut random) };
    let intro = Part { arpeggio: false, drums: random.below(2) == 0, ..bare.clone() };
    let loud = |part: Part| Part {
        drums: true,
        bass: true,
        arpeggio: true,
        loud: 1.0,
        kind: Kind::Drop,
        voice: Voice::Bright,
        ..part
    };
    let (drop, verse) = (loud(part('D', &mut random)), part('V', &mut random));
    let verse = Part { drums: true, bass: true, loud: 0.6, ..verse };
    let mut form = vec![Part { letter: 'I', ..intro }];
    for _ in 0..2 + random.below(2) {
        if random.below(2) == 0 {
            form.push(verse.clone());
        }
        let lead_in = match random.below(3) {
            0 => Part { letter: 'U', kind: Kind::Build, arpeggio: true, ..bare.clone() },
            1 => Part { kind: Kind::Break, ..bare.clone() },
            _ => Part { kind: Kind::Pause, ..bare.clone() },
        };
        form.extend([lead_in, drop.clone()]);
    }
    let key = Tonality { root: random.below(12) as u8, mode };
    Song { seed, ..Song::new(style, 118.0 + random.below(50) as f64, key, form) }
}

struct Random(u32);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.0 >> 8) / f64::from(1 << 24)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    fn voice(&mut self) -> Voice {
        [Voice::Soft, Voice::Organ, Voice::Bright][self.below(3)]
    }
}
