//! The user's choices in the settings panel, as stored in the settings file. A choice has the same name in the file,
//! the panel and the command-line flag; a flag overrides it for one run.

use mariana_field::world::ToneMap;
use mariana_music::Gain;
use mariana_player::track::Repeat;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use super::setting_rows::{SettingGroup, SettingRow, Shown};
use super::{FollowChoice, QualityChoice};
use crate::{limits, with_settings};
use mariana_render::frame::projection::{ProjectionKind, Stereo};
use mariana_render::placement::{Corners, Crop, Flip, Placement};

/// A value with a fixed set of named options.
pub trait Choice: Copy + PartialEq + 'static {
    /// All options, each with its name and, if the name is not clear enough, an explanation.
    const ALL: &'static [(Self, &'static str, &'static str)];
    /// Names in the panel that differ, for people who never see the file or the flags.
    const WORDS: &'static [(Self, &'static str)] = &[];

    /// Returns the option's name.
    fn name(self) -> &'static str {
        Self::ALL.iter().find(|(value, ..)| *value == self).map_or("", |(_, name, _)| name)
    }

    /// Returns the option's name in the panel.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(value, _)| *value == self).map_or(self.name(), |(_, word)| word)
    }

    /// Returns the option with this name.
    fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known, _)| *known == name).map(|(value, ..)| *value)
    }
}

impl Choice for bool {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[(true, "on", ""), (false, "off", "")];
}

impl Choice for QualityChoice {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Auto, "auto", "The best that keeps the frame rate"),
        (Self::Low, "low", "About half the window's width and height"),
        (Self::Medium, "medium", ""),
        (Self::High, "high", ""),
        (Self::Best, "best", "Full resolution and all effects, at any frame rate"),
    ];
}

impl Choice for FollowChoice {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Songs, "songs", "For songs, unless you started with a scene"),
        (Self::On, "on", "For songs and inputs"),
        (Self::Off, "off", "Only you change the scene"),
    ];
    const WORDS: &'static [(Self, &'static str)] = &[(Self::On, "always"), (Self::Off, "never")];
}

impl Choice for Repeat {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::All, "all", "All tracks, over and over"),
        (Self::One, "one", "One track, over and over"),
        (Self::Off, "off", "Each track once; the window stays open"),
    ];
}

impl Choice for Flip {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Off, "off", ""),
        (Self::Horizontal, "horizontal", "For rear projection"),
        (Self::Vertical, "vertical", ""),
        (Self::Both, "both", "For a projector mounted upside down"),
    ];
    const WORDS: &'static [(Self, &'static str)] =
        &[(Self::Horizontal, "left and right"), (Self::Vertical, "top and bottom")];
}

impl Choice for Gain {
    const ALL: &'static [(Self, &'static str, &'static str)] =
        &[(Self::Auto, "auto", ""), (Self::Off, "off", "")];
    const WORDS: &'static [(Self, &'static str)] = &[(Self::Auto, "on")];
}

impl Choice for ProjectionKind {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Flat, "flat", ""),
        (Self::Sphere, "360", "The whole sphere, twice as wide as high"),
        (Self::Dome, "dome", "A square dome master: a disc of 180 degrees"),
        (Self::Vr180, "vr180", "The half in front of the camera, square"),
    ];
}

impl Choice for Stereo {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (Self::None, "none", ""),
        (Self::SideBySide, "side-by-side", "The left eye on the left"),
        (Self::OverUnder, "over-under", "The left eye above"),
    ];
}

/// `None` uses the scene's tone map.
impl Choice for Option<ToneMap> {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (None, "scene", "The scene's own choice"),
        (
            Some(ToneMap::Agx),
            ToneMap::Agx.name(),
            "Natural colours; bright colours fade to white, as on film",
        ),
        (Some(ToneMap::Aces), ToneMap::Aces.name(), "Deep shadows and vivid colours"),
        (Some(ToneMap::Reinhard), ToneMap::Reinhard.name(), "Gentle highlights"),
        (Some(ToneMap::None), ToneMap::None.name(), "Light as it is; all that is too bright becomes white"),
    ];
    const WORDS: &'static [(Self, &'static str)] = &[
        (None, "the scene's"),
        (Some(ToneMap::Agx), "film"),
        (Some(ToneMap::Aces), "high contrast"),
        (Some(ToneMap::Reinhard), "soft"),
        (Some(ToneMap::None), "plain"),
    ];
}

