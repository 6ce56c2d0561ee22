//! The texts of the song in the window, which never waits for them.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;

use super::{Atlases, Baked, Key, SongTexts, are_same, shown};
use crate::frame::Frame;
use mariana_field::graph::{ShapeGrid, SoundInput};
use mariana_field::lang::{SongText, TextBaker};
use mariana_field::world::World;

/// Maximum number of texts that wait for the thread. Older ones are dropped.
const WANTED_MAX: usize = 32;
/// Maximum number of texts of the shown scene and of a scene that fades out.
const SHOWN_MAX: usize = 64;

/// The texts of the song in the frames of a session.
pub struct LiveSongShapes {
    texts: SongTexts,
    shared: Arc<SharedTexts>,
    has_thread: bool,
    /// The grids in the last frames, which stay until the next ones are baked.
    shown: Vec<(Arc<dyn TextBaker>, SongText, ShapeGrid)>,
    atlases: Atlases,
}

struct SharedTexts {
    state: Mutex<State>,
    changed: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct State {
    /// The most urgent one first.
    wanted: Vec<Key>,
    baked: Baked,
    has_come: bool,
    ended: bool,
}

impl LiveSongShapes {
    /// `wake` is called when a text is baked that the last frame lacks.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let shared = SharedTexts { state: Mutex::default(), changed: Condvar::new(), wake: Box::new(wake) };
        Self {
            texts: SongTexts::default(),
            shared: Arc::new(shared),
            has_thread: false,
            shown: Vec::new(),
            atlases: Atlases::default(),
        }
    }

    /// Sets the texts of the song. Returns true if they have changed.
    pub fn set_texts(&mut self, texts: SongTexts) -> bool {
        let is_another = texts != self.texts;
        self.texts = texts;
        is_another
    }

    /// Adds the texts at the frame's moment to a frame of a world, as far as they are baked.
    pub fn in_frame(&mut self, mut frame: Frame, world: &World) -> Frame {
        let line = (frame.inputs.sound[SoundInput::Line] as usize).checked_sub(1);
        let next = line.map_or(0, |line| line + 1);
        let (mut changed, mut wanted, mut later) = (Vec::new(), Vec::new(), Vec::new());
        for (number, what, baker) in shown(world) {
            let key = |line| Key { baker: baker.clone(), text: self.texts.text(what, line).to_owned() };
            let (now, soon) = (key(line), key(Some(next)));
            let last = self.shown.iter().position(|(other, of, _)| *of == what && are_same(other, baker));
            if now.text.is_empty() {
                last.map(|last| self.shown.remove(last));
            } else if let Some(grid) = self.shared.lock().baked.get(&now) {
                last.map(|last| self.shown.remove(last));
                self.shown.push((baker.clone(), what, grid.clone()));
                changed.push((number, grid));
            } else {
                changed.extend(
                    last.and_then(|last| self.shown.get(last)).map(|(.., grid)| (number, grid.clone())),
                );
                wanted.push(now);
            }
            if !soon.text.is_empty() && self.shared.lock().baked.get(&soon).is_none() {
                later.push(soon);
            }
        }
        let excess = self.shown.len().saturating_sub(SHOWN_MAX);
        self.shown.drain(..excess);
        wanted.append(&mut later);
        self.request(wanted);
        frame.inputs.shapes = self.atlases.of(&world.scene.atlas, changed);
        frame
    }

    /// True if a text has been baked since the last call that the last frame lacks.
    pub fn has_new_texts(&mut self) -> bool {
        std::mem::take(&mut self.shared.lock().has_come)
    }

    fn request(&mut self, wanted: Vec<Key>) {
        if wanted.is_empty() {
            return;
        }
        {
            // Two scenes may be drawn in turn, so keep what the other one wants.
            let all = &mut self.shared.lock().wanted;
            all.retain(|key| !wanted.contains(key));
            all.splice(0..0, wanted);
            all.truncate(WANTED_MAX);
        }
        if !self.has_thread {
            let shared = self.shared.clone();
            match Builder::new().name("texts of the song".into()).spawn(move || shared.run()) {
                Ok(_) => self.has_thread = true,
                // The texts stay empty. The next frame tries again.
                Err(error) => tracing::warn!("no thread for the texts of the song: {error}"),
            }
        }
        self.shared.changed.notify_all();
    }
}

impl Drop for LiveSongShapes {
    fn drop(&mut self) {
        self.shared.lock().ended = true;
        self.shared.changed.notify_all();
    }
}

impl SharedTexts {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self) {
        loop {
            let state = self.lock();
            let waits = |state: &mut State| !state.ended && state.wanted.is_empty();
            let mut state = self.changed.wait_while(state, waits).unwrap_or_else(PoisonError::into_inner);
            if state.ended {
                return;
            }
            let key = state.wanted.remove(0);
            if state.baked.get(&key).is_some() {
                continue;
            }
            drop(state);
            let grid = key.baker.bake(&key.text);
            let mut state = self.lock();
            state.baked.put(key, grid);
            state.has_come = true;
            drop(state);
            (self.wake)();
        }
    }
}
