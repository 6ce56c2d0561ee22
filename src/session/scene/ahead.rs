//! The next and the previous scene, prepared while the present one is shown, so that a change to them takes one
//! picture.
//!
//! They come after everything else: one at a time, when the present scene is complete and the compilers have nothing
//! to do. Each has a loader of its own, which watches its files, so what is prepared is as new as the files. A scene
//! that is gone to takes its loader along; the one that was shown stays prepared on the other side.

use super::{Cast, FirstTree, SceneLoader, SceneStage, Task};
use crate::config::SdfChoice;
use crate::frame::Frame;
use crate::gpu::renderer::Renderer;
use crate::gpu::scene_program::Mode;
use crate::limits::LIMITS;
use crate::scenes::{ReadyScene, SceneSource};
use mariana_field::world::World;
use mariana_music::Features;

/// Size of the picture that nobody sees: no power of two, because those of windows are none either, and large enough
/// to tell what a pixel costs.
const REHEARSAL_SIZE: (u32, u32) = (90, 54);
/// Approximate bytes of a scene's program.
const PROGRAM_BYTES: u64 = 20 << 20;
/// Approximate bytes of a picture's texel: decoded, and on the GPU with its mip levels.
const TEXEL_BYTES: u64 = 15;

/// See the module.
#[derive(Default)]
pub(super) struct Ahead {
    /// The next scene and the previous one; none if nothing is prepared.
    neighbours: Option<[Neighbour; 2]>,
    /// What decided which they are.
    of: Option<WantedAhead>,
}

struct Neighbour {
    loader: SceneLoader,
    source: Option<SceneSource>,
    state: State,
}

/// Which scenes are prepared.
#[derive(Debug, PartialEq)]
pub(super) enum WantedAhead {
    /// Those beside a scene in the list.
    Neighbours(SceneSource),
    /// What a show has next.
    Upcoming([Option<SceneSource>; 2]),
}

enum State {
    /// Nobody has asked for it.
    Unasked,
    /// It is being loaded.
    Loading,
    /// It is loaded.
    Loaded {
        cast: Box<Cast>,
        /// Whether its first tree was requested.
        has_asked: bool,
        /// Whether it was drawn.
        is_rehearsed: bool,
    },
    /// It is prepared when somebody goes there, if that is possible.
    Left,
}

impl State {
    fn loaded(cast: Cast, is_rehearsed: bool) -> Self {
        Self::Loaded { cast: Box::new(cast), has_asked: is_rehearsed, is_rehearsed }
    }
}

impl Ahead {
    /// Prepares with these loaders; without them nothing.
    pub(super) fn with(loaders: Option<[SceneLoader; 2]>) -> Self {
        let vacant = |loader| Neighbour { loader, source: None, state: State::Unasked };
        Self { neighbours: loaders.map(|loaders| loaders.map(vacant)), of: None }
    }

    /// The loaders, for another stage.
    pub(super) fn into_loaders(self) -> Option<[SceneLoader; 2]> {
        self.neighbours.map(|neighbours| neighbours.map(|neighbour| neighbour.loader))
    }

