//! Texts and pictures that shapes of a scene read as 2D distances.

use super::source::Span;
use crate::graph::ShapeGrid;
use std::panic::{RefUnwindSafe, UnwindSafe};
use std::sync::Arc;

/// The kind of a call that reads a text or picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ShapeCall {
    Text,
    Image,
    Song(SongText),
}

/// A text or picture that shapes of a scene read as a 2D distance.
#[derive(Debug, Clone)]
pub struct ShapeRef {
    /// The text or picture.
    pub source: ShapeSource,
    /// The location of its first use.
    pub span: Span,
    /// Set by the loader of scenes for a text that changes during the song.
    pub baker: Option<Arc<dyn TextBaker>>,
}

/// Computes the distances to texts in one font.
pub trait TextBaker: std::fmt::Debug + Send + Sync + UnwindSafe + RefUnwindSafe {
    /// Returns the distances to a text. Their grid always has the same size. Any text is accepted. This takes up to a
    /// tenth of a second.
    fn bake(&self, text: &str) -> ShapeGrid;
}

/// A text or picture.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum ShapeSource {
    /// A text.
    Text {
        /// The text.
        text: String,
        /// The name of a font, or the path of its file in the scene's folder; `None` for the program's font.
        font: Option<String>,
    },
    /// A picture: its path relative to the scene's folder.
    Image(String),
    /// A text of the song. It changes during the song.
    Song {
        /// The text.
        what: SongText,
        /// The font, as for a text.
        font: Option<String>,
    },
}

/// A text of the song.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SongText {
    /// The title.
    Title,
    /// The name of the artist.
    Artist,
    /// The line of the lyrics at this moment.
    Lyrics,
}
