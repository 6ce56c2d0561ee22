//! Tests of editing the list of a running player.

use std::path::Path;
use std::time::Duration;

use super::tests::wait_for;
use super::*;
use crate::playlist::Playlist;
use mariana_testing::wave::write_wav;

fn playing(songs: usize, seconds: f64, repeat: Repeat) -> (Player, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let files: Vec<PathBuf> = (b'a'..).take(songs).map(|name| song(folder.path(), name, seconds)).collect();
    let opened = Playlist::open(&files, repeat, false).expect("a list");
    let options = PlayerOptions { repeat, output: None, ..PlayerOptions::default() };
    let player = Player::start(opened.first, Box::new(opened.list), options).expect("a player");
    (player, folder)
}

fn song(folder: &Path, name: u8, seconds: f64) -> PathBuf {
    let path = folder.join(format!("{}.wav", char::from(name)));
    write_wav(&path, 8000, 1, std::iter::repeat_n(0.0, (seconds * 8000.0) as usize));
    path
}

fn reported(player: &mut Player) -> (String, usize, usize) {
    let track = player.status().track;
    (track.name.clone(), track.entry, track.count)
}

fn expect(player: &mut Player, name: &str, entry: usize, count: usize) {
    wait_for(player, &format!("{name} as {entry} of {count}"), |player| {
        reported(player) == (name.to_owned(), entry, count)
    });
}

fn names(player: &Player) -> Vec<String> {
    player.playlist().entries.iter().map(|track| track.name.replace(".wav", "")).collect()
}

#[test]
fn edits_do_not_interrupt_and_the_index_is_updated() {
    let (mut player, folder) = playing(4, 60.0, Repeat::All);
    wait_for(&mut player, "it moves", |player| player.status().position > 0.05);
    let segment = player.now(0.0).segment;
    player.play_entry(2);
    expect(&mut player, "c.wav", 2, 4);
    wait_for(&mut player, "another segment", |player| player.now(0.0).segment > segment);
    let segment = player.now(0.0).segment;
    player.edit(Edit::Move { from: 2, to: 0 });
    expect(&mut player, "c.wav", 0, 4);
    player.edit(Edit::Move { from: 3, to: 0 });
    expect(&mut player, "c.wav", 1, 4);
    player.edit(Edit::Remove(0));
    expect(&mut player, "c.wav", 0, 3);
    player.edit(Edit::Append(vec![song(folder.path(), b'x', 1.0), song(folder.path(), b'y', 1.0)]));
    expect(&mut player, "c.wav", 0, 5);
    assert_eq!(names(&player), ["c", "a", "b", "x", "y"]);
    player.edit(Edit::Move { from: 9, to: 0 });
    player.edit(Edit::Move { from: 0, to: 5 });
    player.edit(Edit::Remove(5));
    player.play_entry(5);
    player.edit(Edit::Move { from: 4, to: 1 });
    wait_for(&mut player, "the last change", |player| names(player) == ["c", "y", "a", "b", "x"]);
    assert_eq!(player.now(0.0).segment, segment, "playback was interrupted");
    player.skip(true);
    expect(&mut player, "y.wav", 1, 5);
    assert_eq!(player.playlist().entries[1].duration, Some(1.0));
    assert_eq!(player.playlist().entries[1].file.as_deref(), Some(folder.path().join("y.wav").as_path()));
    assert_eq!(player.status().track_errors.count, 0);
}

#[test]
fn the_next_track_is_reported_once_it_is_open() {
    let (mut player, _folder) = playing(3, 60.0, Repeat::All);
    let expect_next = |player: &mut Player, wanted: Option<&str>| {
        wait_for(player, &format!("{wanted:?} follows"), |player| {
            player.status().next.map(|next| next.name.clone()).as_deref() == wanted
        });
    };
    expect_next(&mut player, Some("b.wav"));
    player.skip(true);
    expect_next(&mut player, Some("c.wav"));
    assert_eq!(player.now(0.0).track, player.status().track.id);
    let next = player.status().next.expect("a next track");
    let content = next.content.clone().expect("a file");
    assert!(matches!(content.song, crate::song::Song::File(path) if path.ends_with("c.wav")));
    player.set_order(Repeat::One, false);
    expect_next(&mut player, None);
}

#[test]
fn a_playing_track_that_is_removed_is_replaced() {
    let (mut player, folder) = playing(3, 60.0, Repeat::Off);
    player.edit(Edit::Remove(0));
    expect(&mut player, "b.wav", 0, 2);
    // Remove twice in a row, so that the successor of the first track is removed as well.
    player.edit(Edit::Append(vec![song(folder.path(), b'd', 60.0)]));
    player.edit(Edit::Remove(0));
    player.edit(Edit::Remove(0));
    expect(&mut player, "d.wav", 0, 1);
    player.edit(Edit::Remove(0));
    expect(&mut player, "nothing to play", 0, 0);
    assert!(player.playlist().entries.is_empty());
    player.edit(Edit::Append(vec![song(folder.path(), b'e', 60.0)]));
    expect(&mut player, "e.wav", 0, 1);
}

