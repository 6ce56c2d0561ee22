//! What a user chooses for good of how pictures come onto screens: a part of [`super::Choices`].

use serde::{Deserialize, Deserializer, Serialize, de::Error};

use super::choices::{by_name, is_default};
use crate::limits::LIMITS;
use crate::placement::{Corners, Crop, Flip, Placement};

/// See the module.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StageChoices {
    /// How much of their light pictures have, 0..100 percent.
    #[serde(deserialize_with = "percent", skip_serializing_if = "is_full")]
    pub brightness: u8,
    /// How long a blackout takes to come and to go, and a picture that was held to give way, in seconds.
    #[serde(deserialize_with = "fade", skip_serializing_if = "is_usual")]
    pub blackout_fade: f64,
    /// Which way pictures are mirrored.
    #[serde(with = "by_name", skip_serializing_if = "is_default")]
    pub flip: Flip,
    /// What their edges lose.
    #[serde(skip_serializing_if = "is_default")]
    pub crop: Crop,
    /// Where their corners lie.
    #[serde(skip_serializing_if = "is_default")]
    pub corners: Corners,
    /// The monitor that the picture fills besides the window, by name or number; none is none.
    #[serde(skip_serializing_if = "is_default")]
    pub output: Option<String>,
}

/// How long a blackout takes where nothing else is chosen, in seconds.
const FADE_SECONDS: f64 = 0.5;

impl Default for StageChoices {
    fn default() -> Self {
        Self {
            brightness: 100,
            blackout_fade: FADE_SECONDS,
            flip: Flip::default(),
            crop: Crop::default(),
            corners: Corners::default(),
            output: None,
        }
    }
}

impl StageChoices {
    /// Where pictures lie on a screen.
    pub fn placement(&self) -> Placement {
        Placement { crop: self.crop, flip: self.flip, corners: self.corners }
    }
}

fn is_full(percent: &u8) -> bool {
    *percent == 100
}

fn is_usual(seconds: &f64) -> bool {
    *seconds == FADE_SECONDS
}

fn percent<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u8, D::Error> {
    let percent = u8::deserialize(deserializer)?;
    if percent <= 100 { Ok(percent) } else { Err(D::Error::custom("a brightness is 0 to 100 percent")) }
}

fn fade<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let seconds = f64::deserialize(deserializer)?;
    if (0.0..=LIMITS.fade_seconds_max).contains(&seconds) {
        Ok(seconds)
    } else {
        Err(D::Error::custom("a fade takes 0 to 60 seconds"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_chosen_is_read_again_and_what_cannot_be_drawn_is_not() {
        assert_eq!(toml::to_string(&StageChoices::default()).unwrap(), "");
        let corners = Corners::default().with(1, [0.9, 0.1]).unwrap();
        let crop = Crop::try_from([1.0, 2.0, 3.0, 4.5]).unwrap();
        let output = Some("HDMI-1".to_owned());
        let chosen =
            StageChoices { brightness: 7, blackout_fade: 2.5, flip: Flip::Vertical, crop, corners, output };
        let text = toml::to_string(&chosen).unwrap();
        assert_eq!(toml::from_str::<StageChoices>(&text).unwrap(), chosen, "{text}");
        for text in [
            "brightness = 101",
            "blackout_fade = 61.0",
            "blackout_fade = nan",
            "flip = \"over\"",
            "crop = [60.0, 0.0, 60.0, 0.0]",
            "corners = [[0.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]",
        ] {
            assert!(toml::from_str::<StageChoices>(text).is_err(), "{text}");
        }
    }
}