macro_rules! define_settings {
    ($( $table:ident { $(
        $(#[$of_field:meta])* $field:ident: $type:ty = $default:expr, $variant:ident
            $({ $name:literal, $purpose:literal, $group:ident })? $([ $($flag:tt)* ])?;
    )* } )*) => {
        define_settings! { @structs $( $table { $( $(#[$of_field])* $field: $type = $default; )* } )* }

        /// A setting and its value.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Setting { $($(
            #[doc = concat!("See [`", stringify!($table), "::", stringify!($field), "`].")]
            $variant($type),
        )*)* }

        $( impl $table {
            /// Returns the rows of the panel. Marks values that differ from `remembered` as values for this run only.
            pub fn rows(&self, remembered: &Self) -> Vec<SettingRow> {
                vec![$( $( SettingRow {
                    name: $name.to_owned(),
                    purpose: self.$field.purpose($purpose),
                    values: self.$field.values(Setting::$variant),
                    for_this_run: self.$field != remembered.$field,
                    group: SettingGroup::$group,
                }, )? )*]
            }

            /// Sets one of this table's settings. Returns `false` if the setting is in another table.
            fn set_own(&mut self, setting: &Setting) -> bool {
                match setting {
                    $( Setting::$variant(value) => self.$field = value.clone(), )*
                    _ => return false,
                }
                true
            }
        } )*
    };
    (@structs Choices { $( $(#[$of_field:meta])* $field:ident: $type:ty = $default:expr; )* }
        DisplayChoices { $( $(#[$of_stage:meta])* $staged:ident: $staged_type:ty = $staged_default:expr; )* }) => {
        /// All user choices. Missing entries in the file take their defaults.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct Choices {
            $( $(#[$of_field])* pub $field: $type, )*
            /// The placement and brightness of frames on screens.
            pub stage: DisplayChoices,
        }

        impl Default for Choices {
            fn default() -> Self {
                Self { $( $field: $default, )* stage: DisplayChoices::default() }
            }
        }

        /// The placement and brightness of frames on screens.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct DisplayChoices {
            $( $(#[$of_stage])* pub $staged: $staged_type, )*
        }

        impl Default for DisplayChoices {
            fn default() -> Self {
                Self { $( $staged: $staged_default, )* }
            }
        }
    };
}

with_settings!(define_settings);

impl Choices {
    /// Changes one setting.
    pub fn set(&mut self, setting: &Setting) {
        let _ = self.set_own(setting) || self.stage.set_own(setting);
    }
}

impl DisplayChoices {
    /// Returns the placement of frames on a screen.
    pub fn placement(&self) -> Placement {
        Placement { crop: self.crop, flip: self.flip, corners: self.corners }
    }
}

const FADE_SECONDS: f64 = 0.5;

fn percent<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u8, D::Error> {
    let percent = u8::deserialize(deserializer)?;
    if percent <= 100 { Ok(percent) } else { Err(D::Error::custom("brightness must be 0 to 100 percent")) }
}

fn fade<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let seconds = f64::deserialize(deserializer)?;
    if (0.0..=limits::FADE_SECONDS_MAX).contains(&seconds) {
        Ok(seconds)
    } else {
        Err(D::Error::custom("a fade must take 0 to 60 seconds"))
    }
}

pub(super) mod by_name {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    use super::Choice;

    pub(crate) fn serialize<T: Choice, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(value.name())
    }

    pub(crate) fn deserialize<'de, T: Choice, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        let name = String::deserialize(deserializer)?;
        T::named(&name).ok_or_else(|| D::Error::custom(format!("unknown choice '{name}'")))
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
        assert_eq!(
            <Option<ToneMap>>::ALL.len(),
            ToneMap::ALL.len() + 1,
            "a tone map is missing from the choices"
        );
    }

    #[test]
    fn only_changed_choices_are_written_and_read_back() {
        let mut table = toml::Table::new();
        let one = Choices { hints: false, ..Choices::default() };
        crate::understood::rewrite(&mut table, &Choices::default(), &one).unwrap();
        assert_eq!(table.to_string(), "hints = \"off\"\n");
        let chosen = Choices {
            output: Some("p:usb".into()),
            quality: QualityChoice::Low,
            flash_limiter: false,
            tone_map: Some(ToneMap::None),
            gain: Gain::Off,
            follow_song: FollowChoice::On,
            last_tracks: false,
            stay_awake: false,
            hints: false,
            next_scene: true,
            stage: DisplayChoices { brightness: 40, flip: Flip::Both, ..DisplayChoices::default() },
        };
        let text = toml::to_string(&chosen).unwrap();
        assert!(text.contains("flash_limiter = \"off\"") && text.contains("tone_map = \"none\""), "{text}");
        assert_eq!(toml::from_str::<Choices>(&text).unwrap(), chosen);
    }

    #[test]
    fn valid_display_choices_are_read_back_and_invalid_ones_refused() {
        let corners = Corners::default().with(1, [0.9, 0.1]).unwrap();
        let crop = Crop::try_from([1.0, 2.0, 3.0, 4.5]).unwrap();
        let output = Some("HDMI-1".to_owned());
        let chosen =
            DisplayChoices { brightness: 7, blackout_fade: 2.5, flip: Flip::Vertical, crop, corners, output };
        let text = toml::to_string(&chosen).unwrap();
        assert_eq!(toml::from_str::<DisplayChoices>(&text).unwrap(), chosen, "{text}");
        for text in [
            "brightness = 101",
            "blackout_fade = 61.0",
            "blackout_fade = nan",
            "flip = \"over\"",
            "crop = [60.0, 0.0, 60.0, 0.0]",
            "corners = [[0.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]",
        ] {
            assert!(toml::from_str::<DisplayChoices>(text).is_err(), "{text}");
        }
    }
}
