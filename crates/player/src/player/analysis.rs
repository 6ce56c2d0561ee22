//! The analysis thread: frames in, features into the timeline.

use std::sync::mpsc::Receiver;

use crate::timeline::SharedTimeline;
use crate::track::scale;
use mariana_music::{Alignment, Analyzer, Gain, StereoFrame, TimedFeatures};

/// What the decoding thread sends, in order.
pub(crate) enum AnalysisInput {
    /// A passage begins at the rate `sample_rate`; `position` is the index of the next frame in its track. Its samples
    /// count `gain` times.
    Begin { passage: u64, sample_rate: u32, position: u64, gain: f32 },
    /// The next frames.
    Frames(Vec<StereoFrame>),
    /// No more frames come in this passage.
    Finish,
}

/// Works until the decoding thread ends.
pub(crate) fn run(inbox: &Receiver<AnalysisInput>, sample_rate: u32, gain: Gain, timeline: &SharedTimeline) {
    let mut analyzer = Analyzer::with_gain(sample_rate, Alignment::Centred, gain);
    let (mut rate, mut factor) = (sample_rate, 1.0);
    let mut passage = 0;
    for input in inbox {
        let mut emit = |moment: &TimedFeatures| timeline.lock().push_features(passage, moment);
        match input {
            AnalysisInput::Begin { passage: next, sample_rate, position, gain: its } => {
                if sample_rate != rate {
                    analyzer = Analyzer::with_gain(sample_rate, Alignment::Centred, gain);
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
