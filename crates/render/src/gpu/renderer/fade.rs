//! One picture fades into the next: a share of light that was kept is mixed into what is drawn, before the tone map.

use super::{Renderer, Target, Texel};
use crate::gpu::error::GpuError;

/// Light that fades away.
pub(super) struct Fade {
    light: Target,
    share: f32,
}

impl Fade {
    /// The kept light, and its share of the picture.
    pub(super) fn mixed_in(&self) -> (&Target, f32) {
        (&self.light, self.share)
    }
}

impl Renderer {
    /// Keeps the light of the picture that was finished last, to be mixed into the next ones. Returns whether there
    /// is any: a view has none, nor has a picture whose targets have gone.
    ///
    /// # Errors
    /// No room for it.
    pub fn keep_light(&mut self) -> Result<bool, GpuError> {
        let old = self.fade.take().map(|fade| fade.light);
        self.fade = self.exposed(old)?.map(|light| Fade { light, share: 1.0 });
        Ok(self.fade.is_some())
    }

    /// The light of the picture that was finished last, exposed and linear: four numbers per pixel, the top row first.
    /// Empty for a view.
    ///
    /// # Errors
    /// No room for it.
    pub fn read_light(&self) -> Result<Vec<f32>, GpuError> {
        Ok(self.exposed(None)?.map_or_else(Vec::new, |light| light.read_rgba32f(0)))
    }

    /// That light, in `room` if it has the same size.
    fn exposed(&self, room: Option<Target>) -> Result<Option<Target>, GpuError> {
        let (Some(picture), Some(targets)) = (&self.finished_light, &self.targets) else { return Ok(None) };
        let light = match room.filter(|room| room.size() == targets.first.size()) {
            Some(room) => room,
            None => Target::new(&self.gl, targets.first.size(), &[Texel::Rgba16F], None)?.smooth(),
        };
        self.prepare_passes();
        self.post.bind_picture(picture, self.edge_samples);
        self.post.expose(&targets.post, picture, &targets.first, &light)?;
        self.gl.check("keeping a picture's light").map(|()| Some(light))
    }

    /// From now on this share of finished pictures, 0..1, is the light that was kept. Without a share it is
    /// forgotten.
    pub fn set_fade(&mut self, share: Option<f32>) {
        match (share, &mut self.fade) {
            (Some(share), Some(fade)) => fade.share = share.clamp(0.0, 1.0),
            _ => self.fade = None,
        }
    }
}
