//! The analysis thread computes features of frames and stores them in the [`SharedAudibleSegments`]. **Each track is
//! analysed separately**, as its own passage. So a moment of a track always yields the same image as in `still` and
//! `analyze`, no matter how playback reached the moment. A repeated track is one passage, because listeners hear it as
//! connected.

use std::sync::mpsc::Receiver;

use crate::audible_segments::SharedAudibleSegments;
use crate::gain_switch::GainSwitch;
use crate::track::scale;
use mariana_music::{Alignment, Analyzer, StereoFrame, TimedFeatures};

pub(crate) enum AnalysisInput {
    /// Begins a passage. `position` is the next frame's index in the track; samples are multiplied by `gain`.
    Begin {
        passage: u64,
        sample_rate: u32,
        position: u64,
        gain: f32,
    },
    Frames(Vec<StereoFrame>),
    Finish,
}

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
