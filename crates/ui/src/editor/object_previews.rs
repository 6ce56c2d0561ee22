//! Small pictures of the library's shapes, for what may be written: each is drawn once, on a thread, when it is first
//! looked at.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

use mariana_field::lang::PICTURES;
use mariana_field::ray_probe::preview;

/// Pixels along each side.
pub(crate) const SIDE: usize = 48;

/// A picture: red, green, blue and how much of a pixel is covered, from the upper left to the right.
pub(crate) type ObjectPreview = Arc<Vec<[u8; 4]>>;

/// See the module.
pub(super) struct ObjectPreviews {
    /// Those that are there, or on their way.
    known: BTreeMap<&'static str, Option<ObjectPreview>>,
    orders: Sender<(&'static str, &'static str)>,
    drawn: Receiver<(&'static str, ObjectPreview)>,
}

impl ObjectPreviews {
    /// Starts the thread, which calls `wake` after each picture. Without one there are no pictures.
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
            tracing::warn!("shapes have no small pictures: {error}");
        }
        Self { known: BTreeMap::new(), orders, drawn }
    }

    /// Asks for the picture of a function of the library, if it has one.
    pub(super) fn want(&mut self, name: &str) {
        if let Some((name, formula)) = PICTURES.iter().find(|(known, _)| *known == name)
            && !self.known.contains_key(name)
        {
            self.known.insert(name, None);
            // A thread that could not be started was told of.
            let _ = self.orders.send((name, formula));
        }
    }

    /// Takes in those that were drawn; whether there were any.
    pub(super) fn update(&mut self) -> bool {
        let mut any = false;
        while let Ok((name, picture)) = self.drawn.try_recv() {
            self.known.insert(name, Some(picture));
            any = true;
        }
        any
    }

    /// The picture of a function, if it is there.
    pub(super) fn of(&self, name: &str) -> Option<&ObjectPreview> {
        self.known.get(name)?.as_ref()
    }
}
