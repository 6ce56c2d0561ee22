//! The answer of `ffprobe` about a file.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::decode::loudness::Loudness;
use crate::ffmpeg::Demuxer;
use crate::limits;

pub(super) const ENTRIES: &str = "format=format_name,format_long_name,duration:format_tags:\
    stream=index,codec_type,codec_name,codec_long_name,sample_rate,channels,channel_layout,duration:stream_tags";

type Tags = BTreeMap<String, String>;

/// An answer of `ffprobe`. Every field may be missing.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Answer {
    pub(super) format: Format,
    streams: Vec<Stream>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Format {
    format_name: String,
    format_long_name: String,
    duration: Option<String>,
    tags: Tags,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Stream {
    pub(super) index: u32,
    codec_type: String,
    codec_name: Option<String>,
    codec_long_name: Option<String>,
    sample_rate: Option<String>,
    pub(super) channels: usize,
    pub(super) channel_layout: String,
    duration: Option<String>,
    tags: Tags,
}

impl Answer {
    pub(super) fn sound(&self) -> Option<&Stream> {
        let mut sounds = self.streams.iter().filter(|stream| stream.codec_type == "audio");
        // Prefer a stream that can be decoded.
        let first = sounds.clone().next();
        sounds.find(|stream| stream.is_known()).or(first)
    }

    /// The length of the stream in seconds, if ffprobe reports a length.
    pub(super) fn duration(&self, stream: &Stream) -> Option<f64> {
        let reported = [&stream.duration, &self.format.duration].into_iter().flatten();
        let mut reported = reported.filter_map(|seconds| seconds.parse::<f64>().ok());
        reported.find(|seconds| *seconds > 0.0 && *seconds <= limits::CLAIMED_DURATION_MAX)
    }

    pub(super) fn tag(&self, stream: &Stream, name: &str) -> Option<String> {
        let in_tags = |tags: &Tags| {
            tags.iter().find(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, tag)| tag.clone())
        };
        in_tags(&stream.tags).or_else(|| in_tags(&self.format.tags)).filter(|tag| !tag.trim().is_empty())
    }

    pub(super) fn loudness(&self, stream: &Stream) -> Loudness {
        let mut loudness = Loudness::default();
        for (of_album, word) in [(false, "TRACK"), (true, "ALBUM")] {
            if let Some(text) = self.tag(stream, &format!("REPLAYGAIN_{word}_GAIN")) {
                loudness.replay_gain(of_album, &text);
            }
            if let Some(text) = self.tag(stream, &format!("R128_{word}_GAIN")) {
                loudness.r128(of_album, &text);
            }
        }
        loudness
    }
}

impl Format {
    pub(super) fn demuxer(&self) -> Option<Demuxer> {
        Demuxer::of_song(&self.format_name)
    }

    pub(super) fn name(&self) -> &str {
        if self.format_long_name.is_empty() { &self.format_name } else { &self.format_long_name }
    }
}

impl Stream {
    pub(super) fn is_known(&self) -> bool {
        self.codec_name.as_deref().is_some_and(|name| !["", "unknown", "none"].contains(&name))
    }

    pub(super) fn codec(&self) -> &str {
        self.codec_long_name.as_deref().or(self.codec_name.as_deref()).unwrap_or("an unknown codec")
    }

    /// Frames per second; 0 if ffprobe does not report them.
    pub(super) fn rate(&self) -> u32 {
        self.sample_rate.as_deref().and_then(|rate| rate.parse().ok()).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_may_lack_anything() {
        let answer: Answer = serde_json::from_str("{}").unwrap();
        assert!(answer.sound().is_none());
        let text = r#"{"streams": [{"codec_type": "video"}, {"codec_type": "audio", "index": 1},
            {"index": 2, "codec_type": "audio", "codec_name": "wmav2", "sample_rate": "44100", "channels": 2,
             "tags": {"Title": " ", "replaygain_track_gain": "-4 dB"}}],
            "format": {"duration": "inf", "format_name": "asf", "tags": {"TITLE": "Ebb"}}}"#;
        let answer: Answer = serde_json::from_str(text).unwrap();
        let stream = answer.sound().unwrap();
        assert_eq!((stream.index, stream.rate(), stream.channels), (2, 44_100, 2));
        assert_eq!((answer.duration(stream), answer.format.name(), stream.codec()), (None, "asf", "wmav2"));
        assert_eq!((answer.tag(stream, "title"), answer.tag(stream, "artist")), (None, None));
        assert!((answer.loudness(stream).scene_gain() - 1.0).abs() < 1e-6);
    }
}
