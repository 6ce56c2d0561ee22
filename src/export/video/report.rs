//! The reports of a video that another process renders, one JSON object a line.

use serde::{Deserialize, Serialize};

/// A line that `mariana video --controlled` prints on standard output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VideoReport {
    /// Frames are drawn.
    Drawn {
        /// The number of frames so far.
        done: u64,
        /// The total number of frames, if known.
        of: Option<u64>,
    },
    /// The video is complete.
    Written {
        /// The name of its file.
        name: String,
    },
}

/// The line on standard input that interrupts the drawing.
pub const PAUSE: &str = "pause";
/// The line on standard input that continues the drawing.
pub const CONTINUE: &str = "continue";
