//! The picture that shows, for those who ask what is in it.

use std::sync::Arc;

use super::{Cast, SceneStage};
use crate::frame::Frame;
use crate::frame::camera::Camera;
use crate::gpu::scene_resources::{RegionMaker, RegionRequest};
use crate::scenes::SceneSource;
use mariana_field::region::RegionOptions;
use mariana_field::world::World;

/// A picture that can be asked about.
#[derive(Clone)]
pub(crate) struct Scenery {
    /// The scene.
    pub source: SceneSource,
    /// Its world.
    pub world: Arc<World>,
    /// The numbers of the picture, and its camera.
    pub frame: Frame,
    /// What builds its tree.
    pub maker: RegionMaker,
    /// What the tree is built for.
    pub request: RegionRequest,
}

/// Why nobody can be told what is in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum NoScenery {
    /// There is none yet.
    #[error("there is no picture yet")]
    NoPicture,
    /// It is between two scenes.
    #[error("two scenes are mixed at the moment: ask again when the change is over")]
    Between,
}

/// What a picture shows, in whatever way it was drawn. It may outlive its scene's place on the stage.
pub(super) struct Pictured {
    source: SceneSource,
    world: Arc<World>,
    frame: Frame,
    maker: RegionMaker,
    options: RegionOptions,
}

impl Pictured {
    /// A picture of a scene.
    pub(super) fn of(cast: &Cast, frame: Frame) -> Self {
        let resources = &cast.resources;
        let options = RegionOptions { cells: true, ..resources.region_options(&frame) };
        let (source, world, maker) =
            (cast.source.clone(), resources.world().clone(), resources.region_maker());
        Self { source, world, frame, maker, options }
    }
}

impl SceneStage {
    /// The picture that shows.
    ///
    /// # Errors
    /// There is none, or it shows two scenes.
    pub(crate) fn scenery(&self) -> Result<Scenery, NoScenery> {
        let Pictured { source, world, frame, maker, options } =
            self.seen_picture.as_ref().ok_or(NoScenery::NoPicture)?;
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
    pub(crate) fn seen_camera(&self) -> Option<Camera> {
        let picture = self.seen_picture.as_ref()?;
        picture.world.blended.is_none().then_some(picture.frame.camera)
    }

    /// How often the picture that shows was another one.
    pub(crate) fn pictures_seen(&self) -> u64 {
        self.pictures_seen
    }
}
