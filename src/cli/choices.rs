//! What the command line chooses from, and what that means.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::config::{Choice, SdfChoice};
use crate::export::video::{Codec, EncodingQuality};

/// Reads a choice by its name.
pub(super) fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let names = T::ALL.iter().map(|(_, name, meaning)| match *meaning {
        "" => PossibleValue::new(*name),
        meaning => PossibleValue::new(*name).help(meaning),
    });
    let unknown = "it is none of the names";
    PossibleValuesParser::new(names.collect::<Vec<_>>()).try_map(move |name| T::named(&name).ok_or(unknown))
}

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
