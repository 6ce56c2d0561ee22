//! The contents of the shown frame, for queries by the editor.

use std::sync::Arc;
use std::time::Duration;

use super::prepared_scene::PreparedScene;
use crate::frame::Frame;
use crate::frame::camera::Camera;
use crate::gpu::scene_resources::{RegionMaker, RegionRequest};
use crate::probing::Scenery;
use crate::scenes::SceneSource;
use mariana_field::region::RegionOptions;
use mariana_field::world::World;

/// The inputs of a frame, independent of its drawing mode. They may be kept longer than the scene.
pub(super) struct Pictured {
    source: SceneSource,
    world: Arc<World>,
    frame: Frame,
    maker: RegionMaker,
    options: RegionOptions,
}

impl Pictured {
    pub(super) fn of(scene: &PreparedScene, frame: Frame) -> Self {
        let resources = &scene.resources;
        let options = RegionOptions { cells: true, ..resources.region_options(&frame) };
        let (source, world, maker) =
            (scene.source.clone(), resources.world().clone(), resources.region_maker());
        Self { source, world, frame, maker, options }
    }
}

#[derive(Default)]
pub(crate) struct SeenPictures {
    begun: Option<Pictured>,
    seen: Option<Pictured>,
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
        let Pictured { source, world, frame, maker, options } =
            self.seen.as_ref().ok_or("no frame has been drawn yet")?;
        if world.blended.is_some() {
            return Err("two scenes are fading: try again after the fade");
        }
        Ok(Scenery {
            source: source.clone(),
            world: world.clone(),
            frame: frame.clone(),
            maker: maker.clone(),
            request: RegionRequest::of(&maker.plan, &maker.buffers, frame, *options),
        })
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

    pub(super) fn begin(&mut self, picture: Pictured) {
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
