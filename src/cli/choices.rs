//! Flags whose value is one of several names, and the conversion of these values into the program's own types.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::config::{Choice, SdfChoice};
use crate::export::video::{Codec, EncodingQuality};

pub(super) fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let names = T::ALL.iter().map(|(_, name, meaning)| match *meaning {
        "" => PossibleValue::new(*name),
        meaning => PossibleValue::new(*name).help(meaning),
    });
    let unknown = "unknown name";
    PossibleValuesParser::new(names.collect::<Vec<_>>()).try_map(move |name| T::named(&name).ok_or(unknown))
}

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

#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum RepeatChoice {
    /// All tracks, over and over
    All,
    /// One track, over and over
    One,
    /// Each track once; the window stays open
    Off,
}

#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum CodecChoice {
    /// Plays everywhere
    H264,
    /// Half the bytes of h264
    H265,
    /// For webm
    Vp9,
    /// The smallest files, and the slowest encoding
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

#[derive(Clone, Copy, clap::ValueEnum)]
pub(super) enum EncodingChoice {
    /// A small preview
    Low,
    Medium,
    /// Differences are hardly visible
    High,
    /// For services that encode the video again
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
