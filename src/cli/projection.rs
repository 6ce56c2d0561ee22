//! Flags for projections.

use anyhow::bail;
use clap::Args;

use super::parse::{choice, number};
use crate::frame::projection::{Projection, ProjectionKind, Stereo};

#[derive(Args)]
pub(super) struct ProjectionArguments {
    /// Projection: for players of 360-degree videos, planetariums and headsets
    #[arg(long, value_name = "SURFACE", default_value = "flat", value_parser = choice::<ProjectionKind>())]
    projection: ProjectionKind,
    /// Pictures for two eyes
    #[arg(long, value_name = "HOW", default_value = "none", value_parser = choice::<Stereo>())]
    stereo: Stereo,
    /// Distance of the eyes in the scene's units; larger distances make the scene look smaller
    #[arg(long, value_name = "UNITS", default_value_t = Projection::EYE_DISTANCE, value_parser = number(0.0, 1000.0, "units"), requires = "stereo", allow_negative_numbers = true)]
    eye_distance: f64,
    /// Height of the camera's target in a dome, in degrees above the front rim; 90 is the zenith
    /// [default: 45]
    #[arg(long, value_name = "DEGREES", value_parser = number(0.0, 90.0, "degrees"), allow_negative_numbers = true)]
    dome_tilt: Option<f64>,
}

impl ProjectionArguments {
    /// Returns the projection.
    ///
    /// # Errors
    /// Fails if a flag is about another projection.
    pub(super) fn projection(&self) -> anyhow::Result<Projection> {
        let Self { projection: kind, stereo, eye_distance, dome_tilt } = *self;
        if dome_tilt.is_some() && kind != ProjectionKind::Dome {
            bail!("--dome-tilt is about domes: give --projection dome too");
        }
        Ok(Projection { kind, stereo, eye_distance, dome_tilt: dome_tilt.unwrap_or(Projection::DOME_TILT) })
    }
}