#[test]
fn an_ended_list_continues_with_appended_tracks() {
    let (mut player, folder) = playing(2, 0.25, Repeat::Off);
    wait_for(&mut player, "the end", |player| player.status().ended);
    player.edit(Edit::Move { from: 1, to: 0 });
    wait_for(&mut player, "the move", |player| names(player) == ["b", "a"]);
    std::thread::sleep(Duration::from_millis(100));
    assert!(player.status().ended, "the move restarts the list");
    player.edit(Edit::Append(vec![song(folder.path(), b'x', 60.0)]));
    player.edit(Edit::Remove(1));
    expect(&mut player, "x.wav", 1, 2);
}

#[test]
fn a_removed_next_track_is_not_heard() {
    let (mut player, _folder) = playing(3, 2.0, Repeat::Off);
    // The second track is in the ring already.
    wait_for(&mut player, "the end of the first", |player| player.status().position > 1.8);
    player.edit(Edit::Remove(1));
    let mut heard = Vec::new();
    wait_for(&mut player, "the third", |player| {
        heard.push(reported(player).0);
        heard.last().is_some_and(|name| name == "c.wav")
    });
    assert!(!heard.contains(&"b.wav".to_owned()));
}

#[test]
fn edits_are_taken_back_one_after_another() {
    let (mut player, folder) = playing(4, 60.0, Repeat::All);
    let undo = |player: &Player| player.playlist().undo.as_deref().map(str::to_owned);
    let expect_names = |player: &mut Player, wanted: &[&str]| {
        wait_for(player, &format!("{wanted:?}"), |player| names(player) == wanted);
    };
    assert_eq!(undo(&player), None);
    player.edit(Edit::Undo);
    player.edit(Edit::Move { from: 3, to: 0 });
    player.edit(Edit::Remove(2));
    player.edit(Edit::Append(vec![song(folder.path(), b'x', 60.0), song(folder.path(), b'y', 60.0)]));
    player.edit(Edit::Clear);
    expect_names(&mut player, &[]);
    expect(&mut player, "nothing to play", 0, 0);
    assert_eq!(undo(&player).as_deref(), Some("clear the list"));
    player.edit(Edit::Undo);
    // The earlier track plays again.
    expect(&mut player, "a.wav", 1, 5);
    expect_names(&mut player, &["d", "a", "c", "x", "y"]);
    assert_eq!(undo(&player).as_deref(), Some("add 2 tracks"));
    player.play_entry(3);
    expect(&mut player, "x.wav", 3, 5);
    // Taking back the addition removes the playing track.
    player.edit(Edit::Undo);
    expect_names(&mut player, &["d", "a", "c"]);
    expect(&mut player, "a.wav", 1, 3);
    let segment = player.now(0.0).segment;
    assert_eq!(undo(&player).as_deref(), Some("remove b.wav"));
    player.edit(Edit::Undo);
    expect_names(&mut player, &["d", "a", "b", "c"]);
    assert_eq!(undo(&player).as_deref(), Some("move d.wav"));
    player.edit(Edit::Undo);
    expect_names(&mut player, &["a", "b", "c", "d"]);
    expect(&mut player, "a.wav", 0, 4);
    assert_eq!((undo(&player), player.now(0.0).segment), (None, segment), "playback was interrupted");
    player.skip(true);
    expect(&mut player, "b.wav", 1, 4);
    assert_eq!(player.status().track_errors.count, 0);
}

#[test]
fn a_list_that_dropped_files_replaced_comes_back() {
    let (mut player, folder) = playing(3, 60.0, Repeat::Off);
    player.play_entry(1);
    expect(&mut player, "b.wav", 1, 3);
    player.play_files(vec![song(folder.path(), b'x', 60.0)]);
    expect(&mut player, "x.wav", 0, 1);
    player.play_files(vec![song(folder.path(), b'y', 60.0)]);
    expect(&mut player, "y.wav", 0, 1);
    player.edit(Edit::Undo);
    expect(&mut player, "x.wav", 0, 1);
    player.set_order(Repeat::Off, true);
    player.edit(Edit::Undo);
    expect(&mut player, "b.wav", 1, 3);
    assert_eq!(names(&player), ["a", "b", "c"]);
    player.set_order(Repeat::Off, false);
    player.skip(true);
    expect(&mut player, "c.wav", 2, 3);
}
