//! The neighbours: the next and the previous scene, prepared while the current one is shown, so that switching to them
//! takes one frame.
//!
//! Neighbours have the lowest priority: they are prepared one after another, when the current scene is complete and the
//! compilers are idle. Each neighbour has a loader, which reloads a changed text. When a neighbour is shown, it keeps
//! its loader. The previously shown scene becomes the neighbour on the other side and stays prepared.

use std::sync::Arc;

use super::library::SceneLoader;
use super::prepared_scene::{FirstTree, PreparedScene};
use super::program_task::ProgramOf;
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::gpu::{BuiltRegions, Mode, Renderer};
use crate::limits;
use crate::scenes::{Loaded, ReadyScene, SceneError, SceneSource};
use mariana_field::world::World;
use mariana_music::Features;

/// Size of the hidden trial frame: large enough to measure a pixel's cost and, like most windows, no power of two.
const REHEARSAL_SIZE: (u32, u32) = (90, 54);
/// Approximate size of a scene's program in bytes.
const PROGRAM_BYTES: u64 = 20 << 20;
/// Approximate bytes per texel of an image: the decoded image, and the GPU's copy with mip levels.
const TEXEL_BYTES: u64 = 15;

#[derive(Default)]
pub(super) struct PreparedAhead {
    /// The next and the previous scene; `None` if preparation is off.
    neighbours: Option<[Neighbour; 2]>,
    of: Option<WantedAhead>,
}

struct Neighbour {
    loader: SceneLoader,
    source: Option<SceneSource>,
    state: NeighbourState,
}

#[derive(Debug, PartialEq)]
pub(super) enum WantedAhead {
    Neighbours(SceneSource),
    Upcoming([Option<SceneSource>; 2]),
}

/// The missing part of a neighbour, to be prepared next.
pub(super) struct Lacking {
    pub id: u64,
    /// Mode of the missing program.
    pub program: Option<Mode>,
    /// True if the neighbour's first region tree is missing.
    pub tree: bool,
}

enum NeighbourState {
    Unasked,
    Loading,
    Loaded {
        scene: Box<PreparedScene>,
        has_asked: bool,
        is_rehearsed: bool,
    },
    /// Preparation failed or was abandoned; the scene is prepared only when the user or the show requests it.
    Left,
}

impl NeighbourState {
    fn loaded(scene: PreparedScene, is_rehearsed: bool) -> Self {
        Self::Loaded { scene: Box::new(scene), has_asked: is_rehearsed, is_rehearsed }
    }
}

impl PreparedAhead {
    /// Uses these loaders. `None` turns preparation off.
    pub(super) fn with(loaders: Option<[SceneLoader; 2]>) -> Self {
        let vacant = |loader| Neighbour { loader, source: None, state: NeighbourState::Unasked };
        Self { neighbours: loaders.map(|loaders| loaders.map(vacant)), of: None }
    }

    pub(super) fn into_loaders(self) -> Option<[SceneLoader; 2]> {
        self.neighbours.map(|neighbours| neighbours.map(|neighbour| neighbour.loader))
    }

    pub(super) fn is_on(&self) -> bool {
        self.neighbours.is_some()
    }

