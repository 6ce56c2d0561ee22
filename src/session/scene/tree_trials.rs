//! The first trees of scenes that are coming: they show whether a scene can be drawn in time.

use std::sync::Arc;

use super::region_builder::{RegionBuilder, TreeJob};
use super::regions::longest_wait;
use crate::frame::Frame;
use crate::gpu::cell_use::CellUse;
use crate::gpu::scene_program::Mode;
use crate::gpu::scene_resources::{BuiltRegions, SceneResources};
use mariana_music::Features;

/// Size of the picture for which a scene's first tree is built; only its shape matters.
const TRIAL_SIZE: (u32, u32) = (16, 9);

/// See the module.
pub(super) struct TreeTrials(RegionBuilder<u64>);

impl TreeTrials {
    /// Starts the thread, which calls `wake` after each tree.
    ///
    /// # Errors
    /// What the system says about threads.
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        RegionBuilder::start(wake).map(Self)
    }

    /// Requests the first tree of the scene `id`, in place of any other scene's.
    pub(super) fn request(&self, id: u64, scene: &SceneResources, cells: CellUse) {
        scene.set_cells(cells != CellUse::Never || scene.world().non_lipschitz, Mode::Interpreted);
        let frame = Frame::new(scene.world(), 0.0, Features::SILENCE, TRIAL_SIZE);
        let request = scene.region_request(&frame);
        self.0.forget();
        let (maker, patience) = (scene.region_maker(), longest_wait());
        self.0.request(TreeJob { tag: id, frame, maker, request, patience });
    }

    /// A tree that was requested, and its scene; no tree if it takes longer than anyone waits.
    pub(super) fn poll(&self) -> Option<(u64, Option<Arc<BuiltRegions>>)> {
        self.0.poll().map(|built| (built.tag, built.regions))
    }
}
