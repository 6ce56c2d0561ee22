//! Inputs as numbers from 0 to 1, to which a parameter of a scene can be bound: the numbers of the sound, and waves
//! that follow the beat.

use super::sound_input::{SoundInput, SoundInputs};

/// An input from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitInput {
    /// A number of the sound, as a fraction of its range.
    Sound(SoundInput),
    /// A wave over this many beats.
    Wave(Wave, u8),
}

/// The shape of a wave that follows the beat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wave {
    /// 0 at the first beat, 1 in the middle.
    Sine,
    /// Rises in straight lines from 0 at the first beat to 1 in the middle, and falls again.
    Triangle,
    /// Rises from 0 to 1, then jumps back.
    Rise,
    /// Jumps to 1 at the first beat, then falls to 0.
    Fall,
    /// 1 in the first half, 0 in the second.
    Square,
    /// Another random number in each period.
    Random,
}

impl Wave {
    /// All shapes, in the order of lists.
    pub const ALL: [Self; 6] =
        [Self::Sine, Self::Triangle, Self::Rise, Self::Fall, Self::Square, Self::Random];
    /// The lengths to choose from, in beats.
    pub const BEATS: [u8; 6] = [1, 2, 4, 8, 16, 32];

    /// Returns the name in files and lists.
    pub fn name(self) -> &'static str {
        ["sine", "triangle", "rise", "fall", "square", "random"][self as usize]
    }

    /// Returns the value, 0..1, after this many periods.
    fn at(self, periods: f64) -> f32 {
        let part = periods.rem_euclid(1.0);
        (match self {
            Self::Sine => 0.5 - 0.5 * (part * std::f64::consts::TAU).cos(),
            Self::Triangle => 1.0 - (2.0 * part - 1.0).abs(),
            Self::Rise => part,
            Self::Fall => 1.0 - part,
            Self::Square => f64::from(u8::from(part < 0.5)),
            Self::Random => random(periods.floor()),
        }) as f32
    }

    /// Returns the wave as an expression of the scene language; `part` is the input that rises from 0 to 1 in a period.
    fn expression(self, part: &str) -> Option<String> {
        Some(match self {
            Self::Sine => format!("0.5 - 0.5 * cos(tau * {part})"),
            Self::Triangle => format!("1 - abs(2 * {part} - 1)"),
            Self::Rise => part.to_owned(),
            Self::Fall => format!("1 - {part}"),
            Self::Square => format!("1 - step(0.5, {part})"),
            Self::Random => return None,
        })
    }
}

