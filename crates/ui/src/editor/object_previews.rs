//! Previews of the library's shapes for the completion list. A thread renders each preview when it is first needed.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

use mariana_field::lang::PICTURES;
use mariana_field::ray_probe::preview;

pub(crate) const SIDE: usize = 48;

/// A preview: red, green, blue and coverage of each pixel, row by row from the upper left.
pub(crate) type ObjectPreview = Arc<Vec<[u8; 4]>>;

pub(super) struct ObjectPreviews {
    /// Finished previews; `None` while a preview is being rendered.
    known: BTreeMap<&'static str, Option<ObjectPreview>>,
    orders: Sender<(&'static str, &'static str)>,
    drawn: Receiver<(&'static str, ObjectPreview)>,
}

impl ObjectPreviews {
    /// Starts the thread, which calls `wake` after each preview. If the thread cannot start, there are no previews.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> Self {
        let (orders, inbox) = channel::<(&'static str, &'static str)>();
        let (tell, drawn) = channel();
        let started = Builder::new().name("previews".into()).spawn(move || {
            for (name, formula) in inbox {
                let Some(picture) = preview(formula, SIDE) else { continue };
                if tell.send((name, Arc::new(picture))).is_err() {
                    return;
                }
                wake();
            }
        });
        if let Err(error) = started {
            tracing::warn!("cannot start the thread for shape previews, so the list shows none: {error}");
        }
        Self { known: BTreeMap::new(), orders, drawn }
    }

    pub(super) fn request(&mut self, name: &str) {
        if let Some((name, formula)) = PICTURES.iter().find(|(known, _)| *known == name)
            && !self.known.contains_key(name)
        {
            self.known.insert(name, None);
            // Sending fails only if the thread did not start, which has been logged.
            let _ = self.orders.send((name, formula));
        }
    }

    pub(super) fn update(&mut self) -> bool {
        let mut any = false;
        while let Ok((name, picture)) = self.drawn.try_recv() {
            self.known.insert(name, Some(picture));
            any = true;
        }
        any
    }

    pub(super) fn of(&self, name: &str) -> Option<&ObjectPreview> {
        self.known.get(name)?.as_ref()
    }
}
