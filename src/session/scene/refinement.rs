//! The refinement of a paused moment: the shown frame is drawn again by paths of light, in place, until something changes.

use std::time::Duration;

use super::kept::KeptPrograms;
use super::prepared_scene::PreparedScene;
use super::regions::Shown;
use crate::export::paths::PathChoice;
use crate::frame::Frame;
use crate::gpu::renderer::PathPicture;
use crate::gpu::{GpuError, Mode, PathOrder, PathSampling, Renderer};
use crate::limits;
use crate::session::drawing_pace::within_pixels;

#[derive(Default)]
pub(super) struct Refinement {
    stage: Stage,
    pub(super) programs: KeptPrograms,
}

#[derive(Default)]
enum Stage {
    #[default]
    Off,
    /// Waits for the program, and until the show is idle.
    Wanted,
    Going {
        of: Shown,
        picture: Box<PathPicture>,
        /// The number of paths of a pixel in the last message.
        said: u64,
    },
    Finished(Shown),
}

impl Refinement {
    pub(super) fn is_on(&self) -> bool {
        !matches!(self.stage, Stage::Off)
    }

    /// True if the refinement has not begun.
    pub(super) fn is_wanted(&self) -> bool {
        matches!(self.stage, Stage::Wanted)
    }

    /// True if a call of [`Self::resume`] may make the frame better.
    pub(super) fn is_unfinished(&self) -> bool {
        matches!(self.stage, Stage::Wanted | Stage::Going { .. })
    }

    pub(super) fn request(&mut self) {
        self.stage = Stage::Wanted;
    }

    pub(super) fn end(&mut self) {
        self.stage = Stage::Off;
    }

    /// Ends the refinement of any other frame than `wanted`.
    pub(super) fn end_of_others(&mut self, wanted: Shown) {
        if let Stage::Going { of, .. } | Stage::Finished(of) = &self.stage
            && *of != wanted
        {
            self.end();
        }
    }

    /// Continues for about `patience` with the frame that is shown as `of`. Returns true if the image has become better,
    /// and a message.
    pub(super) fn resume(
        &mut self,
        renderer: &mut Renderer,
        scene: &PreparedScene,
        mode: Mode,
        frame: &Frame,
        of: Shown,
        patience: Duration,
    ) -> Result<(bool, Option<String>), GpuError> {
        let wanted = scene.program_of(mode);
        let Some(program) = wanted.and_then(|wanted| self.programs.covering(&wanted)) else {
            return Ok((false, None));
        };
        if self.is_wanted() {
            let mut frame = frame.clone();
            frame.size = within_pixels(frame.size, limits::REFINED_PIXELS_MAX);
            let picture = Box::new(renderer.begin_paths(frame, order())?);
            self.stage = Stage::Going { of, picture, said: 0 };
        }
        let Stage::Going { picture, said, .. } = &mut self.stage else { return Ok((false, None)) };
        let progress = renderer.refine(picture, &scene.resources, &program, patience)?;
        let Some(progress) = progress else { return Ok((false, None)) };
        let paths = progress.paths / picture.pixels().max(1);
        if progress.fraction >= 1.0 {
            self.stage = Stage::Finished(of);
            return Ok((true, Some(format!("refined with {paths} paths for each pixel"))));
        }
        let says = paths >= 2 * *said && paths > 0;
        if says {
            *said = paths;
        }
        let words =
            || format!("refining: {paths} of at most {} paths for each pixel", limits::REFINED_PATHS_MAX);
        Ok((true, says.then(words)))
    }
}

fn order() -> PathOrder {
    PathOrder {
        samples: u32::from(limits::REFINED_PATHS_MAX),
        noise: PathChoice::NOISE,
        first: 0,
        sampling: PathSampling::Both,
        is_filtered: true,
    }
}
