//! Inputs as numbers from 0 to 1, to which a parameter of a scene can be bound: the numbers of the sound, and sines
//! that follow the beat.

use super::sound_input::{SoundInput, SoundInputs};

/// An input from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitInput {
    /// A number of the sound, as a fraction of its range.
    Sound(SoundInput),
    /// A sine over this many beats: 0 at the first beat, 1 in the middle.
    Sine(u8),
}

use SoundInput as S;
use UnitInput::{Sine, Sound};

/// The inputs that suit a parameter best.
const FIRST: [UnitInput; 16] = [
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
    Sine(1),
    Sine(4),
    Sine(16),
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

    /// Returns the name in files and commands.
    pub fn name(self) -> String {
        match self {
            Sound(input) => input.name().to_owned(),
            Sine(beats) => format!("sine_{beats}"),
        }
    }

    /// Returns the name for users.
    pub fn label(self) -> String {
        match self {
            Sound(S::VolumeMid) => "volume".to_owned(),
            Sound(input) => input.name().to_owned(),
            Sine(1) => "sine 1 beat".to_owned(),
            Sine(beats) => format!("sine {beats} beats"),
        }
    }

    /// Returns the input with this name; `None` if there is no such input.
    pub fn named(name: &str) -> Option<Self> {
        Self::first().chain(Self::others()).find(|input| input.name() == name)
    }

    /// Returns the value, 0..1. `beats` counts beats, with fractions, from the first beat of a bar.
    pub fn value(self, sound: &SoundInputs, beats: f64) -> f32 {
        match self {
            Sound(input) => {
                let (least, most) = input.range();
                ((input.clamp(sound[input]) - least) / (most - least)).clamp(0.0, 1.0)
            }
            Sine(length) => {
                let turns = (beats / f64::from(length)).rem_euclid(1.0);
                (0.5 - 0.5 * (turns * std::f64::consts::TAU).cos()) as f32
            }
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
            Sine(1) => Some("0.5 - 0.5 * cos(tau * phase)".to_owned()),
            Sine(4) => Some("0.5 - 0.5 * cos(tau * bar)".to_owned()),
            Sine(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_values_are_fractions() {
        let all: Vec<UnitInput> = UnitInput::first().chain(UnitInput::others()).collect();
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
    fn sines_take_their_beats() {
        let at = |length, beats| Sine(length).value(&SoundInputs::SILENCE, beats);
        assert_eq!(
            [at(1, 0.0), at(1, 0.5), at(4, 2.0), at(16, 8.0), at(16, -8.0)],
            [0.0, 1.0, 1.0, 1.0, 1.0]
        );
        assert!((at(4, 1.0) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn scenes_can_read_all_expressions() {
        for input in UnitInput::first().chain(UnitInput::others()) {
            let Some(expression) = input.expression() else { continue };
            let text = format!("let size = {expression}\nobject ball {{ shape = sphere(p, 1 + size) }}");
            let compiled = crate::lang::compile("test", &text, &mut |_: &str| Err(String::new()));
            assert!(compiled.scene.is_some(), "{expression}: {:?}", compiled.diagnostics);
        }
    }
}
