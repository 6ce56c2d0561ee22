//! The analysis thread: frames in, features into the timeline.

use std::sync::mpsc::Receiver;

use crate::audio::timeline::SharedTimeline;
use crate::dsp::{Alignment, Analyzer, Gain, StereoFrame, TimedFeatures};

/// What the decoding thread sends, in order.
pub(crate) enum AnalysisInput {
    /// A segment begins; `position` is the index of the next frame in the song.
    Begin { segment: u64, position: u64 },
    /// The next frames at the source's rate.
    Frames(Vec<StereoFrame>),
    /// No more frames come in this segment.
    Finish,
}

/// Works until the decoding thread ends.
pub(crate) fn run(inbox: &Receiver<AnalysisInput>, sample_rate: u32, gain: Gain, timeline: &SharedTimeline) {
    let mut analyzer = Analyzer::with_gain(sample_rate, Alignment::Centred, gain);
    let mut segment = 0;
    for input in inbox {
        let mut emit = |moment: &TimedFeatures| timeline.lock().push_features(segment, moment);
        match input {
            AnalysisInput::Begin { segment: next, position } => {
                segment = next;
                analyzer.restart(position);
            }
            AnalysisInput::Frames(frames) => analyzer.push(&frames, &mut emit),
            AnalysisInput::Finish => analyzer.finish(&mut emit),
        }
    }
}
