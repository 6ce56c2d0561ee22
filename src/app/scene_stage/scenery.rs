//! The picture that shows, for those who ask what is in it.

use super::SceneStage;
use crate::app::probing::Scenery;
use crate::frame::camera::Camera;
use crate::gpu::scene_resources::RegionRequest;
use mariana_field::region::RegionOptions;

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

impl SceneStage {
    /// The picture that shows.
    ///
    /// # Errors
    /// There is none, or it shows two scenes.
    pub(crate) fn scenery(&self) -> Result<Scenery, NoScenery> {
        let (id, frame) = self.seen_frame.as_ref().ok_or(NoScenery::NoPicture)?;
        let cast = self.cast(*id).ok_or(NoScenery::NoPicture)?;
        let world = cast.resources.world();
        if world.blended.is_some() {
            return Err(NoScenery::Between);
        }
        let request = cast.resources.region_request(frame);
        let options = RegionOptions { cells: true, ..request.options };
        Ok(Scenery {
            source: cast.source.clone(),
            world: world.clone(),
            frame: frame.clone(),
            maker: cast.resources.region_maker(),
            request: RegionRequest { options, programs: Default::default(), ..request },
        })
    }

    /// From where the picture that shows is seen, if it shows one scene.
    pub(crate) fn seen_camera(&self) -> Option<Camera> {
        let (id, frame) = self.seen_frame.as_ref()?;
        let world = self.cast(*id)?.resources.world();
        world.blended.is_none().then_some(frame.camera)
    }

    /// How often the picture that shows was another one.
    pub(crate) fn pictures_seen(&self) -> u64 {
        self.pictures_seen
    }
}
