//! The analysis thread: frames in, features into the timeline.
//!
//! **Each track is analysed by itself.** The analysis begins anew with each track, as a passage of its own in the
//! timeline. So the picture of a moment of a track is the same whichever way it was reached, and bit for bit that of
//! `still` and `analyze`. A track that repeats is one passage, because its end and its start belong together for the
//! ear.

use std::sync::mpsc::Receiver;

use crate::audible_segments::SharedAudibleSegments;
use crate::gain_switch::GainSwitch;
use crate::track::scale;
use mariana_music::{Alignment, Analyzer, StereoFrame, TimedFeatures};

/// What the decoding thread sends, in order.
pub(crate) enum AnalysisInput {
    /// A passage begins at the rate `sample_rate`; `position` is the index of the next frame in its track. Its
    /// samples are multiplied by `gain`.
    Begin { passage: u64, sample_rate: u32, position: u64, gain: f32 },
    /// The next frames.
    Frames(Vec<StereoFrame>),
    /// No more frames come in this passage.
    Finish,
}

/// Works until the decoding thread ends.
pub(crate) fn run(
    inbox: &Receiver<AnalysisInput>,
    sample_rate: u32,
    gain: &GainSwitch,
    audible_segments: &SharedAudibleSegments,
) {
    let mut analyzer = Analyzer::with_gain(sample_rate, Alignment::Centred, gain.get());
    let (mut rate, mut factor) = (sample_rate, 1.0);
    let mut passage = 0;
    for input in inbox {
        analyzer.set_gain(gain.get());
        let mut emit = |moment: &TimedFeatures| audible_segments.lock().push_features(passage, moment);
        match input {
            AnalysisInput::Begin { passage: next, sample_rate, position, gain: its } => {
                if sample_rate != rate {
                    analyzer = Analyzer::with_gain(sample_rate, Alignment::Centred, gain.get());
                }
                (passage, rate, factor) = (next, sample_rate, its);
                analyzer.restart(position);
            }
            AnalysisInput::Frames(mut frames) => {
                scale(&mut frames, factor);
                analyzer.push(&frames, &mut emit);
            }
            AnalysisInput::Finish => analyzer.finish(&mut emit),
        }
    }
}
