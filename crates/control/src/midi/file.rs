//! The file format of mappings, as TOML that people can edit.

use serde::{Deserialize, Serialize};

use super::encoding::Encoding;
use super::mapping::{Curve, Mapping, Mappings, Target};
use super::source::Source;
use crate::limits;

/// The contents of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct MappingFile {
    /// True if a device's MIDI clock sets the tempo.
    pub clock: bool,
    /// The knob mappings.
    pub mappings: Mappings,
}

impl Default for MappingFile {
    fn default() -> Self {
        Self { clock: true, mappings: Mappings::default() }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    #[serde(default = "yes")]
    clock: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    knob: Vec<Row>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    device: String,
    turned: Source,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    param: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    action: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<String>,
    #[serde(default = "whole")]
    range: [f32; 2],
    #[serde(default)]
    curve: Curve,
    #[serde(default)]
    smoothing: f32,
    #[serde(default)]
    pick_up: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    encoding: Option<Encoding>,
}

fn yes() -> bool {
    true
}

fn whole() -> [f32; 2] {
    [0.0, 1.0]
}

const HEAD: &str = "\
# MIDI mappings, as learned in the window (J). Edit this file only while Mariana is not running.
# `range` is in fractions of the parameter's range, `smoothing` in seconds; `curve` is linear, slow, fast, soft or root.
# `encoding` is absolute, offset, complement or sign; without it, Mariana finds it out from the first turns.

";

impl MappingFile {
    /// Parses the text of a file.
    ///
    /// # Errors
    /// Fails with the reason if the text is malformed or has too many mappings.
    pub fn read(text: &str) -> Result<Self, String> {
        let text: Text = toml::from_str(text).map_err(|error| error.message().trim().replace('\n', " "))?;
        let (count, max) = (text.knob.len(), limits::MAPPINGS_MAX);
        if count > max {
            return Err(format!("it has {count} mappings; the limit is {max}"));
        }
        let rows = text.knob.into_iter().enumerate();
        let list = rows.map(|(place, row)| {
            row.mapping().ok_or_else(|| {
                format!("mapping {} names neither a parameter with its scene nor an action", place + 1)
            })
        });
        Ok(Self { clock: text.clock, mappings: Mappings::of(list.collect::<Result<_, _>>()?) })
    }

    /// Returns the text of the file.
    ///
    /// # Errors
    /// Fails with the reason if a value cannot be serialized.
    pub fn text(&self) -> Result<String, String> {
        let knob = self.mappings.list().iter().map(Row::of).collect();
        let text = toml::to_string(&Text { clock: self.clock, knob });
        text.map(|text| format!("{HEAD}{text}")).map_err(|error| error.to_string())
    }
}

impl Row {
    fn of(mapping: &Mapping) -> Self {
        let (mut scene, mut param, mut action, mut value) = (None, None, None, None);
        match mapping.target.clone() {
            Target::Param { scene: of, name } => (scene, param) = (Some(of), Some(name)),
            Target::Action { name, value: with } => (action, value) = (Some(name), with),
        }
        Self {
            device: mapping.device.clone(),
            turned: mapping.source,
            scene,
            param,
            action,
            value,
            range: mapping.range,
            curve: mapping.curve,
            smoothing: mapping.smoothing,
            pick_up: mapping.picks_up,
            encoding: mapping.encoding,
        }
    }

    fn mapping(self) -> Option<Mapping> {
        let target = match (self.scene, self.param, self.action) {
            (Some(scene), Some(name), None) => Target::Param { scene, name },
            (None, None, Some(name)) => Target::Action { name, value: self.value },
            _ => return None,
        };
        let mut mapping = Mapping {
            device: self.device,
            source: self.turned,
            target,
            range: self.range,
            curve: self.curve,
            smoothing: self.smoothing,
            picks_up: self.pick_up,
            encoding: self.encoding,
        };
        mapping.mend().then_some(mapping)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn file() -> MappingFile {
        let param = Target::Param { scene: "my \"orb\"".to_owned(), name: "size".to_owned() };
        let action = Target::Action { name: "scene".to_owned(), value: Some("city".to_owned()) };
        let knob = Source::FineControl { channel: 3, number: 7 };
        let mut first = Mapping::learned("nano: KONTROL", knob, param);
        first.invert();
        first.curve = Curve::Soft;
        first.encoding = Some(Encoding::Complement);
        let pad = Mapping::learned("pads", Source::Note { channel: 9, key: 36 }, action);
        MappingFile { clock: false, mappings: Mappings::of(vec![first, pad]) }
    }

    #[test]
    fn mappings_are_readable_and_read_back() {
        let text = file().text().unwrap();
        assert_eq!(MappingFile::read(&text), Ok(file()));
        for line in [
            "turned = \"fine cc 7 on channel 4\"",
            "action = \"scene\"",
            "clock = false",
            "encoding = \"complement\"",
        ] {
            assert!(text.contains(line), "{line} is not in\n{text}");
        }
        assert_eq!(MappingFile::read(""), Ok(MappingFile::default()));
    }

    #[test]
    fn damaged_files_are_refused_with_a_reason() {
        let knob = "[[knob]]\ndevice = \"x\"\nturned = \"cc 1 on channel 1\"\n";
        for (text, what) in [
            ("clock = 7", "bool"),
            ("[[knob]]\ndevice = \"x\"\n", "turned"),
            ("[[knob]]\ndevice = \"x\"\nturned = \"cc 200 on channel 1\"\n", "not a MIDI control"),
            (knob, "neither a parameter"),
            (&format!("{knob}action = \"next\"\nscene = \"orb\"\n"), "neither a parameter"),
            (&format!("{knob}action = \"next\"\nrange = [nan, 1.0]\n"), "neither a parameter"),
            (&format!("{knob}action = \"next\"\nmood = 1\n"), "mood"),
            (&format!("{knob}action = \"volume\"\nencoding = \"relative\"\n"), "complement"),
            ("\u{0}\u{1}", ""),
        ] {
            let Err(why) = MappingFile::read(text) else { panic!("{text} was accepted") };
            assert!(why.contains(what), "{why} does not mention {what}");
        }
    }

    #[test]
    fn files_beyond_the_limits_are_refused() {
        let knob = "[[knob]]\ndevice = \"x\"\nturned = \"cc 1 on channel 1\"\naction = \"next\"\n";
        let many = knob.repeat(limits::MAPPINGS_MAX + 1);
        let refused = MappingFile::read(&many).unwrap_err();
        assert!(refused.contains("the limit is"), "{refused}");
        assert!(MappingFile::read(&knob.repeat(limits::MAPPINGS_MAX)).is_ok());
    }

    proptest! {
        #[test]
        fn damaged_bytes_never_panic(damage in proptest::collection::vec((0_usize..600, any::<u8>()), 0..8)) {
            let mut bytes = file().text().unwrap().into_bytes();
            for (place, value) in damage {
                if let Some(byte) = bytes.get_mut(place) {
                    *byte = value;
                }
            }
            if let Ok(read) = MappingFile::read(&String::from_utf8_lossy(&bytes)) {
                prop_assert!(read.text().is_ok());
            }
        }
    }
}
