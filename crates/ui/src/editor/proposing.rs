//! The completion list, and previews of the library's shapes in it. A thread renders each preview when it is first
//! needed.

use std::collections::BTreeMap;
use std::sync::Arc;

use image::RgbaImage;
use mariana_commands::input::{Key, Modifiers, NamedKey};
use mariana_editing::{Proposal, own_names, proposals};
use mariana_field::lang::examples;
use mariana_field::ray_probe::preview;
use mariana_work::{Worker, in_order};

use super::document::Document;
use super::texts::Edit;

/// Side of a preview in pixels.
const SIDE: usize = 48;

/// A preview: red, green, blue and coverage of each pixel.
pub(crate) type ObjectPreview = Arc<RgbaImage>;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Proposing {
    /// Byte offset of the typed name.
    pub from: usize,
    /// Candidates, best first.
    pub list: Vec<Proposal>,
    pub selected: usize,
    /// True after the user has moved the selection, so that Enter accepts a candidate.
    moved: bool,
}

impl Proposing {
    fn of_library(&self) -> Option<&str> {
        let one = self.list.get(self.selected)?;
        (one.about.is_function && !one.about.facts.is_empty()).then_some(one.name.as_str())
    }
}

pub(super) enum Choice {
    Other,
    Changed,
    Take(usize),
}

pub(crate) struct Proposals {
    pub(crate) shown: Option<Proposing>,
    /// Finished previews; `None` while a preview is being rendered.
    previews: BTreeMap<&'static str, Option<ObjectPreview>>,
    painter: Worker<(&'static str, &'static str), (&'static str, ObjectPreview)>,
}

impl Proposals {
    /// Starts with a closed list, and the thread, which calls `wake` after each preview. If the thread cannot start,
    /// there are no previews.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> Self {
        let draw = |(name, formula)| {
            let pixels = preview(formula, SIDE)?.into_flattened();
            Some((name, Arc::new(RgbaImage::from_raw(SIDE as u32, SIDE as u32, pixels)?)))
        };
        let painter = in_order("previews", wake, move || draw).inspect_err(|error| {
            tracing::warn!("cannot start the thread for shape previews, so the list shows none: {error}");
        });
        Self { shown: None, previews: BTreeMap::new(), painter: painter.unwrap_or_default() }
    }

    pub(crate) fn object_preview(&self) -> Option<&ObjectPreview> {
        self.previews.get(self.shown.as_ref()?.of_library()?)?.as_ref()
    }

    /// Requests the preview of the selected name. Returns true if a preview has come.
    pub(super) fn update(&mut self) -> bool {
        let wanted = self.shown.as_ref().and_then(Proposing::of_library);
        if let Some(one) = wanted.and_then(|wanted| examples().find(|(name, _)| *name == wanted))
            && !self.previews.contains_key(one.0)
        {
            self.previews.insert(one.0, None);
            self.painter.send(one);
        }
        let mut any = false;
        while let Some((name, picture)) = self.painter.poll() {
            self.previews.insert(name, Some(picture));
            any = true;
        }
        any
    }

    /// Finds candidates for the name at the cursor. If the user `asked`, works even before a letter is typed. Returns
    /// true if there are candidates.
    pub(super) fn propose(&mut self, document: &Document, asked: bool) -> bool {
        let (buffer, cursor) = (document.editing.buffer(), document.editing.cursor());
        let own = |from| own_names(buffer, from);
        let colors = &mut document.colors.borrow_mut();
        let (range, list) = proposals(buffer, colors, cursor, asked, own);
        let proposing = Proposing { from: range.start, list, selected: 0, moved: asked };
        self.shown = Some(proposing).filter(|proposing| !proposing.list.is_empty());
        self.shown.is_some()
    }

    pub(super) fn choose(&mut self, key: &Key, held: Modifiers) -> Choice {
        let Some(proposing) = &mut self.shown else { return Choice::Other };
        let (Key::Named(named), true) = (key, held.is_empty()) else { return Choice::Other };
        let count = proposing.list.len();
        match named {
            NamedKey::ArrowDown => proposing.selected = (proposing.selected + 1) % count,
            NamedKey::ArrowUp => proposing.selected = (proposing.selected + count - 1) % count,
            NamedKey::Tab => return Choice::Take(proposing.selected),
            NamedKey::Enter if proposing.moved => return Choice::Take(proposing.selected),
            NamedKey::Escape => {
                self.shown = None;
                return Choice::Changed;
            }
            _ => return Choice::Other,
        }
        proposing.moved = true;
        Choice::Changed
    }

    pub(super) fn accept(&mut self, number: usize) -> Option<Edit> {
        let Proposing { from, mut list, .. } = self.shown.take()?;
        let proposal = (number < list.len()).then(|| list.swap_remove(number))?;
        Some(Box::new(move |editing| {
            let cursor = editing.cursor();
            let mut text = proposal.name.into_bytes();
            let calls = editing.buffer().slice(cursor..cursor + 1) == b"(";
            if proposal.about.is_function && !calls {
                text.push(b'(');
            }
            editing.replace_part(from..cursor, &text)
        }))
    }
}
