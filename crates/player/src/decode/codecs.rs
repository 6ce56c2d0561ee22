//! Codecs: their decoders, their names, and the pre-roll that they need after a jump.

use std::sync::LazyLock;

use symphonia::core::codecs::audio::well_known as id;
use symphonia::core::codecs::audio::{
    AudioCodecId, AudioCodecParameters, AudioDecoder, AudioDecoderOptions, CODEC_ID_NULL_AUDIO,
};
use symphonia::core::codecs::registry::CodecRegistry;
use symphonia::core::errors::Error;

use super::error::Problem;
use super::{contained, sniff};

const OPUS_RATE: u32 = 48_000;

static REGISTRY: LazyLock<CodecRegistry> = LazyLock::new(|| {
    let mut registry = CodecRegistry::new();
    symphonia::default::register_enabled_codecs(&mut registry);
    registry.register_audio_decoder::<symphonia_adapter_libopus::OpusDecoder>();
    registry
});

pub(super) fn make(params: &AudioCodecParameters) -> Result<Box<dyn AudioDecoder>, Problem> {
    let channels = params.channels.as_ref().map_or(1, |channels| channels.count());
    let mut params = params.clone();
    if params.codec == id::CODEC_ID_OPUS {
        // Matroska may state the sound's rate before encoding. The head is removed, because with the head the decoder
        // would drop the pre-skip itself, and again after every jump.
        params.sample_rate = Some(OPUS_RATE);
        params.extra_data = None;
    }
    sniff::check(channels, params.sample_rate.unwrap_or(OPUS_RATE))?;
    let options = AudioDecoderOptions::default();
    match contained(|| REGISTRY.make_audio_decoder(&params, &options))? {
        Ok(decoder) => Ok(decoder),
        Err(Error::DecodeError(what)) => {
            Err(Problem::Damaged(format!("its codec cannot be set up ({what})")))
        }
        Err(_) => Err(Problem::UnsupportedCodec(match params.codec {
            id::CODEC_ID_AAC if channels > 2 => format!("AAC with {channels} channels"),
            id::CODEC_ID_AAC => "AAC with a profile other than LC (such as HE-AAC)".into(),
            id::CODEC_ID_OPUS => format!("Opus with {channels} channels"),
            codec => codec_name(codec).into(),
        })),
    }
}

fn codec_name(codec: AudioCodecId) -> &'static str {
    match codec {
        CODEC_ID_NULL_AUDIO => "an unknown codec",
        id::CODEC_ID_WMA => "Windows Media Audio",
        id::CODEC_ID_AC3 => "AC-3 (Dolby Digital)",
        id::CODEC_ID_EAC3 => "E-AC-3 (Dolby Digital Plus)",
        id::CODEC_ID_AC4 => "AC-4",
        id::CODEC_ID_DCA => "DTS",
        id::CODEC_ID_TRUEHD => "TrueHD",
        id::CODEC_ID_SPEEX => "Speex",
        id::CODEC_ID_MUSEPACK => "Musepack",
        id::CODEC_ID_WAVPACK => "WavPack",
        id::CODEC_ID_MONKEYS_AUDIO => "Monkey's Audio",
        id::CODEC_ID_TTA => "True Audio",
        id::CODEC_ID_ADPCM_G722 => "G.722 ADPCM",
        id::CODEC_ID_ADPCM_G726 | id::CODEC_ID_ADPCM_G726LE => "G.726 ADPCM",
        _ => "an unsupported codec",
    }
}

/// Returns the codec's grid: packets begin at multiples of this many frames. Opus frames last 2.5 ms or more.
pub(super) fn grid(codec: AudioCodecId) -> Option<u32> {
    match codec {
        id::CODEC_ID_AAC => Some(1024),
        id::CODEC_ID_MP3 => Some(576),
        id::CODEC_ID_OPUS => Some(120),
        _ => None,
    }
}

/// True for MPEG audio, whose packets begin with a header that may change in the middle of a stream.
pub(super) fn is_mpeg_audio(codec: AudioCodecId) -> bool {
    matches!(codec, id::CODEC_ID_MP1 | id::CODEC_ID_MP2 | id::CODEC_ID_MP3)
}

pub(super) fn is_opus(codec: AudioCodecId) -> bool {
    codec == id::CODEC_ID_OPUS
}

/// Returns the number of frames to decode before the target of a jump, so that the decoder reaches the right state.
/// Half a second covers the overlap of all lossy codecs, MP3's bit reservoir and the 80 ms that RFC 7845, 4.6 requires
/// for Opus.
pub(super) fn pre_roll(codec: AudioCodecId, rate: u32) -> i64 {
    let lossless = (id::CODEC_ID_PCM_S32LE..=id::CODEC_ID_PCM_MULAW).contains(&codec)
        || matches!(codec, id::CODEC_ID_FLAC | id::CODEC_ID_ALAC);
    if lossless { 0 } else { i64::from(rate / 2) }
}

/// Returns the known encoder delay (AAC: 1024, 2048, Apple 2112; LAME: 1105) within a tick of `about`, or `about`.
pub(super) fn known_delay(codec: AudioCodecId, about: u64, rate: u32) -> u64 {
    let known: &[u64] = match codec {
        id::CODEC_ID_AAC => &[1024, 2048, 2112],
        id::CODEC_ID_MP3 => &[1105],
        _ => &[],
    };
    let tick = u64::from(rate) / 1000 + 1;
    known.iter().copied().find(|delay| delay.abs_diff(about) <= tick).unwrap_or(about)
}
