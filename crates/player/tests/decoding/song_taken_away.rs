//! Regression test: a looping song was once opened by its path at each lap, so that moving or deleting the file ended
//! the show.

#![cfg(unix)]
#![allow(clippy::unwrap_used)]

use mariana_player::decode::Decoder;
use mariana_testing::wave::write_wav;

fn rest_of(decoder: &mut Decoder) -> Vec<[f32; 2]> {
    let mut frames = Vec::new();
    while decoder.next_block(&mut frames).unwrap() > 0 {}
    frames
}

#[test]
fn a_song_that_is_deleted_while_it_plays_can_restart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("song.wav");
    write_wav(&path, 48_000, 2, (0..96_000).map(|sample| (sample % 997) as f32 / 997.0));
    let mut decoder = Decoder::open(&path).unwrap();
    let first = rest_of(&mut decoder);
    assert_eq!(first.len(), 48_000);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(decoder.seek(0.0).unwrap(), 0.0);
    assert!(rest_of(&mut decoder) == first, "the second lap differs");
}
