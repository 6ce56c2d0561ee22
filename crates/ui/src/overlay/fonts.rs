//! Letters that the overlay's fonts lack: fonts of the system are looked for, on a thread of their own, and stand in.
//!
//! egui asks for each missing letter once, while it lays text out; it draws a box. When fonts have been found the show
//! is woken and the text is laid out again. As long as nothing is missing there is no thread and nothing is read.

use std::collections::BTreeSet;
use std::mem;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use egui::Context;
use egui::epaint::text::{FallbackRequest, FontInsert, FontProvider};

use crate::limits::LIMITS;
use mariana_render::system_fonts::SystemFonts;

/// Where fonts are looked for, and who is woken when there are some.
struct Start {
    fonts: SystemFonts,
    wake: Box<dyn Fn() + Send>,
}

/// See the module.
pub(super) struct Fallback {
    missed: Arc<Missed>,
    /// Until something is missing.
    start: Option<Start>,
    wanted: Option<Sender<BTreeSet<char>>>,
    found: Arc<Mutex<Vec<FontInsert>>>,
}

/// What egui has missed.
#[derive(Default)]
struct Missed(Mutex<Letters>);

#[derive(Default)]
struct Letters {
    /// Since they were last handed on.
    new: BTreeSet<char>,
    /// Ever.
    all: BTreeSet<char>,
}

impl FontProvider for Missed {
    fn font_for(&self, request: &FallbackRequest<'_>) -> Option<FontInsert> {
        let letter = request.cluster.chars().next()?;
        let mut letters = lock(&self.0);
        if letters.all.len() < LIMITS.letters_looked_for_max && letters.all.insert(letter) {
            letters.new.insert(letter);
        }
        None
    }
}

impl Fallback {
    /// Notes what `context` misses, and looks among `fonts` for it. `wake` is called, on another thread, when there is
    /// something to [`Self::add_found`].
    pub(super) fn new(context: &Context, fonts: SystemFonts, wake: impl Fn() + Send + 'static) -> Self {
        let missed = Arc::new(Missed::default());
        context.add_font_provider(missed.clone());
        let start = Some(Start { fonts, wake: Box::new(wake) });
        Self { missed, start, wanted: None, found: Arc::default() }
    }

    /// Whether there are fonts to add.
    pub(super) fn has_found(&self) -> bool {
        !lock(&self.found).is_empty()
    }

    /// How many letters have been missed so far.
    #[cfg(test)]
    pub(super) fn missed(&self) -> usize {
        lock(&self.missed.0).all.len()
    }

    /// Whether the thread has been started.
    #[cfg(test)]
    pub(super) fn has_started(&self) -> bool {
        self.start.is_none()
    }

    /// Adds the fonts that were found to `context`: its next pass has them.
    pub(super) fn add_found(&self, context: &Context) {
        for font in mem::take(&mut *lock(&self.found)) {
            context.add_font(font);
        }
    }

    /// Looks for what was missed since it was last called.
    pub(super) fn look(&mut self) {
        let new = mem::take(&mut lock(&self.missed.0).new);
        if new.is_empty() {
            return;
        }
        if let Some(start) = self.start.take() {
            let (wanted, requests) = channel();
            let found = self.found.clone();
            let thread = std::thread::Builder::new().name("fonts".into());
            match thread.spawn(move || search(start, &requests, &found)) {
                Ok(_) => self.wanted = Some(wanted),
                Err(error) => tracing::warn!("no thread for fonts, boxes stand for what is missing: {error}"),
            }
        }
        if let Some(wanted) = &self.wanted {
            // Without the thread boxes stay.
            let _ = wanted.send(new);
        }
    }
}

fn search(mut start: Start, requests: &Receiver<BTreeSet<char>>, found: &Mutex<Vec<FontInsert>>) {
    for letters in requests {
        let fonts = start.fonts.with_letters(&letters);
        if !fonts.is_empty() {
            lock(found).extend(fonts);
            (start.wake)();
        }
    }
}

/// What it guards is whole between any two statements, whatever thread ended.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
