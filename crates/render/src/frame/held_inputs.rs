//! Scene inputs that `--set` holds at a fixed value, whatever the music does.

use std::str::FromStr;

use mariana_field::graph::{FrameInputs, Level, LevelList, PartInput, SongPart, SoundInput};
use mariana_field::lang::Scene;

/// The name of an input, and the finite value at which the input is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The name in the scene language: `t`, `volume.x`, `band(3)`, `drums.beat`, or a parameter of the scene.
    pub name: String,
    /// The value.
    pub value: f32,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("write it as NAME=VALUE, for example volume.x=0.3")?;
        let number = value.trim().parse().ok().filter(|number: &f32| number.is_finite());
        let value = number.ok_or_else(|| format!("'{}' is not a number", value.trim()))?;
        Ok(Self { name: name.trim().to_owned(), value })
    }
}

/// The held inputs of one scene, each with a value within its range.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HeldInputs(Vec<(Place, f32)>);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Time,
    Sound(SoundInput),
    Level(Level),
    Part(PartInput),
    Param(usize),
}

impl HeldInputs {
    /// Holds an input of `scene` from now on. Returns `false` if the scene has no input of that name.
    ///
    /// # Errors
    /// A message if the value is outside the input's range, because a scene's bounds are wrong there.
    pub fn hold(&mut self, scene: &Scene, setting: &Setting) -> Result<bool, String> {
        let Some(place) = place_of(scene, &setting.name) else { return Ok(false) };
        let (least, most) = match place {
            Place::Time => (f32::MIN, f32::MAX),
            Place::Sound(input) => input.range(),
            Place::Level(level) => level.range(),
            Place::Part(input) => input.range(),
            Place::Param(number) => {
                scene.params.get(number).map_or((f32::MIN, f32::MAX), |param| (param.min, param.max))
            }
        };
        let Setting { name, value } = setting;
        if !(least..=most).contains(value) {
            return Err(format!(
                "--set {name}={value}: {name} ranges from {least} to {most}; choose a value in this range"
            ));
        }
        self.0.push((place, *value));
        Ok(true)
    }

    /// Joins the held inputs of two scenes. The second scene's parameters follow the first scene's `params` parameters.
    pub fn followed_by(&self, second: &Self, params: usize) -> Self {
        let moved = second.0.iter().map(|&(place, value)| match place {
            Place::Param(number) => (Place::Param(params + number), value),
            other => (other, value),
        });
        Self(self.0.iter().copied().chain(moved).collect())
    }

    /// Writes the held values into a frame of the scene.
    pub fn apply(&self, inputs: &mut FrameInputs) {
        for &(place, value) in &self.0 {
            let to = match place {
                Place::Time => Some(&mut inputs.time),
                Place::Sound(input) => Some(&mut inputs.sound[input]),
                Place::Level(level) => Some(&mut inputs.levels[level]),
                Place::Part(input) => {
                    // Without stems, the numbers of the parts are missing.
                    inputs.parts.resize(PartInput::COUNT, 0.0);
                    inputs.parts.get_mut(input.index())
                }
                Place::Param(number) => inputs.params.get_mut(number),
            };
            if let Some(to) = to {
                *to = value;
            }
        }
    }
}

/// Finds an input by name. A parameter of the scene takes precedence over a sound input of the same name.
fn place_of(scene: &Scene, name: &str) -> Option<Place> {
    if name == "t" {
        return Some(Place::Time);
    }
    let param = scene.params.iter().position(|param| !param.is_number && param.name == name);
    if param.is_some() {
        return param.map(Place::Param);
    }
    if let Some(input) = SoundInput::named(name) {
        return Some(Place::Sound(input));
    }
    if let Some(input) = PartInput::named(name) {
        return Some(Place::Part(input));
    }
    let (list, number) = name.strip_suffix(')')?.split_once('(')?;
    LevelList::named(list)?.level(number.trim().parse().ok()?).map(Place::Level)
}

/// Returns a list of the input names of scenes as text.
pub fn input_names(scenes: &[&Scene]) -> String {
    let mut names: Vec<String> = Vec::new();
    for param in scenes.iter().flat_map(|scene| &scene.params).filter(|param| !param.is_number) {
        if !names.contains(&param.name) {
            names.push(param.name.clone());
        }
    }
    names.push("t".into());
    names.extend(SoundInput::ALL.map(|input| input.name().to_owned()));
    names.extend(LevelList::ALL.map(|list| format!("{0}(0) to {0}({1})", list.name(), list.count() - 1)));
    let parts = SongPart::ALL.map(SongPart::name).join(", ");
    names.push(format!(
        "or a number of a part of the song ({parts}), such as {}.beat",
        SongPart::Drums.name()
    ));
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_have_a_name_and_a_finite_number() {
        assert_eq!(" size = 0.5".parse(), Ok(Setting { name: "size".into(), value: 0.5 }));
        for (text, part) in [("size", "NAME=VALUE"), ("size=", "not a number"), ("t=nan", "not a number")] {
            let message = text.parse::<Setting>().unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn unknown_inputs_are_not_held_and_values_out_of_range_are_refused() {
        let text = "param size = 2 in 0.5 .. 3\nparam key = 20 in 0 .. 30\nobject ball { shape = length(p) - size }\n";
        let scene =
            mariana_field::lang::compile("own", text, &mut mariana_field::lang::no_includes).scene.unwrap();
        let mut held = HeldInputs::default();
        let mut hold = |text: &str| held.hold(&scene, &text.parse().unwrap());
        for text in [
            "size=3",
            "key=25",
            "t=-4",
            "volume.y=0.25",
            "drop=0.5",
            "chroma(11)=1",
            "band(31)=1",
            "pan(0)=-1",
            "drums.band(3)=1",
            "vocals.melody=60",
        ] {
            assert_eq!(hold(text), Ok(true), "{text}");
        }
        let unknown = [
            "depth=1",
            "band(32)=0",
            "band(x)=0",
            "chroma(12)=0",
            "note(88)=0",
            "drums.key=0",
            "horns.beat=0",
        ];
        for text in unknown {
            assert_eq!(hold(text), Ok(false), "{text}");
        }
        for text in ["size=3.1", "volume.x=-1", "band(0)=2", "pan(0)=2", "vocals.melody=89"] {
            assert!(hold(text).is_err(), "{text}");
        }
        let mut inputs = FrameInputs { params: vec![2.0, 20.0], ..FrameInputs::default() };
        held.apply(&mut inputs);
        assert_eq!((inputs.time, inputs.params[0], inputs.levels.of(LevelList::Band)[31]), (-4.0, 3.0, 1.0));
        assert_eq!(inputs.params[1], 25.0, "the scene's own key");
        let sound = [SoundInput::VolumeRight, SoundInput::Drop, SoundInput::Key];
        assert_eq!(sound.map(|input| inputs.sound[input]), [0.25, 0.5, 0.0]);
        assert_eq!(inputs.levels.of(LevelList::Chroma)[11], 1.0);
        let parts = ["drums.band(3)", "vocals.melody", "bass.band(3)"];
        let held = parts.map(|name| inputs.part(PartInput::named(name).unwrap().index() as f32));
        assert_eq!(held, [1.0, 60.0, 0.0]);
    }
}
