//! The answer of `ffprobe` about a file.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use serde::Deserialize;

use super::CommandLine;
use super::process::{Failure, Process};
use crate::decode::loudness::Loudness;
use crate::limits;

/// Maximum size of an answer in bytes. The answers contain no cover images.
const ANSWER_MAX: usize = 1 << 20;

type Tags = BTreeMap<String, String>;

/// An answer of `ffprobe`. Every field may be missing.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Answer {
    pub(crate) format: Format,
    pub(crate) streams: Vec<Stream>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Format {
    pub(crate) format_name: String,
    duration: Option<String>,
    tags: Tags,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct Stream {
    pub(crate) index: u32,
    codec_type: String,
    codec_name: Option<String>,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) avg_frame_rate: String,
    pub(crate) r_frame_rate: String,
    pub(crate) nb_read_packets: Option<String>,
    sample_rate: Option<String>,
    pub(crate) channels: usize,
    pub(crate) channel_layout: String,
    duration: Option<String>,
    tags: Tags,
}

impl Answer {
    /// Runs ffprobe, and reads its answer about the entries of the file at `path`.
    pub(crate) fn of(
        ffprobe: CommandLine,
        entries: &str,
        patience: Duration,
        path: &Path,
    ) -> Result<Self, Failure> {
        let line = ffprobe.options(["-show_entries", entries, "-of", "json"]);
        let mut process = Process::start(line, patience)?;
        let answer = process.all(ANSWER_MAX)?;
        if !process.succeeded() {
            return Err(process.refusal(path));
        }
        // ffprobe's output is well-formed for any file.
        let malformed = |error| format!("ffprobe's answer about it is malformed ({error})");
        serde_json::from_slice(&answer).map_err(|error| Failure::Useless(malformed(error)))
    }

    pub(crate) fn sound(&self) -> Option<&Stream> {
        let mut sounds = self.streams.iter().filter(|stream| stream.codec_type == "audio");
        // Prefer a stream that can be decoded.
        let first = sounds.clone().next();
        sounds.find(|stream| stream.is_known()).or(first)
    }

    /// The length of the stream in seconds, if ffprobe reports a length.
    pub(crate) fn duration(&self, stream: &Stream) -> Option<f64> {
        let reported = [&stream.duration, &self.format.duration].into_iter().flatten();
        let reported = reported.filter_map(|seconds| seconds.parse::<f64>().ok());
        let clock = stream.tags.get("DURATION").filter(|text| text.contains(':'));
        let tagged = clock.and_then(|text| clock_seconds(text));
        let mut all = reported.chain(tagged);
        all.find(|seconds| *seconds > 0.0 && *seconds <= limits::CLAIMED_DURATION_MAX)
    }

    pub(crate) fn tag(&self, stream: &Stream, name: &str) -> Option<String> {
        let in_tags = |tags: &Tags| {
            tags.iter().find(|(key, _)| key.eq_ignore_ascii_case(name)).map(|(_, tag)| tag.clone())
        };
        in_tags(&stream.tags).or_else(|| in_tags(&self.format.tags)).filter(|tag| !tag.trim().is_empty())
    }

    pub(crate) fn loudness(&self, stream: &Stream) -> Loudness {
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

impl Stream {
    pub(crate) fn is_known(&self) -> bool {
        self.codec_name.as_deref().is_some_and(|name| !["", "unknown", "none"].contains(&name))
    }

    /// Frames per second; 0 if ffprobe does not report them.
    pub(crate) fn rate(&self) -> u32 {
        self.sample_rate.as_deref().and_then(|rate| rate.parse().ok()).unwrap_or(0)
    }
}

/// The seconds of `hours:minutes:seconds`.
fn clock_seconds(text: &str) -> Option<f64> {
    text.split(':').try_fold(0.0, |sum, part| Some(60.0 * sum + part.trim().parse::<f64>().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_may_be_missing_or_absurd() {
        let seconds = |text: &str| {
            let answer: Answer = serde_json::from_str(text).unwrap();
            answer.duration(&answer.streams[0])
        };
        assert_eq!(seconds(r#"{"streams": [{"duration": "3.5"}]}"#), Some(3.5));
        assert_eq!(seconds(r#"{"streams": [{"duration": "-1"}], "format": {"duration": "2"}}"#), Some(2.0));
        assert_eq!(seconds(r#"{"streams": [{"tags": {"DURATION": "00:01:02.500000"}}]}"#), Some(62.5));
        for text in ["{}", r#"{"duration": "nan"}"#, r#"{"duration": "1e99"}"#, r#"{"duration": "inf"}"#] {
            assert_eq!(seconds(&format!(r#"{{"streams": [{text}]}}"#)), None, "{text}");
        }
    }

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
        assert_eq!((answer.duration(stream), &*answer.format.format_name), (None, "asf"));
        assert_eq!((answer.tag(stream, "title"), answer.tag(stream, "artist")), (None, None));
        assert!((answer.loudness(stream).scene_gain() - 1.0).abs() < 1e-6);
    }
}
