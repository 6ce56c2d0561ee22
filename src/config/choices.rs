//! What a user chooses for good: in the window's panel of settings, remembered in the settings file. A flag of the
//! command line overrules it for a run.
//!
//! **A choice has one name**, which is that of the flag, of the file and of the panel.

use mariana_field::world::ToneMap;
use mariana_music::Gain;
use serde::{Deserialize, Serialize};

use super::{FollowChoice, QualityChoice, StageChoices};
use crate::placement::Flip;

/// One of several things, each with a name.
pub trait Choice: Copy + PartialEq + 'static {
    /// All of them: each with its name, and with what it means where the name does not say that.
    const ALL: &'static [(Self, &'static str, &'static str)];

    /// Its name.
    fn name(self) -> &'static str {
        Self::ALL.iter().find(|(value, ..)| *value == self).map_or("", |(_, name, _)| name)
    }

    /// The one with this name.
    fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known, _)| *known == name).map(|(value, ..)| *value)
    }
}

impl Choice for bool {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[(true, "on", ""), (false, "off", "")];
}

impl Choice for QualityChoice {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Auto, "auto", "As good as the frame rate allows"),
        (Self::Low, "low", "About half of the window's width and height"),
        (Self::Medium, "medium", ""),
        (Self::High, "high", ""),
        (Self::Best, "best", "Every pixel, every term, however long it takes"),
    ];
}

impl Choice for FollowChoice {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Songs, "songs", "Every song, unless the program was started with a scene"),
        (Self::On, "on", "Inputs, too"),
        (Self::Off, "off", "N and P change the scene"),
    ];
}

impl Choice for Flip {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Off, "off", ""),
        (Self::Horizontal, "horizontal", "For a screen that is lit from behind"),
        (Self::Vertical, "vertical", ""),
        (Self::Both, "both", "For a projector that hangs upside down"),
    ];
}

impl Choice for Gain {
    const ALL: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Auto, "auto", ""), (Self::Off, "off", "")];
}

/// None is the scene's own.
impl Choice for Option<ToneMap> {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (None, "scene", "As the scene says, otherwise agx"),
        (Some(ToneMap::Agx), ToneMap::Agx.name(), ""),
        (Some(ToneMap::Aces), ToneMap::Aces.name(), ""),
        (Some(ToneMap::Reinhard), ToneMap::Reinhard.name(), ""),
        (Some(ToneMap::None), ToneMap::None.name(), ""),
    ];
}

/// Everything that is chosen for good. What is not remembered is as it is by default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Choices {
    /// Id of the output that songs play on while it is there; none is the system's default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
    /// How much a picture may cost.
    #[serde(with = "by_name", skip_serializing_if = "is_default")]
    pub quality: QualityChoice,
    /// Whether more than three flashes a second are dimmed.
    #[serde(with = "by_name", skip_serializing_if = "is_on")]
    pub flash_limiter: bool,
    /// How light is turned into screen colours; none is as the scene says.
    #[serde(with = "by_name", skip_serializing_if = "is_default")]
    pub tone_map: Option<ToneMap>,
    /// Whether quiet and loud sound move the picture alike.
    #[serde(with = "by_name", skip_serializing_if = "is_default")]
    pub gain: Gain,
    /// Whether scenes follow the song.
    #[serde(with = "by_name", skip_serializing_if = "is_default")]
    pub follow_song: FollowChoice,
    /// Whether the next show goes on with the tracks of the last one.
    #[serde(with = "by_name", skip_serializing_if = "is_on")]
    pub last_tracks: bool,
    /// Whether more shows over the picture than what was asked for and what is wrong.
    #[serde(with = "by_name", skip_serializing_if = "is_on")]
    pub hints: bool,
    /// Whether the scene that comes next shows in a window that has no output beside it.
    #[serde(with = "by_name", skip_serializing_if = "is_default")]
    pub next_scene: bool,
    /// How pictures come onto screens.
    #[serde(skip_serializing_if = "is_default")]
    pub stage: StageChoices,
}

impl Default for Choices {
    fn default() -> Self {
        Self {
            output: None,
            quality: QualityChoice::default(),
            flash_limiter: true,
            tone_map: None,
            gain: Gain::default(),
            follow_song: FollowChoice::default(),
            last_tracks: true,
            hints: true,
            next_scene: false,
            stage: StageChoices::default(),
        }
    }
}

fn is_on(switch: &bool) -> bool {
    *switch
}

pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Writes a choice as its name.
pub(super) mod by_name {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    use super::Choice;

    pub(in crate::config) fn serialize<T: Choice, S: Serializer>(
        value: &T,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(value.name())
    }

    pub(in crate::config) fn deserialize<'de, T: Choice, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<T, D::Error> {
        let name = String::deserialize(deserializer)?;
        T::named(&name).ok_or_else(|| D::Error::custom(format!("there is no choice '{name}'")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_named<T: Choice + std::fmt::Debug>() {
        for (value, name, _) in T::ALL {
            assert_eq!((value.name(), T::named(name)), (*name, Some(*value)));
        }
        assert_eq!(T::named("no such choice"), None);
    }

    #[test]
    fn every_choice_is_found_by_its_name() {
        assert_named::<bool>();
        assert_named::<QualityChoice>();
        assert_named::<FollowChoice>();
        assert_named::<Flip>();
        assert_named::<Gain>();
        assert_named::<Option<ToneMap>>();
        assert_eq!(<Option<ToneMap>>::ALL.len(), ToneMap::ALL.len() + 1, "a tone map cannot be chosen");
    }

    #[test]
    fn only_what_was_chosen_is_written_and_all_of_it_is_read_again() {
        assert_eq!(toml::to_string(&Choices::default()).unwrap(), "");
        let chosen = Choices {
            output: Some("p:usb".into()),
            quality: QualityChoice::Low,
            flash_limiter: false,
            tone_map: Some(ToneMap::None),
            gain: Gain::Off,
            follow_song: FollowChoice::On,
            last_tracks: false,
            hints: false,
            next_scene: true,
            stage: StageChoices { brightness: 40, flip: Flip::Both, ..StageChoices::default() },
        };
        let text = toml::to_string(&chosen).unwrap();
        assert!(text.contains("flash_limiter = \"off\"") && text.contains("tone_map = \"none\""), "{text}");
        assert_eq!(toml::from_str::<Choices>(&text).unwrap(), chosen);
    }
}
