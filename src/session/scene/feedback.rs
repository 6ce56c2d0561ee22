//! The pace at which the window draws frames of feedback. In a running scene it draws new frames at once. After a seek or
//! a change of scenes it draws a few missing frames with each image.

use std::time::Duration;

use super::prepared_scene::PreparedScene;
use crate::clock;
use crate::frame::Frame;
use crate::gpu::{FeedbackRequest, GpuError, Program, Renderer};

/// Maximum number of frames of feedback before an image: those of two histories of ten seconds take less than two
/// seconds at 60 images a second.
const FRAMES_MAX: usize = 16;
/// Time after which an image does not wait for further frames of feedback.
const PATIENCE: Duration = Duration::from_millis(12);
/// If more frames are missing than this and drawing does not catch up, the missing frames are left out.
const MISSING_MAX: u64 = 20;

#[derive(Default)]
pub(super) struct FeedbackPace {
    /// The scene, and the number of frames that its last image lacked.
    last: Option<(u64, u64)>,
    pub(crate) is_incomplete: bool,
}

impl FeedbackPace {
    /// Draws frames of feedback for an image of a scene at `time`: those that `next` requests, until it returns
    /// `None`. `frame_at` returns the frames.
    pub(super) fn draw(
        &mut self,
        renderer: &mut Renderer,
        scene: &PreparedScene,
        program: &Program,
        time: f64,
        next: &dyn Fn(&mut Renderer) -> Option<FeedbackRequest>,
        frame_at: &dyn Fn(f64) -> Frame,
    ) -> Result<(), GpuError> {
        let (id, scene) = (scene.id, &scene.resources);
        let begun = clock::now();
        for _ in 0..FRAMES_MAX {
            let Some(request) = next(renderer) else { break };
            let mut frame = frame_at(request.time);
            frame.size = request.size;
            renderer.draw_feedback(&request, &frame, scene, program)?;
            if clock::since(begun) > PATIENCE {
                break;
            }
        }
        let missing = scene.missing_feedback(time);
        // The first image after a seek may lack many frames.
        let lacked = self.last.filter(|(last, _)| *last == id).map_or(0, |(_, lacked)| lacked);
        if lacked > MISSING_MAX && missing >= lacked {
            scene.skip_feedback(time);
        }
        self.last = Some((id, missing));
        self.is_incomplete |= missing > 0;
        renderer.show_feedback(scene, time)
    }
}
