//! Tests of the analysis with known signals, rhythms and songs.

mod analysis;
mod beats;
mod events;
#[allow(dead_code)]
mod forms;
mod levels_and_curves;
mod live;
mod notes;
mod played;
mod rhythm;
mod signals;
mod song_structure;
#[allow(dead_code)] // The example `song_figures` uses more of these functions.
mod songs;
mod stereo;
mod strokes;
