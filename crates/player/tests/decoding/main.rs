//! Files of sound and lists of them, good and bad.

mod by_ffmpeg;
mod decoding;
mod song_taken_away;
