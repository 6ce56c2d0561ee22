//! The contents of the shown frame, for queries by the editor.

use std::time::Duration;

use super::prepared_scene::PreparedScene;
use crate::frame::Frame;
use crate::frame::camera::Camera;
use crate::probing::Scenery;
use mariana_field::region::RegionOptions;

/// The contents of a frame, independent of its drawing mode. They may be kept longer than the scene.
pub(super) fn scenery_of(scene: &PreparedScene, frame: Frame) -> Scenery {
    let resources = &scene.resources;
    let options = RegionOptions { cells: true, ..resources.region_options(&frame) };
    let (world, maker) = (resources.world().clone(), resources.region_maker());
    Scenery { source: scene.source.clone(), world, frame, maker, options }
}

#[derive(Default)]
pub(crate) struct SeenPictures {
    begun: Option<Scenery>,
    seen: Option<Scenery>,
    pub(crate) count: u64,
    pub(super) scene: Option<u64>,
    /// Times of the last two frames, the newest first.
    took: [Duration; 2],
}

impl SeenPictures {
    /// The contents of the shown frame.
    ///
    /// # Errors
    /// Fails if no frame is shown, or if the frame shows two scenes.
    pub(crate) fn scenery(&self) -> Result<Scenery, &'static str> {
        let seen = self.seen.as_ref().ok_or("no frame has been drawn yet")?;
        if seen.world.blended.is_some() {
            return Err("two scenes are fading: try again after the fade");
        }
        Ok(seen.clone())
    }

    pub(crate) fn camera(&self) -> Option<Camera> {
        let picture = self.seen.as_ref()?;
        let is_flat = picture.frame.projection.is_plain();
        (is_flat && picture.world.blended.is_none()).then_some(picture.frame.camera)
    }

    /// The inputs of the shown frame.
    pub(super) fn frame(&self) -> Option<&Frame> {
        self.seen.as_ref().map(|picture| &picture.frame)
    }

    pub(super) fn begin(&mut self, picture: Scenery) {
        self.begun = Some(picture);
    }

    pub(super) fn finish(&mut self, scene: u64, took: Duration) {
        self.seen = self.begun.take();
        self.count += 1;
        self.scene = Some(scene);
        self.took = [took, self.took[0]];
    }

    /// The shorter of the last two frame times: a single frame may have waited for the driver or the processors.
    pub(super) fn took(&self) -> Duration {
        self.took[0].min(self.took[1])
    }
}
