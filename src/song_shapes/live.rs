//! The texts of the song in the window, which never waits for them.

use std::io;
use std::sync::Arc;

use super::{Atlases, Baked, Key, SongTexts, are_same, shown};
use crate::frame::Frame;
use mariana_field::graph::{ShapeGrid, SoundInput};
use mariana_field::lang::{SongText, TextBaker};
use mariana_field::world::World;
use mariana_work::{Latest, Shared, contained, latest};

/// Maximum number of texts that wait for the thread. Older ones are dropped.
const WANTED_MAX: usize = 32;
/// Maximum number of texts of the shown scene and of a scene that fades out.
const SHOWN_MAX: usize = 64;

/// The texts of the song in the frames of a session.
pub struct LiveSongShapes {
    texts: SongTexts,
    shared: Latest<Baking>,
    /// The grids in the last frames, which stay until the next ones are baked.
    shown: Vec<(Arc<dyn TextBaker>, SongText, ShapeGrid)>,
    atlases: Atlases,
}

#[derive(Default)]
struct Baking {
    /// The most urgent one first.
    wanted: Vec<Key>,
    baked: Baked,
    has_come: bool,
}

impl Baking {
    fn next(&mut self) -> Option<Key> {
        while !self.wanted.is_empty() {
            let key = self.wanted.remove(0);
            if self.baked.get(&key).is_none() {
                return Some(key);
            }
        }
        None
    }
}

impl LiveSongShapes {
    /// Starts the thread, which calls `wake` when a text is baked that the last frame lacks.
    ///
    /// # Errors
    /// Fails if the system cannot start a thread.
    pub fn start(wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let bake = move |key: Key, shared: &Shared<Baking>| {
            // After a panic the text stays empty, and is not tried again.
            let grid = contained(|| key.baker.bake(&key.text)).unwrap_or_else(|| key.baker.bake(""));
            let mut state = shared.lock();
            state.baked.put(key, grid);
            state.has_come = true;
            drop(state);
            wake();
        };
        let shared = latest("texts of the song", Baking::default(), Baking::next, bake)?;
        Ok(Self { texts: SongTexts::default(), shared, shown: Vec::new(), atlases: Atlases::default() })
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
            let last = last.map(|last| self.shown.remove(last).2);
            let baked = self.shared.lock().baked.get(&now);
            if !now.text.is_empty() {
                if let Some(grid) = baked.clone().or(last) {
                    self.shown.push((baker.clone(), what, grid.clone()));
                    changed.push((number, grid));
                }
                wanted.extend(baked.is_none().then_some(now));
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
        // Two scenes may be drawn in turn, so keep what the other one wants.
        self.shared.change(|state| {
            state.wanted.retain(|key| !wanted.contains(key));
            state.wanted.splice(0..0, wanted);
            state.wanted.truncate(WANTED_MAX);
        });
    }
}
