//! The first draw of a scene, before it is shown: many drivers finish a program only then, and separately in each
//! context.

use std::time::Duration;

use super::Renderer;
use crate::frame::Frame;
use crate::gpu::error::GpuError;
use crate::gpu::program::Program;
use crate::gpu::scene_resources::SceneResources;
use crate::gpu::tiles::Costs;

impl Renderer {
    /// Draws a small picture that nobody sees, so that the driver has nothing left to make when the scene is shown,
    /// and the costs of its pixels are known. What was finished last stays. A picture that is being drawn would be
    /// lost.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn rehearse(
        &mut self,
        frame: &Frame,
        scene: &SceneResources,
        program: &Program,
    ) -> Result<(), GpuError> {
        let targets = self.targets.take();
        let stands = self.stands.take();
        let finished_light = self.finished_light.take();
        let (is_limited, timer, fade) = (self.is_limited, self.timer.take(), self.fade.take());
        let drawn = self.begin(frame, scene).and_then(|()| {
            // The driver's work is no cost of the scene.
            self.go_on_block(&scene.names(), (program, &Costs::default()), Duration::MAX)?;
            // As it is drawn while the scene before fades away.
            self.keep_light()?;
            self.set_fade(Some(0.5));
            self.draw(frame, scene, program)
        });
        self.making = None;
        (self.targets, self.stands, self.finished_light) = (targets, stands, finished_light);
        (self.is_limited, self.timer, self.fade) = (is_limited, timer, fade);
        drawn
    }
}
