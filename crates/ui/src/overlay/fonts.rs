//! Fallback fonts: a thread searches the system's fonts for characters that the built-in fonts lack. egui requests each
//! missing character once, during layout, and draws a box in its place. The thread starts at the first missing
//! character, and wakes the show when it has found fonts.

use std::collections::BTreeSet;
use std::mem;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use egui::Context;
use egui::epaint::text::{FallbackRequest, FontInsert, FontProvider};

use crate::limits;
use mariana_render::system_fonts::SystemFonts;
use mariana_work::lock;

struct Start {
    fonts: SystemFonts,
    wake: Box<dyn Fn() + Send>,
}

pub(super) struct Fallback {
    missed: Arc<Missed>,
    /// The data for the thread, present until the thread starts.
    start: Option<Start>,
    wanted: Option<Sender<BTreeSet<char>>>,
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
    pub(super) fn new(context: &Context, fonts: SystemFonts, wake: impl Fn() + Send + 'static) -> Self {
        let missed = Arc::new(Missed::default());
        context.add_font_provider(missed.clone());
        let start = Some(Start { fonts, wake: Box::new(wake) });
        Self { missed, start, wanted: None, found: Arc::default() }
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
            let (wanted, requests) = channel();
            let found = self.found.clone();
            let thread = std::thread::Builder::new().name("fonts".into());
            match thread.spawn(move || search(start, &requests, &found)) {
                Ok(_) => self.wanted = Some(wanted),
                Err(error) => tracing::warn!(
                    "cannot start the font search, so missing letters appear as boxes: {error}"
                ),
            }
        }
        if let Some(wanted) = &self.wanted {
            // If the thread could not start, the boxes stay.
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
