//! Flags for light and motion blur, in stills and videos.

use anyhow::bail;
use clap::Args;

use super::parse::{choice, number, parse_noise, whole_number};
use crate::export::paths::{LightModel, PathChoice};
use crate::export::{SceneChoice, Shutter};
use crate::limits;

#[derive(Args)]
pub(super) struct LightArguments {
    /// Motion blur: the part of a frame's time during which the shutter is open, in degrees, such as 180; 0 for none
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = number(0.0, 360.0, "degrees"), conflicts_with_all = ["view", "alpha"], allow_negative_numbers = true)]
    shutter: f64,
    /// Exposures of each frame with --shutter; drawing takes this many times as long
    #[arg(long, value_name = "COUNT", default_value_t = Shutter::EXPOSURES, value_parser = whole_number::<u32>(2, limits::EXPOSURES_MAX, "exposures"), requires = "shutter", allow_negative_numbers = true)]
    shutter_frames: u32,
    /// Computation of light
    #[arg(long, value_name = "HOW", default_value = "raster", value_parser = choice::<LightModel>())]
    light: LightModel,
    /// With --light path: most paths of a pixel [default: 256]
    #[arg(long, value_name = "COUNT", value_parser = whole_number::<u16>(1, limits::PATH_SAMPLES_MAX, "paths"), allow_negative_numbers = true)]
    samples: Option<u16>,
    /// With --light path: stop where the light's relative error is below this; 0 for all paths [default: 0.03]
    #[arg(long, value_name = "ERROR", value_parser = parse_noise, allow_negative_numbers = true)]
    noise: Option<f32>,
    /// With --light path: leave the noise that is left, instead of smoothing it
    #[arg(long)]
    no_filter: bool,
}

impl LightArguments {
    /// Adds the flags to the choice of a scene.
    ///
    /// # Errors
    /// Fails if flags contradict each other.
    pub(super) fn apply(&self, scene: SceneChoice) -> anyhow::Result<SceneChoice> {
        let of_paths = [
            (self.samples.is_some(), "--samples"),
            (self.noise.is_some(), "--noise"),
            (self.no_filter, "--no-filter"),
        ];
        if self.light == LightModel::Raster {
            if let Some((_, flag)) = of_paths.into_iter().find(|(is_given, _)| *is_given) {
                bail!("{flag} is about paths of light: give --light path too");
            }
            return Ok(scene);
        }
        if scene.alpha {
            bail!("--light path draws no transparent sky: leave out --alpha or --light");
        }
        if scene.view.is_some() {
            bail!("--light path draws no views: leave out --view or --light");
        }
        let paths = PathChoice {
            samples: self.samples.unwrap_or(PathChoice::SAMPLES),
            noise: self.noise.unwrap_or(PathChoice::NOISE),
            is_filtered: !self.no_filter,
        };
        Ok(SceneChoice { paths: Some(paths), ..scene })
    }

    pub(super) fn shutter(&self) -> Shutter {
        Shutter { degrees: self.shutter, exposures: self.shutter_frames }
    }

    /// The number of paths of a pixel, if the light is computed by paths.
    pub(super) fn samples(&self) -> Option<u64> {
        (self.light == LightModel::Paths).then(|| self.samples.unwrap_or(PathChoice::SAMPLES).into())
    }
}
