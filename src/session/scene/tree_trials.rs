//! Builds the first trees of new scenes. The build time shows whether a scene is fast enough to be drawn.

use std::sync::Arc;

use super::region_builder::{RegionBuilder, TreeJob};
use super::regions::longest_wait;
use crate::frame::Frame;
use crate::gpu::{BuiltRegions, CellUse, Mode, SceneResources};
use mariana_music::Features;

/// Size of the frame for a scene's first tree. Only its aspect ratio matters.
const TRIAL_SIZE: (u32, u32) = (16, 9);

pub(super) struct TreeTrials(RegionBuilder<u64>);

impl TreeTrials {
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        RegionBuilder::start(wake).map(Self)
    }

    /// Requests the first tree of the scene `id`. Replaces the request for any other scene.
    pub(super) fn request(&self, id: u64, scene: &SceneResources, cells: CellUse) {
        scene.set_cells(cells != CellUse::Never || scene.world().non_lipschitz, Mode::Interpreted);
        let frame = Frame::new(scene.world(), 0.0, Features::SILENCE, TRIAL_SIZE);
        let request = scene.region_request(&frame);
        self.0.forget();
        let (maker, patience) = (scene.region_maker(), longest_wait());
        self.0.request(TreeJob { tag: id, frame, maker, request, patience });
    }

    /// A finished tree and its scene. The tree is `None` if the build exceeded the time limit.
    pub(super) fn poll(&self) -> Option<(u64, Option<Arc<BuiltRegions>>)> {
        self.0.poll().map(|built| (built.tag, built.regions))
    }
}
