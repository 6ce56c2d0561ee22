//! Actions for videos of the playing song.

/// A change in the panel of videos.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VideoEdit {
    /// Chooses an option of a row.
    Choose {
        /// The row.
        what: VideoChoice,
        /// The option's index in the row.
        option: usize,
    },
    /// Makes a video with the present choices.
    Make,
    /// Acts on a video of the queue.
    Job {
        /// The video's number.
        id: u64,
        /// The action.
        action: JobAction,
    },
}

/// A choice for the next video.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VideoChoice {
    /// A service with its requirements, or a size.
    Place,
    /// The part of the song.
    Part,
    /// The marks on the seek bar.
    Marks,
    /// The scene or the show.
    Show,
    /// Title and artist during the first seconds.
    TitleCard,
    /// The lyrics.
    Captions,
    /// Faster drawing with coarser edges.
    Draft,
    /// The folder of the file.
    Folder,
}

/// An action on a video of the queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JobAction {
    /// Interrupts the rendering.
    Pause,
    /// Continues a paused or unfinished video, or tries a failed one again.
    Continue,
    /// Shows the folder of a finished video.
    Show,
    /// Cancels an unfinished video, or removes it from the list. A finished file stays.
    Remove,
}

/// A mark on the seek bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// The mark.
    pub edge: Edge,
    /// The time in the track in seconds; `None` for the present position, or for the border of a section near it.
    pub at: Option<f64>,
}

/// An end of the marked part of a song.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Edge {
    /// The start.
    Start,
    /// The end.
    End,
}
