//! Tests of audio files, intact and damaged.

mod as_others_play;
mod by_ffmpeg;
mod damaged_files;
mod decoding;
mod song_taken_away;
mod video;
