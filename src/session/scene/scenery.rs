//! The picture that shows, for those who ask what is in it.

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

/// Why nobody can ask what is in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum NoScenery {
    /// There is none yet.
    #[error("there is no picture yet")]
    NoPicture,
    /// It is between two scenes.
    #[error("two scenes are mixed at the moment: ask again when the change is over")]
    Between,
}

/// What a picture shows, in whatever way it was drawn. It may outlive its scene.
pub(super) struct Pictured {
    source: SceneSource,
    world: Arc<World>,
    frame: Frame,
    maker: RegionMaker,
    options: RegionOptions,
}

impl Pictured {
    /// A picture of a scene.
    pub(super) fn of(scene: &PreparedScene, frame: Frame) -> Self {
        let resources = &scene.resources;
        let options = RegionOptions { cells: true, ..resources.region_options(&frame) };
        let (source, world, maker) =
            (scene.source.clone(), resources.world().clone(), resources.region_maker());
        Self { source, world, frame, maker, options }
    }
}

/// The pictures that were drawn: the one that shows, and how long the last ones took.
#[derive(Default)]
pub(crate) struct SeenPictures {
    /// The one that was begun last.
    begun: Option<Pictured>,
    /// The one that shows.
    seen: Option<Pictured>,
    count: u64,
    /// The scene of the one that shows.
    of: Option<u64>,
    /// How long that took, and the one before it.
    took: [Duration; 2],
}

impl SeenPictures {
    /// The picture that shows.
    ///
    /// # Errors
    /// There is none, or it shows two scenes.
    pub(crate) fn scenery(&self) -> Result<Scenery, NoScenery> {
        let Pictured { source, world, frame, maker, options } =
            self.seen.as_ref().ok_or(NoScenery::NoPicture)?;
        if world.blended.is_some() {
            return Err(NoScenery::Between);
        }
        Ok(Scenery {
            source: source.clone(),
            world: world.clone(),
            frame: frame.clone(),
            maker: maker.clone(),
            request: RegionRequest::of(&maker.plan, frame, *options),
        })
    }

    /// From where the picture that shows is seen, if it shows one scene.
    pub(crate) fn camera(&self) -> Option<Camera> {
        let picture = self.seen.as_ref()?;
        picture.world.blended.is_none().then_some(picture.frame.camera)
    }

    /// How often the picture that shows was another one.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Notes a picture that is begun.
    pub(super) fn begin(&mut self, picture: Pictured) {
        self.begun = Some(picture);
    }

    /// Notes that the picture is finished, of the scene `of`, and how long it took.
    pub(super) fn finish(&mut self, of: Option<u64>, took: Duration) {
        self.seen = self.begun.take();
        self.count += 1;
        self.of = of;
        self.took = [took, self.took[0]];
    }

    /// The scene whose picture was finished last.
    pub(super) fn scene(&self) -> Option<u64> {
        self.of
    }

    /// How long a picture takes, after the last two: a single one may have waited for a driver, or for the processors.
    pub(super) fn took(&self) -> Duration {
        self.took[0].min(self.took[1])
    }
}
