//! A small picture of the scene that comes next, which is prepared already.
//!
//! It is drawn at the moment that shows. A scene whose tree of regions belongs to a moment is drawn at the moment of its
//! first tree instead: a tree for each small picture would cost more than the picture.

use super::{Cast, SceneStage};
use crate::app::scene_stage::hands::Stays;
use crate::frame::Frame;
use crate::gpu::error::GpuError;
use crate::gpu::picture_reader::PictureReader;
use crate::gpu::renderer::{Renderer, Sketch};
use crate::gpu::scene_program::Mode;
use crate::scenes::SceneSource;
use mariana_music::{Features, Sound};

impl SceneStage {
    /// The title of the scene that comes next, once it is known.
    pub(crate) fn next_title(&self) -> Option<String> {
        self.ahead.next_sources().find(|source| !is_blend(source)).map(SceneSource::title)
    }

    /// Draws the scene that comes next, where nobody sees it, and sends its picture to `reader`. Returns its title; none if
    /// there is nothing to draw now.
    ///
    /// # Errors
    /// What the driver refuses.
    pub(crate) fn preview(
        &mut self,
        renderer: &mut Renderer,
        sketch: &mut Sketch,
        reader: &mut PictureReader,
        (time, sound): (f64, Sound),
    ) -> Result<Option<String>, GpuError> {
        if !self.is_complete() {
            return Ok(None);
        }
        let cast = self.ahead.rehearsed().find(|cast| !is_blend(&cast.source));
        let Some((cast, mode)) = cast.and_then(|cast| Some((cast, self.mode_of(cast)?))) else {
            return Ok(None);
        };
        let Some(program) = cast.program(mode).cloned() else { return Ok(None) };
        let frame = self.frame_of_next(cast, mode, (time, sound), reader.size());
        let sent = renderer.sketch(sketch, &frame, (&cast.resources, &program), reader)?;
        Ok(sent.then(|| cast.source.title()))
    }

    fn frame_of_next(&self, cast: &Cast, mode: Mode, (time, sound): (f64, Sound), size: (u32, u32)) -> Frame {
        let world = cast.resources.world();
        if world.steep || mode == Mode::Interpreted {
            return Frame::new(world, 0.0, Features::SILENCE, size);
        }
        // Without a tree it is right at any moment.
        cast.resources.set_cells(false, mode);
        let params = self.numbers(cast, &Stays::default(), time);
        Frame::with_params(world, time, sound, size, &params)
    }
}

fn is_blend(source: &SceneSource) -> bool {
    matches!(source, SceneSource::Blend(_))
}
