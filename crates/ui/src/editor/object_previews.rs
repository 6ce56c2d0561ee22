//! Previews of the library's shapes for the completion list. A thread renders each preview when it is first needed.

use std::collections::BTreeMap;
use std::sync::Arc;

use image::RgbaImage;
use mariana_field::lang::examples;
use mariana_field::ray_probe::preview;
use mariana_work::{Worker, in_order};

const SIDE: usize = 48;

/// A preview: red, green, blue and coverage of each pixel.
pub(crate) type ObjectPreview = Arc<RgbaImage>;

pub(super) struct ObjectPreviews {
    /// Finished previews; `None` while a preview is being rendered.
    known: BTreeMap<&'static str, Option<ObjectPreview>>,
    painter: Worker<(&'static str, &'static str), (&'static str, ObjectPreview)>,
}

impl ObjectPreviews {
    /// Starts the thread, which calls `wake` after each preview. If the thread cannot start, there are no previews.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> Self {
        let draw = |(name, formula)| {
            let pixels = preview(formula, SIDE)?.into_flattened();
            Some((name, Arc::new(RgbaImage::from_raw(SIDE as u32, SIDE as u32, pixels)?)))
        };
        let painter = in_order("previews", wake, move || draw).inspect_err(|error| {
            tracing::warn!("cannot start the thread for shape previews, so the list shows none: {error}");
        });
        Self { known: BTreeMap::new(), painter: painter.unwrap_or_default() }
    }

    pub(super) fn request(&mut self, name: &str) {
        if let Some((name, formula)) = examples().find(|(known, _)| *known == name)
            && !self.known.contains_key(name)
        {
            self.known.insert(name, None);
            self.painter.send((name, formula));
        }
    }

    pub(super) fn update(&mut self) -> bool {
        let mut any = false;
        while let Some((name, picture)) = self.painter.poll() {
            self.known.insert(name, Some(picture));
            any = true;
        }
        any
    }

    pub(super) fn of(&self, name: &str) -> Option<&ObjectPreview> {
        self.known.get(name)?.as_ref()
    }
}