/// A number from 0 to 1 for each whole number: the finalizer of SplitMix64 (Steele, Lea, Flood 2014).
fn random(number: f64) -> f64 {
    let mut bits = (number as i64 as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

use SoundInput as S;
use UnitInput::Sound;

/// The inputs that suit a parameter best.
const FIRST: [UnitInput; 13] = [
    Sound(S::Bass),
    Sound(S::Mid),
    Sound(S::Treble),
    Sound(S::VolumeMid),
    Sound(S::Beat),
    Sound(S::Kick),
    Sound(S::Snare),
    Sound(S::Hat),
    Sound(S::Energy),
    Sound(S::Build),
    Sound(S::Drop),
    Sound(S::Phase),
    Sound(S::Melody),
];

/// Numbers with a larger range, such as the tempo, would hardly move a parameter.
const RANGE_MAX: f32 = 100.0;

impl UnitInput {
    /// Returns the inputs that suit a parameter best.
    pub fn first() -> impl Iterator<Item = Self> {
        FIRST.into_iter()
    }

    /// Returns the inputs that are not among [`UnitInput::first`].
    pub fn others() -> impl Iterator<Item = Self> {
        let all = SoundInput::ALL.into_iter().filter(|input| input.range().1 <= RANGE_MAX).map(Sound);
        all.filter(|input| !FIRST.contains(input))
    }

    fn waves() -> impl Iterator<Item = Self> {
        Wave::ALL.into_iter().flat_map(|wave| Wave::BEATS.map(|beats| Self::Wave(wave, beats)))
    }

    /// Returns the name in files and commands.
    pub fn name(self) -> String {
        match self {
            Sound(input) => input.name().to_owned(),
            Self::Wave(wave, beats) => format!("{}_{beats}", wave.name()),
        }
    }

    /// Returns the name for users.
    pub fn label(self) -> String {
        match self {
            Sound(S::VolumeMid) => "volume".to_owned(),
            Sound(input) => input.name().to_owned(),
            Self::Wave(wave, 1) => format!("{} 1 beat", wave.name()),
            Self::Wave(wave, beats) => format!("{} {beats} beats", wave.name()),
        }
    }

    /// Returns the input with this name; `None` if there is no such input.
    pub fn named(name: &str) -> Option<Self> {
        Self::first().chain(Self::others()).chain(Self::waves()).find(|input| input.name() == name)
    }

    /// Returns the value, 0..1. `beats` counts beats, with fractions, from the first beat of a bar.
    pub fn value(self, sound: &SoundInputs, beats: f64) -> f32 {
        match self {
            Sound(input) => {
                let (least, most) = input.range();
                ((input.clamp(sound[input]) - least) / (most - least)).clamp(0.0, 1.0)
            }
            Self::Wave(wave, length) => wave.at(beats / f64::from(length)),
        }
    }

    /// Returns the value as an expression of the scene language, or `None` if a scene cannot express it.
    pub fn expression(self) -> Option<String> {
        match self {
            Sound(input) => Some(match input.range() {
                (0.0, 1.0) => input.name().to_owned(),
                (0.0, most) => format!("{} / {most}", input.name()),
                (least, most) => format!("({} - {least}) / {}", input.name(), most - least),
            }),
            Self::Wave(wave, 1) => wave.expression("phase"),
            Self::Wave(wave, 4) => wave.expression("bar"),
            Self::Wave(..) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_values_are_fractions() {
        let all: Vec<UnitInput> =
            UnitInput::first().chain(UnitInput::others()).chain(UnitInput::waves()).collect();
        let loud = SoundInputs::each(|input| input.range().1);
        for (place, input) in all.iter().enumerate() {
            assert!(!all[..place].contains(input), "{input:?} is listed twice");
            assert_eq!(UnitInput::named(&input.name()), Some(*input));
            if let Sound(_) = input {
                assert_eq!(input.value(&loud, 0.0), 1.0, "{input:?}");
                assert!((0.0..=1.0).contains(&input.value(&SoundInputs::SILENCE, 0.0)), "{input:?}");
            }
        }
        assert_eq!(UnitInput::named("tempo"), None);
    }

    #[test]
    fn waves_take_their_beats() {
        let at = |wave, length, beats| UnitInput::Wave(wave, length).value(&SoundInputs::SILENCE, beats);
        let sine = |length, beats| at(Wave::Sine, length, beats);
        assert_eq!(
            [sine(1, 0.0), sine(1, 0.5), sine(4, 2.0), sine(16, 8.0), sine(16, -8.0)],
            [0.0, 1.0, 1.0, 1.0, 1.0]
        );
        assert!((sine(4, 1.0) - 0.5).abs() < 1e-6);
        let quarters = |wave| [0.0, 1.0, 2.0, 3.0].map(|beats| at(wave, 4, beats));
        assert_eq!(quarters(Wave::Triangle), [0.0, 0.5, 1.0, 0.5]);
        assert_eq!(quarters(Wave::Rise), [0.0, 0.25, 0.5, 0.75]);
        assert_eq!(quarters(Wave::Fall), [1.0, 0.75, 0.5, 0.25]);
        assert_eq!(quarters(Wave::Square), [1.0, 1.0, 0.0, 0.0]);
        let random: Vec<f32> = (-50..50).map(|beat| at(Wave::Random, 1, f64::from(beat) + 0.5)).collect();
        assert_eq!(at(Wave::Random, 1, 3.0), at(Wave::Random, 1, 3.9));
        assert!(random.iter().all(|value| (0.0..=1.0).contains(value)));
        let mean = random.iter().sum::<f32>() / random.len() as f32;
        assert!((0.4..0.6).contains(&mean) && random.windows(2).all(|pair| pair[0] != pair[1]), "{mean}");
    }

    #[test]
    fn scenes_can_read_all_expressions() {
        for input in UnitInput::first().chain(UnitInput::others()).chain(UnitInput::waves()) {
            let Some(expression) = input.expression() else { continue };
            let text = format!("let size = {expression}\nobject ball {{ shape = sphere(p, 1 + size) }}");
            let compiled = crate::lang::compile("test", &text, &mut |_: &str| Err(String::new()));
            assert!(compiled.scene.is_some(), "{expression}: {:?}", compiled.diagnostics);
        }
    }
}