    fn all(&self) -> impl Iterator<Item = &Neighbour> {
        self.neighbours.iter().flatten()
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut Neighbour> {
        self.neighbours.iter_mut().flatten()
    }

    /// The scenes that are loaded.
    pub(super) fn casts(&self) -> impl Iterator<Item = &Cast> {
        self.all().filter_map(Neighbour::cast)
    }

    /// The same, to be changed.
    pub(super) fn casts_mut(&mut self) -> impl Iterator<Item = &mut Cast> {
        self.all_mut().filter_map(|neighbour| match &mut neighbour.state {
            State::Loaded { cast, .. } => Some(&mut **cast),
            _ => None,
        })
    }

    /// Gives up preparing the scene that a program was meant for, or all that need an interpreter.
    pub(super) fn leave(&mut self, task: &Task) {
        self.leave_where(|cast| match task {
            Task::Compiled { id, .. } => *id == cast.id,
            Task::Interpreter(variant) => {
                cast.interpreted.is_none()
                    && cast.interpreter.as_ref().is_some_and(|needed| variant.covers(needed))
            }
            Task::Universal { .. } | Task::Views(_) => false,
        });
    }

    /// Gives up preparing some scenes.
    pub(super) fn leave_where(&mut self, is_left: impl Fn(&Cast) -> bool) {
        for neighbour in self.all_mut() {
            if neighbour.cast().is_some_and(&is_left) {
                neighbour.state = State::Left;
            }
        }
    }

    /// Trees that were requested have been forgotten, because another scene is coming.
    pub(super) fn ask_again_for_trees(&mut self) {
        for neighbour in self.all_mut() {
            if let State::Loaded { cast, has_asked, .. } = &mut neighbour.state {
                *has_asked = cast.tree != FirstTree::Coming;
            }
        }
    }

    /// Keeps a scene that was shown, if it is a neighbour of the one that is.
    pub(super) fn keep(&mut self, shown: Cast) {
        let has_room = self.has_room_for(shown.resources.world());
        let waits = |neighbour: &&mut Neighbour| {
            neighbour.source.as_ref() == Some(&shown.source) && matches!(neighbour.state, State::Unasked)
        };
        if let Some(neighbour) = self.all_mut().find(waits) {
            neighbour.state = if has_room { State::loaded(shown, true) } else { State::Left };
        }
    }

    /// Prepares these from now on, and keeps what of them is there already.
    fn want(&mut self, wanted: [Option<SceneSource>; 2]) {
        let Some(neighbours) = &mut self.neighbours else { return };
        let has = |at: usize, neighbours: &[Neighbour; 2]| {
            neighbours[at].source.is_some() && neighbours[at].source == wanted[1 - at]
        };
        if has(0, neighbours) || has(1, neighbours) {
            neighbours.swap(0, 1);
        }
        for (neighbour, wanted) in neighbours.iter_mut().zip(wanted) {
            if neighbour.source != wanted {
                (neighbour.source, neighbour.state) = (wanted, State::Unasked);
            }
        }
    }

    /// Whether a source is prepared and was drawn once.
    fn has_rehearsed(&self, source: &SceneSource) -> bool {
        self.all().any(|neighbour| {
            neighbour.source.as_ref() == Some(source)
                && matches!(neighbour.state, State::Loaded { is_rehearsed: true, .. })
        })
    }

    /// What is prepared, the next one first.
    pub(super) fn next_sources(&self) -> impl Iterator<Item = &SceneSource> {
        self.all().filter_map(|neighbour| neighbour.source.as_ref())
    }

    /// The scenes that were drawn once, the next one first.
    pub(super) fn rehearsed(&self) -> impl Iterator<Item = &Cast> {
        self.all().filter_map(|neighbour| match &neighbour.state {
            State::Loaded { cast, is_rehearsed: true, .. } => Some(&**cast),
            _ => None,
        })
    }

    /// Gives a source away that is prepared and was drawn once.
    pub(super) fn give(&mut self, source: &SceneSource) -> Option<Cast> {
        let neighbour = self.all_mut().find(|neighbour| neighbour.source.as_ref() == Some(source))?;
        if !matches!(neighbour.state, State::Loaded { is_rehearsed: true, .. }) {
            return None;
        }
        neighbour.source = None;
        match std::mem::replace(&mut neighbour.state, State::Unasked) {
            State::Loaded { cast, .. } => Some(*cast),
            _ => None,
        }
    }

    /// Whether there is room for another scene.
    fn has_room_for(&self, world: &World) -> bool {
        let taken: u64 = self.casts().map(|cast| bytes_of(cast.resources.world())).sum();
        taken + bytes_of(world) <= LIMITS.prepared_bytes_max
    }

    /// Takes the neighbour that is gone to, if it is loaded, and leaves the loader of the scene that was shown in
    /// its place: the sides change.
    fn take(&mut self, to: &SceneSource, from: SceneSource, loader: &mut SceneLoader) -> Option<Cast> {
        let neighbours = self.neighbours.as_mut()?;
        let is_it =
            |neighbour: &&mut Neighbour| neighbour.source.as_ref() == Some(to) && neighbour.cast().is_some();
        let neighbour = neighbours.iter_mut().find(is_it)?;
        let State::Loaded { cast, .. } = std::mem::replace(&mut neighbour.state, State::Unasked) else {
            return None;
        };
        neighbour.source = Some(from);
        std::mem::swap(&mut neighbour.loader, loader);
        neighbours.swap(0, 1);
        Some(*cast)
    }
}

impl Neighbour {
    fn cast(&self) -> Option<&Cast> {
        match &self.state {
            State::Loaded { cast, .. } => Some(cast),
            _ => None,
        }
    }
}

/// Approximate bytes of a scene that can be drawn.
fn bytes_of(world: &World) -> u64 {
    let texels =
        world.pictures.iter().map(|picture| u64::from(picture.width()) * u64::from(picture.height()));
    PROGRAM_BYTES + TEXEL_BYTES * texels.sum::<u64>()
}

impl SceneStage {
    /// Takes the neighbour that is gone to, if it is loaded.
    pub(super) fn take_neighbour(&mut self, to: &SceneSource) -> Option<Cast> {
        // Only the scene that is shown is kept in exchange.
        let from = self.on_stage.as_ref()?.source.clone();
        if self.source != from {
            return None;
        }
        self.ahead.take(to, from, &mut self.loader)
    }

    /// Whether a source can be shown in the next picture.
    pub(super) fn has_ready(&self, source: &SceneSource) -> bool {
        self.ahead.has_rehearsed(source)
    }

