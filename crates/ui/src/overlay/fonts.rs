//! Fallback fonts: a thread searches the system's fonts for characters that the built-in fonts lack. egui requests each
//! missing character once, during layout, and draws a box in its place. The thread starts at the first missing
//! character, and wakes the show when it has found fonts.

use std::collections::BTreeSet;
use std::io;
use std::mem;
use std::sync::{Arc, Mutex};

use egui::Context;
use egui::epaint::text::{FallbackRequest, FontInsert, FontProvider};

use crate::limits;
use mariana_render::system_fonts::SystemFonts;
use mariana_work::{Worker, in_order, lock};

/// Starts the thread.
type Start = Box<dyn FnOnce() -> io::Result<Worker<BTreeSet<char>>> + Send>;

pub(super) struct Fallback {
    missed: Arc<Missed>,
    /// Present until the thread starts.
    start: Option<Start>,
    thread: Worker<BTreeSet<char>>,
    found: Arc<Mutex<Vec<FontInsert>>>,
}

#[derive(Default)]
struct Missed(Mutex<Letters>);

#[derive(Default)]
struct Letters {
    /// Characters that egui has missed since the last request to the thread.
    new: BTreeSet<char>,
    /// Characters that egui has missed since the program started.
    all: BTreeSet<char>,
}

impl FontProvider for Missed {
    fn font_for(&self, request: &FallbackRequest<'_>) -> Option<FontInsert> {
        let letter = request.cluster.chars().next()?;
        let mut letters = lock(&self.0);
        if letters.all.len() < limits::LETTERS_LOOKED_FOR_MAX && letters.all.insert(letter) {
            letters.new.insert(letter);
        }
        None
    }
}

impl Fallback {
    /// Records the characters that `context` lacks and searches `fonts` for them. The thread calls `wake` when
    /// [`Self::add_found`] has fonts to add.
    pub(super) fn new(context: &Context, mut fonts: SystemFonts, wake: impl Fn() + Send + 'static) -> Self {
        let (missed, found) = (Arc::new(Missed::default()), Arc::<Mutex<Vec<FontInsert>>>::default());
        context.add_font_provider(missed.clone());
        let of_thread = found.clone();
        let search = move |letters| {
            let fonts = fonts.with_letters(&letters);
            (!fonts.is_empty()).then(|| lock(&of_thread).extend(fonts))
        };
        let start = move || in_order("fonts", wake, || search);
        Self { missed, start: Some(Box::new(start)), thread: Worker::default(), found }
    }

    pub(super) fn has_found(&self) -> bool {
        !lock(&self.found).is_empty()
    }

    #[cfg(test)]
    pub(super) fn missed(&self) -> usize {
        lock(&self.missed.0).all.len()
    }

    #[cfg(test)]
    pub(super) fn has_started(&self) -> bool {
        self.start.is_none()
    }

    pub(super) fn add_found(&self, context: &Context) {
        while self.thread.poll().is_some() {}
        for font in mem::take(&mut *lock(&self.found)) {
            context.add_font(font);
        }
    }

    /// Requests the characters that egui has missed since the last call.
    pub(super) fn request_missing(&mut self) {
        let new = mem::take(&mut lock(&self.missed.0).new);
        if new.is_empty() {
            return;
        }
        if let Some(start) = self.start.take() {
            let thread = start().inspect_err(|error| {
                tracing::warn!("cannot start the font search, so missing letters appear as boxes: {error}");
            });
            self.thread = thread.unwrap_or_default();
        }
        // If the thread could not start, the boxes stay.
        self.thread.send(new);
    }
}
