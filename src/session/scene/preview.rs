//! A small preview frame of the next scene, which is already prepared.
//!
//! The preview shows the current moment of the song. A scene that needs a region tree for each
//! moment is first drawn at the moment of its first tree, and then about once a second with a tree
//! built on a thread. If such a build would slow down the show, the preview stays still.

use std::time::{Duration, Instant};

use super::active_clips::ActiveClips;
use super::composer::Ingredients;
use super::prepared_scene::PreparedScene;
use super::region_builder::{BuiltTree, RegionBuilder, TreeJob};
use crate::clock;
use crate::frame::Frame;
use crate::gpu::{CellUse, GpuError, Mode, PictureReader, Renderer, Sketch};
use mariana_music::{Features, Sound};

/// Interval of previews that need their own tree.
const TREE_EVERY: Duration = Duration::from_secs(1);
/// Time limit for building a tree for a preview.
const TREE_PATIENCE: Duration = Duration::from_millis(150);

pub(super) struct NextPicture {
    asked: Option<(u64, Instant)>,
    too_expensive: Option<u64>,
    builder: RegionBuilder<u64>,
}

impl NextPicture {
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        Ok(Self { asked: None, too_expensive: None, builder: RegionBuilder::start(wake)? })
    }

    /// Draws a hidden frame of the next scene with the values of `parameters` at `time` seconds of the song, and
    /// sends it to `reader`. Returns the scene's title if a frame was drawn.
    pub(super) fn draw(
        &mut self,
        of: Ingredients<'_>,
        renderer: &mut Renderer,
        sketch: &mut Sketch,
        reader: &mut PictureReader,
        time: f64,
        sound: Sound,
    ) -> Result<Option<String>, GpuError> {
        let Ingredients { scenes, parameters, choice, .. } = of;
        let scene = scenes.ahead.rehearsed().find(|scene| !scene.is_blend());
        let Some((scene, mode)) = scene.and_then(|scene| Some((scene, scene.mode(choice.sdf)?))) else {
            return Ok(None);
        };
        let Some(program) = scene.program(mode) else { return Ok(None) };
        let id = scene.id;
        let mut came = None;
        while let Some(BuiltTree { tag, frame, regions }) = self.builder.poll() {
            match regions {
                Some(regions) if tag == id => came = Some((frame, regions)),
                Some(_) => {}
                None => self.too_expensive = Some(tag),
            }
        }
        let frame = match came {
            Some((frame, regions)) => {
                scene.resources.upload_regions(regions);
                Some(frame)
            }
            None => {
                let params = parameters.numbers(scene, &ActiveClips::default(), time);
                let world = scene.resources.world();
                let frame = Frame::with_params(world, time, sound, reader.size(), &params);
                self.drawable(scene, mode, choice.cells, frame)
            }
        };
        let Some(frame) = frame else { return Ok(None) };
        let sent = renderer.sketch(sketch, &frame, &scene.resources, program, reader)?;
        Ok(sent.then(|| scene.title()))
    }

    /// Returns the frame if it needs no new tree, or once the frame of the scene's first tree. Otherwise, requests the
    /// frame's tree.
    fn drawable(&mut self, scene: &PreparedScene, mode: Mode, cells: CellUse, frame: Frame) -> Option<Frame> {
        let (id, world) = (scene.id, scene.resources.world());
        let needs_tree = world.non_lipschitz || mode == Mode::Interpreted;
        if needs_tree && self.asked.is_none_or(|(of, _)| of != id) {
            let first = Frame::new(world, 0.0, Features::SILENCE, frame.size);
            let request = scene.resources.region_request(&first);
            if scene.resources.regions().is_some_and(|built| built.request == request) {
                // The next preview follows in a second.
                self.asked = Some((id, clock::now()));
                return Some(first);
            }
        }
        // Without a tree, a frame can be drawn at any moment.
        let uses_cells = needs_tree && (world.non_lipschitz || cells != CellUse::Never);
        scene.resources.set_cells(uses_cells, mode);
        if !needs_tree {
            return Some(frame);
        }
        if self.asks(id, clock::now()) {
            let (request, maker) = (scene.resources.region_request(&frame), scene.resources.region_maker());
            self.builder.request(TreeJob { tag: id, frame, maker, request, patience: TREE_PATIENCE });
        }
        None
    }

    fn asks(&mut self, id: u64, now: Instant) -> bool {
        let has_just =
            self.asked.is_some_and(|(of, at)| of == id && now.saturating_duration_since(at) < TREE_EVERY);
        let asks = !has_just && self.too_expensive != Some(id);
        if asks {
            self.asked = Some((id, now));
        }
        asks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_are_requested_once_a_second_unless_they_take_too_long() {
        let (mut sketching, now) = (NextPicture::start(|| {}).unwrap(), Instant::now());
        let at = |ms| now + Duration::from_millis(ms);
        assert!(sketching.asks(7, at(0)) && !sketching.asks(7, at(900)) && sketching.asks(7, at(1_000)));
        assert!(sketching.asks(8, at(1_100)), "another scene comes next");
        sketching.too_expensive = Some(8);
        assert!(!sketching.asks(8, at(9_000)) && sketching.asks(7, at(9_100)));
    }
}