    /// Goes on preparing the neighbours of the scene on the stage.
    pub(super) fn prepare_neighbours(&mut self) {
        self.take_loaded_neighbours();
        if self.ahead.neighbours.is_none() || !self.is_complete() {
            return;
        }
        let wanted = self.wanted_ahead();
        if self.ahead.of.as_ref() != Some(&wanted) {
            let sources = match &wanted {
                WantedAhead::Neighbours(of) => [Some(self.list.next(of)), Some(self.list.previous(of))],
                WantedAhead::Upcoming(sources) => sources.clone(),
            };
            self.ahead.of = Some(wanted);
            self.ahead.want(sources);
            self.forget_obsolete();
        }
        let mut begun = None;
        for neighbour in self.ahead.all_mut() {
            match &mut neighbour.state {
                State::Left => continue,
                State::Unasked => {
                    if let Some(source) = &neighbour.source {
                        neighbour.loader.request(source.clone());
                        neighbour.state = State::Loading;
                    }
                }
                State::Loaded { cast, has_asked, is_rehearsed } => {
                    let missing = missing_mode(self.choice, cast);
                    if *has_asked && missing.is_none() && cast.tree != FirstTree::Coming && *is_rehearsed {
                        continue;
                    }
                    begun = Some((cast.id, missing, !std::mem::replace(has_asked, true)));
                }
                State::Loading => {}
            }
            // One at a time.
            break;
        }
        let Some((id, missing, asks)) = begun else { return };
        if asks && let Some(cast) = self.cast(id) {
            tracing::info!("{} is prepared ahead", cast.source.title());
            self.regions.try_tree(id, &cast.resources);
        }
        match missing {
            Some(Mode::Compiled) => self.ask_for_compiled(id),
            Some(Mode::Interpreted) => self.ask_for_interpreter(id),
            None => {}
        }
    }

    /// Whether there is nothing left to do for the scene that was asked for.
    pub(super) fn is_complete(&self) -> bool {
        let Some(shown) = &self.on_stage else { return false };
        shown.source == self.source
            && self.pictured == Some(shown.id)
            && self.coming.is_none()
            && self.before.is_none()
            && self.making.is_none()
            && self.tasks.is_empty()
            && self.view().is_none()
            && !self.fading.goes_on()
    }

    fn take_loaded_neighbours(&mut self) {
        for at in 0..2 {
            let Some(neighbour) = self.ahead.all().nth(at) else { return };
            let Some(loaded) = neighbour.loader.poll() else { continue };
            if neighbour.source.as_ref() != Some(&loaded.source) {
                continue;
            }
            let state = match loaded.value {
                Ok(ready) => self.loaded_neighbour(loaded.source, ready),
                // It is told when somebody goes there.
                Err(_) => State::Left,
            };
            if let Some(neighbour) = self.ahead.all_mut().nth(at) {
                neighbour.state = state;
            }
        }
    }

    fn loaded_neighbour(&mut self, source: SceneSource, ready: ReadyScene) -> State {
        if !self.ahead.has_room_for(&ready.world) {
            return State::Left;
        }
        match self.make_cast(source, ready) {
            Ok(cast) => State::loaded(cast, false),
            Err(error) => {
                tracing::info!("not prepared ahead: {error}");
                State::Left
            }
        }
    }

    /// Draws a neighbour that is ready but for its first draw, where nobody sees it.
    pub(crate) fn rehearse(&mut self, renderer: &mut Renderer) {
        if !self.is_complete() {
            return;
        }
        let choice = self.choice;
        for neighbour in self.ahead.all_mut() {
            let State::Loaded { cast, is_rehearsed, .. } = &mut neighbour.state else { continue };
            let is_due =
                !*is_rehearsed && cast.tree != FirstTree::Coming && missing_mode(choice, cast).is_none();
            let Some(program) = is_due.then(|| wanted_mode(choice, cast)).and_then(|mode| cast.program(mode))
            else {
                continue;
            };
            let frame = Frame::new(cast.resources.world(), 0.0, Features::SILENCE, REHEARSAL_SIZE);
            *is_rehearsed = true;
            match renderer.rehearse(&frame, &cast.resources, program) {
                Ok(()) => tracing::info!("{} is ready ahead", cast.source.title()),
                Err(error) => {
                    tracing::info!("not prepared ahead: {error}");
                    neighbour.state = State::Left;
                }
            }
            return;
        }
    }
}

/// The mode in which a scene is to be shown in the end.
fn wanted_mode(choice: SdfChoice, cast: &Cast) -> Mode {
    let compiles = match choice {
        SdfChoice::Interpreted => false,
        SdfChoice::Compiled => true,
        SdfChoice::Auto => cast.is_compiled_by_itself(),
    };
    if cast.interpreter.is_none() || (compiles && cast.compilable) {
        Mode::Compiled
    } else {
        Mode::Interpreted
    }
}

/// That mode, if its program is not there.
fn missing_mode(choice: SdfChoice, cast: &Cast) -> Option<Mode> {
    Some(wanted_mode(choice, cast)).filter(|mode| cast.program(*mode).is_none())
}
