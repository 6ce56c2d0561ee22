//! Flags for light and motion blur, in stills and videos.

use anyhow::bail;
use clap::Args;

use super::choices::choice;
use super::parse::{parse_noise, parse_samples};
use super::projection::ShutterArguments;
use crate::export::paths::{LightModel, PathChoice};
use crate::export::{SceneChoice, Shutter};

#[derive(Args)]
pub(super) struct LightArguments {
    #[command(flatten)]
    shutter: ShutterArguments,
    /// Computation of light
    #[arg(long, value_name = "HOW", default_value = "raster", value_parser = choice::<LightModel>())]
    light: LightModel,
    /// With --light path: most paths of a pixel [default: 256]
    #[arg(long, value_name = "COUNT", value_parser = parse_samples, allow_negative_numbers = true)]
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
        let paths = match self.light {
            LightModel::Paths => Some(PathChoice {
                samples: self.samples.unwrap_or(PathChoice::SAMPLES),
                noise: self.noise.unwrap_or(PathChoice::NOISE),
                is_filtered: !self.no_filter,
            }),
            LightModel::Raster if self.samples.is_some() => {
                bail!("--samples is about paths of light: give --light path too")
            }
            LightModel::Raster if self.noise.is_some() => {
                bail!("--noise is about paths of light: give --light path too")
            }
            LightModel::Raster if self.no_filter => {
                bail!("--no-filter is about paths of light: give --light path too")
            }
            LightModel::Raster => None,
        };
        if paths.is_some() && scene.alpha {
            bail!("--light path draws no transparent sky: leave out --alpha or --light");
        }
        if paths.is_some() && scene.view.is_some() {
            bail!("--light path draws no views: leave out --view or --light");
        }
        Ok(SceneChoice { paths, ..scene })
    }

    pub(super) fn shutter(&self) -> Shutter {
        self.shutter.shutter()
    }

    /// The number of paths of a pixel, if the light is computed by paths.
    pub(super) fn samples(&self) -> Option<u64> {
        (self.light == LightModel::Paths).then(|| self.samples.unwrap_or(PathChoice::SAMPLES).into())
    }
}
