//! A small picture of the scene that comes next, which is prepared already.
//!
//! It is drawn at the moment that shows. A scene whose tree of regions belongs to a moment is drawn at the moment of its
//! first tree at first, and then about once a second: a thread builds a tree for each such picture, unless that takes so
//! long that the show would feel it. Then the picture stands still.

use std::time::{Duration, Instant};

use super::hands::Stays;
use super::{Cast, SceneStage};
use crate::frame::Frame;
use crate::gpu::cell_use::CellUse;
use crate::gpu::error::GpuError;
use crate::gpu::picture_reader::PictureReader;
use crate::gpu::renderer::{Renderer, Sketch};
use crate::gpu::scene_program::Mode;
use crate::scenes::SceneSource;
use mariana_music::{Features, Sound};

/// How often a picture is drawn that needs a tree of its own.
const TREE_EVERY: Duration = Duration::from_secs(1);
/// How long such a tree may take.
const TREE_PATIENCE: Duration = Duration::from_millis(150);

/// What is known of trees for these pictures.
#[derive(Default)]
pub(super) struct Sketching {
    /// The scene for which one was requested last, and when.
    asked: Option<(u64, Instant)>,
    /// The scene whose trees take too long.
    too_dear: Option<u64>,
}

impl Sketching {
    /// Whether a tree is to be requested for a scene now; then it is noted.
    fn asks(&mut self, id: u64, now: Instant) -> bool {
        let has_just =
            self.asked.is_some_and(|(of, at)| of == id && now.saturating_duration_since(at) < TREE_EVERY);
        let asks = !has_just && self.too_dear != Some(id);
        if asks {
            self.asked = Some((id, now));
        }
        asks
    }
}

/// A frame of the scene that comes next.
enum Next {
    /// It can be drawn.
    Now(Frame),
    /// It is that of the scene's first tree, which is there.
    First(Frame),
    /// Its tree is needed first.
    WithTree(Frame),
}

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
        let (id, title) = (cast.id, cast.source.title());
        let mut came = None;
        while let Some((of, frame, regions)) = self.regions.sketched_tree() {
            match regions {
                Some(regions) if of == id => came = Some((frame, regions)),
                Some(_) => {}
                None => self.sketching.too_dear = Some(of),
            }
        }
        let Some(cast) = self.ahead.rehearsed().find(|cast| cast.id == id) else { return Ok(None) };
        let frame = match came {
            Some((frame, regions)) => {
                cast.resources.take_regions(regions);
                frame
            }
            None => match self.frame_of_next(cast, mode, (time, sound), reader.size()) {
                Next::Now(frame) => frame,
                Next::First(frame) => {
                    // The next one in a second.
                    self.sketching.asked = Some((id, Instant::now()));
                    frame
                }
                Next::WithTree(frame) => {
                    if self.sketching.asks(id, Instant::now()) {
                        self.regions.sketch_tree(id, &cast.resources, frame, TREE_PATIENCE);
                    }
                    return Ok(None);
                }
            },
        };
        let sent = renderer.sketch(sketch, &frame, (&cast.resources, &program), reader)?;
        Ok(sent.then_some(title))
    }

    fn frame_of_next(&self, cast: &Cast, mode: Mode, (time, sound): (f64, Sound), size: (u32, u32)) -> Next {
        let world = cast.resources.world();
        let needs_tree = world.steep || mode == Mode::Interpreted;
        if needs_tree && self.sketching.asked.is_none_or(|(of, _)| of != cast.id) {
            let first = Frame::new(world, 0.0, Features::SILENCE, size);
            let request = cast.resources.region_request(&first);
            if cast.resources.regions().is_some_and(|built| built.request == request) {
                return Next::First(first);
            }
        }
        // Without a tree it is right at any moment.
        let cells = needs_tree && (world.steep || self.regions.wish() != CellUse::Never);
        cast.resources.set_cells(cells, mode);
        let params = self.numbers(cast, &Stays::default(), time);
        let frame = Frame::with_params(world, time, sound, size, &params);
        if needs_tree { Next::WithTree(frame) } else { Next::Now(frame) }
    }
}

fn is_blend(source: &SceneSource) -> bool {
    matches!(source, SceneSource::Blend(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_are_requested_once_a_second_and_not_again_where_they_take_too_long() {
        let (mut sketching, now) = (Sketching::default(), Instant::now());
        let at = |ms| now + Duration::from_millis(ms);
        assert!(sketching.asks(7, at(0)) && !sketching.asks(7, at(900)) && sketching.asks(7, at(1_000)));
        assert!(sketching.asks(8, at(1_100)), "another scene comes next");
        sketching.too_dear = Some(8);
        assert!(!sketching.asks(8, at(9_000)) && sketching.asks(7, at(9_100)));
    }
}