    fn all(&self) -> impl Iterator<Item = &Neighbour> {
        self.neighbours.iter().flatten()
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut Neighbour> {
        self.neighbours.iter_mut().flatten()
    }

    pub(super) fn scenes(&self) -> impl Iterator<Item = &PreparedScene> {
        self.all().filter_map(Neighbour::scene)
    }

    pub(super) fn scenes_mut(&mut self) -> impl Iterator<Item = &mut PreparedScene> {
        self.all_mut().filter_map(|neighbour| match &mut neighbour.state {
            NeighbourState::Loaded { scene, .. } => Some(&mut **scene),
            _ => None,
        })
    }

    /// Abandons the scenes that need a program: one scene for a compiled one, maybe several for an interpreter.
    pub(super) fn leave(&mut self, program: &ProgramOf) {
        self.leave_where(|scene| match program {
            ProgramOf::Compiled(id) => *id == scene.id,
            ProgramOf::Interpreted(variant) => scene.programs.lack(variant),
        });
    }

    fn leave_where(&mut self, is_left: impl Fn(&PreparedScene) -> bool) {
        for neighbour in self.all_mut() {
            if neighbour.scene().is_some_and(&is_left) {
                neighbour.state = NeighbourState::Left;
            }
        }
    }

    /// Stores the first tree of the scene `id`. If `tree` is `None`, abandons the scene.
    pub(super) fn receive_tree(&mut self, id: u64, tree: Option<Arc<BuiltRegions>>) {
        let Some(tree) = tree else { return self.leave_where(|scene| scene.id == id) };
        if let Some(scene) = self.scenes_mut().find(|scene| scene.id == id) {
            scene.resources.upload_regions(tree);
            scene.tree = FirstTree::There;
        }
    }

    /// Requests trees again, because a request for another scene drops earlier requests.
    pub(super) fn request_trees_again(&mut self) {
        for neighbour in self.all_mut() {
            if let NeighbourState::Loaded { scene, has_asked, .. } = &mut neighbour.state {
                *has_asked = scene.tree != FirstTree::Coming;
            }
        }
    }

    /// Keeps a scene that was shown, if it is a neighbour of the current one.
    pub(super) fn keep(&mut self, shown: PreparedScene) {
        let has_room = self.has_room_for(shown.resources.world());
        let waits = |neighbour: &&mut Neighbour| {
            neighbour.source.as_ref() == Some(&shown.source)
                && matches!(neighbour.state, NeighbourState::Unasked)
        };
        if let Some(neighbour) = self.all_mut().find(waits) {
            neighbour.state =
                if has_room { NeighbourState::loaded(shown, true) } else { NeighbourState::Left };
        }
    }

    /// Sets the scenes to prepare; keeps those already prepared. Returns `true` if the selection has changed.
    pub(super) fn request(
        &mut self,
        wanted: WantedAhead,
        neighbours_of: impl FnOnce(&SceneSource) -> [Option<SceneSource>; 2],
    ) -> bool {
        if self.neighbours.is_none() || self.of.as_ref() == Some(&wanted) {
            return false;
        }
        let sources = match &wanted {
            WantedAhead::Neighbours(of) => neighbours_of(of),
            WantedAhead::Upcoming(sources) => sources.clone(),
        };
        self.of = Some(wanted);
        self.request_sources(sources);
        true
    }

    fn request_sources(&mut self, wanted: [Option<SceneSource>; 2]) {
        let Some(neighbours) = &mut self.neighbours else { return };
        let has = |at: usize, neighbours: &[Neighbour; 2]| {
            neighbours[at].source.is_some() && neighbours[at].source == wanted[1 - at]
        };
        if has(0, neighbours) || has(1, neighbours) {
            neighbours.swap(0, 1);
        }
        for (neighbour, wanted) in neighbours.iter_mut().zip(wanted) {
            if neighbour.source != wanted {
                (neighbour.source, neighbour.state) = (wanted, NeighbourState::Unasked);
            }
        }
    }

    /// True if a source is prepared and was drawn once, so that the next frame can show it.
    pub(super) fn has_rehearsed(&self, source: &SceneSource) -> bool {
        self.rehearsed().any(|scene| scene.source == *source)
    }

    /// The prepared sources, the next scene first.
    pub(super) fn next_sources(&self) -> impl Iterator<Item = &SceneSource> {
        self.all().filter_map(|neighbour| neighbour.source.as_ref())
    }

    /// The scenes that were drawn once, the next scene first.
    pub(super) fn rehearsed(&self) -> impl Iterator<Item = &PreparedScene> {
        self.all().filter_map(|neighbour| match &neighbour.state {
            NeighbourState::Loaded { scene, is_rehearsed: true, .. } => Some(&**scene),
            _ => None,
        })
    }

    /// Removes and returns a scene that is prepared and was drawn once.
    pub(super) fn give(&mut self, source: &SceneSource) -> Option<PreparedScene> {
        let is_it = |neighbour: &&mut Neighbour| {
            matches!(&neighbour.state, NeighbourState::Loaded { scene, is_rehearsed: true, .. }
                if scene.source == *source)
        };
        let neighbour = self.all_mut().find(is_it)?;
        match std::mem::replace(&mut neighbour.state, NeighbourState::Unasked) {
            NeighbourState::Loaded { scene, .. } => Some(*scene),
            _ => None,
        }
    }

    pub(super) fn has_room_for(&self, world: &World) -> bool {
        let taken: u64 = self.scenes().map(|scene| bytes_of(scene.resources.world())).sum();
        taken + bytes_of(world) <= limits::PREPARED_BYTES_MAX
    }

    /// Returns the neighbour `to` if it is loaded or fading out. The shown scene `from` becomes the neighbour on the
    /// other side.
    pub(super) fn remove(
        &mut self,
        to: &SceneSource,
        from: SceneSource,
        loader: &mut SceneLoader,
        fading_out: &mut Option<PreparedScene>,
    ) -> Option<PreparedScene> {
        let neighbours = self.neighbours.as_mut()?;
        let neighbour = neighbours.iter_mut().find(|neighbour| neighbour.source.as_ref() == Some(to))?;
        let scene = match std::mem::replace(&mut neighbour.state, NeighbourState::Unasked) {
            NeighbourState::Loaded { scene, .. } => *scene,
            NeighbourState::Unasked => fading_out.take_if(|scene| scene.source == *to)?,
            other => {
                neighbour.state = other;
                return None;
            }
        };
        neighbour.source = Some(from);
        std::mem::swap(&mut neighbour.loader, loader);
        neighbours.swap(0, 1);
        Some(scene)
    }

    pub(super) fn poll(&self) -> Vec<(usize, Loaded<Result<ReadyScene, SceneError>>)> {
        let loaded = self.all().enumerate().filter_map(|(at, neighbour)| {
            let loaded = neighbour.loader.poll()?;
            (neighbour.source.as_ref() == Some(&loaded.source)).then_some((at, loaded))
        });
        loaded.collect()
    }

    /// Stores the loaded scene of the neighbour `at`; `None` abandons this neighbour.
    pub(super) fn put(&mut self, at: usize, scene: Option<PreparedScene>) {
        if let Some(neighbour) = self.all_mut().nth(at) {
            neighbour.state =
                scene.map_or(NeighbourState::Left, |scene| NeighbourState::loaded(scene, false));
        }
    }

    /// Continues with the first neighbour that is not ready: requests its scene, or returns what the scene lacks. Does
    /// not load a scene that is still `fading_out`.
    pub(super) fn prepare_next(
        &mut self,
        sdf: SdfChoice,
        fading_out: Option<&SceneSource>,
    ) -> Option<Lacking> {
        for neighbour in self.all_mut() {
            match &mut neighbour.state {
                NeighbourState::Left => continue,
                NeighbourState::Unasked
                    if fading_out.is_some() && neighbour.source.as_ref() == fading_out =>
                {
                    continue;
                }
                NeighbourState::Unasked => {
                    if let Some(source) = &neighbour.source {
                        neighbour.loader.request(source.clone());
                        neighbour.state = NeighbourState::Loading;
                    }
                }
                NeighbourState::Loaded { scene, has_asked, is_rehearsed } => {
                    let program = scene.missing_mode(sdf);
                    if *has_asked && program.is_none() && scene.tree != FirstTree::Coming && *is_rehearsed {
                        continue;
                    }
                    let tree = !std::mem::replace(has_asked, true);
                    return Some(Lacking { id: scene.id, program, tree });
                }
                NeighbourState::Loading => {}
            }
            break;
        }
        None
    }

    pub(super) fn rehearse(&mut self, sdf: SdfChoice, renderer: &mut Renderer) {
        for neighbour in self.all_mut() {
            let NeighbourState::Loaded { scene, is_rehearsed, .. } = &mut neighbour.state else { continue };
            let is_due =
                !*is_rehearsed && scene.tree != FirstTree::Coming && scene.missing_mode(sdf).is_none();
            let Some(program) = is_due.then(|| scene.wanted_mode(sdf)).and_then(|mode| scene.program(mode))
            else {
                continue;
            };
            let frame = Frame::new(scene.resources.world(), 0.0, Features::SILENCE, REHEARSAL_SIZE);
            *is_rehearsed = true;
            match renderer.rehearse(&frame, &scene.resources, program) {
                Ok(()) => tracing::info!("{} is ready ahead", scene.title()),
                Err(error) => {
                    tracing::info!("a scene is not prepared ahead: {error}");
                    neighbour.state = NeighbourState::Left;
                }
            }
            return;
        }
    }
}

impl Neighbour {
    fn scene(&self) -> Option<&PreparedScene> {
        match &self.state {
            NeighbourState::Loaded { scene, .. } => Some(scene),
            _ => None,
        }
    }
}

/// Approximate memory of a scene that can be drawn, in bytes.
fn bytes_of(world: &World) -> u64 {
    let texels =
        world.pictures.iter().map(|picture| u64::from(picture.width()) * u64::from(picture.height()));
    PROGRAM_BYTES + TEXEL_BYTES * texels.sum::<u64>()
}

#[cfg(test)]
mod tests {
    use mariana_testing::process::wait_until;

