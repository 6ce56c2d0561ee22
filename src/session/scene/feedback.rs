//! The pace at which the window draws frames of feedback. In a running scene it draws new frames at once. After a seek or
//! a change of scenes it draws a few missing frames with each image.

use std::time::Duration;

use crate::gpu::SceneResources;

/// Maximum number of frames of feedback before an image: those of two histories of ten seconds take less than two
/// seconds at 60 images a second.
pub(super) const FRAMES_MAX: usize = 16;
/// Time after which an image does not wait for further frames of feedback.
pub(super) const PATIENCE: Duration = Duration::from_millis(12);
/// If more frames are missing than this and drawing does not catch up, the missing frames are left out.
const MISSING_MAX: u64 = 20;

#[derive(Default)]
pub(super) struct FeedbackPace {
    /// The scene, and the number of frames that its last image lacked.
    last: Option<(u64, u64)>,
    pub(crate) is_incomplete: bool,
}

impl FeedbackPace {
    /// Notes how many frames the image of a scene at `time` lacks.
    pub(super) fn record(&mut self, id: u64, scene: &SceneResources, time: f64) {
        let missing = scene.missing_feedback(time);
        // The first image after a seek may lack many frames.
        let lacked = self.last.filter(|(last, _)| *last == id).map_or(0, |(_, lacked)| lacked);
        if lacked > MISSING_MAX && missing >= lacked {
            scene.skip_feedback(time);
        }
        self.last = Some((id, missing));
        self.is_incomplete |= missing > 0;
    }
}
