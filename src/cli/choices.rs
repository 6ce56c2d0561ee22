//! What the command line chooses from, and what that means.

use crate::config::{QualityChoice, SdfChoice};
use crate::export::video::{Codec, EncodingQuality};
use crate::gpu::scene_resources::CellUse;
use mariana_field::world::ToneMap;
use mariana_music::Gain;

/// See [`SdfChoice`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum Sdf {
    Interpreted,
    Compiled,
    Auto,
}

impl From<Sdf> for SdfChoice {
    fn from(choice: Sdf) -> Self {
        match choice {
            Sdf::Interpreted => SdfChoice::Interpreted,
            Sdf::Compiled => SdfChoice::Compiled,
            Sdf::Auto => SdfChoice::Auto,
        }
    }
}

/// See [`Gain`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum GainChoice {
    Auto,
    Off,
}

impl From<GainChoice> for Gain {
    fn from(choice: GainChoice) -> Self {
        match choice {
            GainChoice::Auto => Gain::Auto,
            GainChoice::Off => Gain::Off,
        }
    }
}

/// See [`ToneMap`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum ToneMapChoice {
    Agx,
    Aces,
    Reinhard,
    None,
}

impl From<ToneMapChoice> for ToneMap {
    fn from(choice: ToneMapChoice) -> Self {
        match choice {
            ToneMapChoice::Agx => ToneMap::Agx,
            ToneMapChoice::Aces => ToneMap::Aces,
            ToneMapChoice::Reinhard => ToneMap::Reinhard,
            ToneMapChoice::None => ToneMap::None,
        }
    }
}

/// See [`mariana_player::track::Repeat`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum RepeatChoice {
    /// All tracks, again and again
    All,
    /// One track, again and again
    One,
    /// Each track once; the window stays open
    Off,
}

/// On or off.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Switch {
    On,
    Off,
}

impl From<Switch> for CellUse {
    fn from(switch: Switch) -> Self {
        match switch {
            Switch::On => Self::Always,
            Switch::Off => Self::Never,
        }
    }
}

/// See [`QualityChoice`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum Quality {
    /// As good as the frame rate allows
    Auto,
    /// About half of the window's width and height
    Low,
    Medium,
    High,
    /// Every pixel, every term, however long it takes
    Best,
}

impl From<Quality> for QualityChoice {
    fn from(quality: Quality) -> Self {
        match quality {
            Quality::Auto => QualityChoice::Auto,
            Quality::Low => QualityChoice::Low,
            Quality::Medium => QualityChoice::Medium,
            Quality::High => QualityChoice::High,
            Quality::Best => QualityChoice::Best,
        }
    }
}

/// See [`Codec`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum CodecChoice {
    /// What everything plays
    H264,
    /// Half of the bytes
    H265,
    /// For webm
    Vp9,
    /// The smallest, and the slowest to make
    Av1,
}

impl From<CodecChoice> for Codec {
    fn from(choice: CodecChoice) -> Self {
        match choice {
            CodecChoice::H264 => Self::H264,
            CodecChoice::H265 => Self::H265,
            CodecChoice::Vp9 => Self::Vp9,
            CodecChoice::Av1 => Self::Av1,
        }
    }
}

/// See [`EncodingQuality`].
#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum EncodingChoice {
    /// A small preview
    Low,
    Medium,
    /// Hardly a difference is seen
    High,
    /// For services that encode it once more
    Best,
}

impl From<EncodingChoice> for EncodingQuality {
    fn from(choice: EncodingChoice) -> Self {
        match choice {
            EncodingChoice::Low => Self::Low,
            EncodingChoice::Medium => Self::Medium,
            EncodingChoice::High => Self::High,
            EncodingChoice::Best => Self::Best,
        }
    }
}