    use super::super::testing::{loader, text, uploaded};
    use super::*;
    use crate::gpu::headless::Headless;

    fn wanted(ahead: &mut PreparedAhead, sources: [&SceneSource; 2]) -> bool {
        let sources = sources.map(|source| Some(source.clone()));
        ahead.request(WantedAhead::Upcoming(sources), |_| [None, None])
    }

    fn loaded(ahead: &PreparedAhead) -> (usize, bool) {
        let mut found = Vec::new();
        wait_until("a neighbour", || {
            found = ahead.poll();
            !found.is_empty()
        });
        assert_eq!(found.len(), 1, "one at a time");
        found.first().map(|(at, loaded)| (*at, loaded.value.is_ok())).unwrap()
    }

    #[test]
    fn the_next_scene_is_prepared_before_the_previous_one_and_a_broken_scene_is_skipped() {
        let context = Headless::new(false).unwrap();
        let sdf = SdfChoice::Compiled;
        let [broken, ball, box_] = ["sphere(p", "sphere(p, 1)", "box(p, 1)"].map(text);
        let mut ahead = PreparedAhead::with(Some([loader(), loader()]));
        assert!(wanted(&mut ahead, [&broken, &ball]) && !wanted(&mut ahead, [&broken, &ball]));
        assert!(ahead.prepare_next(sdf, None).is_none(), "still loading");
        assert_eq!(loaded(&ahead), (0, false));
        ahead.put(0, None);
        assert!(ahead.prepare_next(sdf, None).is_none());
        assert_eq!(loaded(&ahead), (1, true));
        ahead.put(1, Some(uploaded(context.gl(), 7, &ball)));
        let lacking = ahead.prepare_next(sdf, None).unwrap();
        assert_eq!((lacking.id, lacking.program, lacking.tree), (7, Some(Mode::Compiled), true));
        assert!(!ahead.prepare_next(sdf, None).unwrap().tree, "already requested");
        assert!(!ahead.has_rehearsed(&ball) && ahead.give(&ball).is_none(), "not drawn yet");
        // The scene is now the next one, and stays prepared.
        assert!(wanted(&mut ahead, [&ball, &box_]));
        assert_eq!(ahead.scenes().map(|scene| scene.id).collect::<Vec<_>>(), [7]);
        assert_eq!(ahead.next_sources().next(), Some(&ball));
        // The tree of this scene is too slow, so the other scene is prepared.
        ahead.receive_tree(7, None);
        assert!(ahead.prepare_next(sdf, None).is_none() && ahead.scenes().next().is_none());
        assert_eq!(loaded(&ahead), (1, true));
    }

    #[test]
    fn the_scene_left_for_a_neighbour_stays_prepared() {
        let context = Headless::new(false).unwrap();
        let [ball, box_] = ["sphere(p, 1)", "box(p, 1)"].map(text);
        let mut ahead = PreparedAhead::with(Some([loader(), loader()]));
        wanted(&mut ahead, [&box_, &box_]);
        ahead.put(0, Some(uploaded(context.gl(), 1, &box_)));
        let mut shown = loader();
        let scene = ahead.remove(&box_, ball.clone(), &mut shown, &mut None).unwrap();
        assert_eq!(scene.id, 1);
        // The previously shown scene is now a neighbour, ready to be shown again.
        ahead.keep(uploaded(context.gl(), 0, &ball));
        assert!(ahead.has_rehearsed(&ball));
        assert_eq!(ahead.remove(&ball, box_, &mut shown, &mut None).map(|scene| scene.id), Some(0));
    }
}
