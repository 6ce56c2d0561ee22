//! The list of a player that plays.

use std::path::Path;
use std::time::Duration;

use super::tests::wait_for;
use super::*;
use crate::playlist::Playlist;
use mariana_testing::wave::write_wav;

/// A player of songs of that many seconds, named by the first letters of the alphabet, and the folder that they are in.
fn playing(songs: usize, seconds: f64, repeat: Repeat) -> (Player, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let files: Vec<PathBuf> = (b'a'..).take(songs).map(|name| song(folder.path(), name, seconds)).collect();
    let opened = Playlist::open(&files, repeat, false).expect("a list");
    let options = PlayerOptions { repeat, output: OutputChoice::Silent, ..PlayerOptions::default() };
    let player = Player::start(opened.first, Box::new(opened.list), options).expect("it starts");
    (player, folder)
}

fn song(folder: &Path, name: u8, seconds: f64) -> PathBuf {
    let path = folder.join(format!("{}.wav", char::from(name)));
    write_wav(&path, 8000, 1, std::iter::repeat_n(0.0, (seconds * 8000.0) as usize));
    path
}

/// What plays, as name, index and count.
fn reported(player: &mut Player) -> (String, usize, usize) {
    let track = player.status().track;
    (track.name.clone(), track.entry, track.count)
}

/// Waits until this plays.
fn expect(player: &mut Player, name: &str, entry: usize, count: usize) {
    wait_for(player, &format!("{name} as {entry} of {count}"), |player| {
        reported(player) == (name.to_owned(), entry, count)
    });
}

fn names(player: &Player) -> Vec<String> {
    player.playlist().entries.iter().map(|track| track.name.replace(".wav", "")).collect()
}

#[test]
fn what_plays_goes_on_and_is_told_where_it_stands_now() {
    let (mut player, folder) = playing(4, 60.0, Repeat::All);
    wait_for(&mut player, "it moves", |player| player.status().position > 0.05);
    let segment = player.now(0.0).segment;
    player.play_entry(2);
    expect(&mut player, "c.wav", 2, 4);
    wait_for(&mut player, "another segment", |player| player.now(0.0).segment > segment);
    let segment = player.now(0.0).segment;
    player.move_entry(2, 0);
    expect(&mut player, "c.wav", 0, 4);
    player.move_entry(3, 0);
    expect(&mut player, "c.wav", 1, 4);
    player.remove_entry(0);
    expect(&mut player, "c.wav", 0, 3);
    player.append_files(vec![song(folder.path(), b'x', 1.0), song(folder.path(), b'y', 1.0)]);
    expect(&mut player, "c.wav", 0, 5);
    assert_eq!(names(&player), ["c", "a", "b", "x", "y"]);
    player.move_entry(9, 0);
    player.move_entry(0, 5);
    player.remove_entry(5);
    player.play_entry(5);
    player.move_entry(4, 1);
    wait_for(&mut player, "the last change", |player| names(player) == ["c", "y", "a", "b", "x"]);
    assert_eq!(player.now(0.0).segment, segment, "it did not go on");
    player.skip(true);
    expect(&mut player, "y.wav", 1, 5);
    assert_eq!(player.playlist().entries[1].duration, Some(1.0));
    assert_eq!(player.playlist().entries[1].file.as_deref(), Some(folder.path().join("y.wav").as_path()));
    assert_eq!(player.status().track_errors.count, 0);
}

#[test]
fn what_follows_is_told_as_soon_as_it_is_open() {
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
    let next = player.status().next.expect("it was told");
    let content = next.reopen.content().expect("it is a file").clone();
    assert!(matches!(content.song, crate::song::Song::File(path) if path.ends_with("c.wav")));
    player.set_order(Repeat::One, false);
    expect_next(&mut player, None);
}

#[test]
fn a_track_that_is_removed_while_it_plays_makes_way() {
    let (mut player, folder) = playing(3, 60.0, Repeat::Off);
    player.remove_entry(0);
    expect(&mut player, "b.wav", 0, 2);
    // Twice at once: what would follow the first is gone as well.
    player.append_files(vec![song(folder.path(), b'd', 60.0)]);
    player.remove_entry(0);
    player.remove_entry(0);
    expect(&mut player, "d.wav", 0, 1);
    player.remove_entry(0);
    expect(&mut player, "nothing to play", 0, 0);
    assert!(player.playlist().entries.is_empty());
    player.append_files(vec![song(folder.path(), b'e', 60.0)]);
    expect(&mut player, "e.wav", 0, 1);
}

#[test]
fn a_list_that_has_ended_goes_on_with_what_is_appended() {
    let (mut player, folder) = playing(2, 0.25, Repeat::Off);
    wait_for(&mut player, "the end", |player| player.status().ended);
    player.move_entry(1, 0);
    wait_for(&mut player, "the move", |player| names(player) == ["b", "a"]);
    std::thread::sleep(Duration::from_millis(100));
    assert!(player.status().ended, "it begins again because it was moved");
    player.append_files(vec![song(folder.path(), b'x', 60.0)]);
    player.remove_entry(1);
    expect(&mut player, "x.wav", 1, 2);
}

#[test]
fn what_is_about_to_follow_is_not_heard_once_it_is_removed() {
    let (mut player, _folder) = playing(3, 2.0, Repeat::Off);
    // The second one is in the ring already.
    wait_for(&mut player, "the end of the first", |player| player.status().position > 1.8);
    player.remove_entry(1);
    let mut heard = Vec::new();
    wait_for(&mut player, "the third", |player| {
        heard.push(reported(player).0);
        heard.last().is_some_and(|name| name == "c.wav")
    });
    assert!(!heard.contains(&"b.wav".to_owned()));
}

#[test]
fn a_source_without_a_list_is_a_list_of_one() {
    let list = super::tests::silent(true);
    let mut player = Player::start_alone(Track::silence(0, 1).source, list).expect("it starts");
    assert_eq!(player.playlist().entries.len(), 1);
    player.remove_entry(0);
    player.append_files(vec!["x.wav".into()]);
    wait_for(&mut player, "it moves", |player| player.status().position > 0.1);
    assert_eq!(player.playlist().entries.len(), 1);
}
