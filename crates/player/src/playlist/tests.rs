//! Tests of lists of files, played in order.

use super::*;
use std::path::Path;

fn write_song(path: &Path) {
    let data = [0_u8; 4800];
    let mut bytes = b"RIFF".to_vec();
    bytes.extend((data.len() as u32 + 36).to_le_bytes());
    bytes.extend(b"WAVEfmt \x10\0\0\0\x01\0\x01\0");
    bytes.extend(48_000_u32.to_le_bytes());
    bytes.extend(96_000_u32.to_le_bytes());
    bytes.extend(b"\x02\0\x10\0data");
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(data);
    std::fs::write(path, bytes).unwrap();
}

fn folder_of(songs: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    songs.iter().for_each(|song| write_song(&folder.path().join(song)));
    folder
}

fn paths(folder: &tempfile::TempDir, names: &[&str]) -> Vec<PathBuf> {
    names.iter().map(|name| folder.path().join(name)).collect()
}

fn found(list: &mut Playlist, wanted: Wanted) -> (Result<usize, &'static str>, Vec<String>) {
    let mut reported = Vec::new();
    let found = match list.find(&wanted, &mut |trouble| reported.push(trouble)) {
        Found::Track(track) => Ok(track.info.entry),
        Found::Again => Err("again"),
        Found::End => Err("end"),
        Found::Nothing => Err("nothing"),
    };
    (found, reported)
}

fn replaced(files: Vec<PathBuf>) -> Wanted {
    Wanted::Files { files, playing: 0 }
}

fn following(list: &mut Playlist, after: u64) -> Result<usize, &'static str> {
    found(list, Wanted::Following { after, anew: false }).0
}

#[test]
fn the_next_track_depends_on_the_repeat_mode() {
    let folder = folder_of(&["1.wav", "3.wav"]);
    std::fs::write(folder.path().join("2.wav"), b"rubbish").unwrap();
    let open = |repeat| {
        Playlist::open(&paths(&folder, &["1.wav", "2.wav", "3.wav", "4.wav"]), repeat, false).unwrap()
    };
    let mut all = open(Repeat::All);
    assert!(all.playable && all.track_errors.is_empty() && all.first.info.count == 4);
    let (next, reported) = found(&mut all.list, Wanted::Following { after: 0, anew: false });
    assert!(
        next == Ok(2) && reported.len() == 1 && reported[0].contains("2.wav is not an audio file"),
        "{reported:?}"
    );
    let (next, reported) = found(&mut all.list, Wanted::Following { after: 2, anew: false });
    assert!(
        next == Ok(0) && reported.len() == 1 && reported[0].contains("4.wav does not exist"),
        "{reported:?}"
    );
    assert_eq!(following(&mut open(Repeat::One).list, 2), Err("again"));
    assert_eq!(found(&mut open(Repeat::One).list, Wanted::Following { after: 2, anew: true }).0, Ok(2));
    assert_eq!(following(&mut open(Repeat::Off).list, 2), Err("end"));
    for (from, steps, wanted) in [(0, 1, 2), (2, -1, 0), (0, -1, 2), (0, 4, 0), (2, 2, 0), (0, 41, 2)] {
        assert_eq!(found(&mut all.list, Wanted::Skip { from, steps }).0, Ok(wanted), "{steps} from {from}");
    }
    let mut off = open(Repeat::Off).list;
    assert_eq!(found(&mut off, Wanted::Skip { from: 0, steps: -1 }).0, Err("end"));
    assert_eq!(found(&mut off, Wanted::Skip { from: 2, steps: 9 }).0, Err("nothing"));
    assert_eq!(found(&mut off, Wanted::Skip { from: 2, steps: -9 }).0, Ok(0));
    // Once the other files are removed, the open track repeats.
    std::fs::remove_file(folder.path().join("1.wav")).unwrap();
    assert_eq!(following(&mut all.list, 2), Err("again"));
    std::fs::remove_file(folder.path().join("3.wav")).unwrap();
    let (none, reported) = found(&mut all.list, Wanted::Following { after: 2, anew: true });
    assert_eq!((none, reported.len()), (Err("nothing"), 2), "{reported:?}");
    assert!(
        reported[0].contains("3.wav does not") && reported[1].contains("none of the 4 tracks"),
        "{reported:?}"
    );
}

#[test]
fn a_shuffled_list_plays_every_track() {
    let names: Vec<String> = (0..20).map(|n| format!("{n}.wav")).collect();
    let folder = folder_of(&names.iter().map(String::as_str).collect::<Vec<_>>());
    let Opened { mut list, first, .. } = Playlist::open(&[folder.path().into()], Repeat::Off, true).unwrap();
    let mut played = vec![first.info.entry];
    while let Ok(next) = following(&mut list, played[played.len() - 1] as u64) {
        played.push(next);
    }
    let in_order: Vec<usize> = (0..20).collect();
    assert_ne!(played, in_order);
    played.sort_unstable();
    assert_eq!(played, in_order);
}

#[test]
fn one_bad_file_is_an_error_and_several_leave_silence() {
    let folder = folder_of(&[]);
    let refused = |names: &[&str]| {
        Playlist::open(&paths(&folder, names), Repeat::All, false).err().expect("an error").to_string()
    };
    std::fs::write(folder.path().join("bad.m3u"), b"\0\x01").unwrap();
    std::fs::write(folder.path().join("missing.m3u"), b"a.wav\nb.wav\n").unwrap();
    assert!(refused(&["none.flac"]).contains("none.flac does not exist"));
    assert!(refused(&["none.m3u"]).contains("none.m3u does not exist"));
    assert!(refused(&["bad.m3u"]).contains("bad.m3u is not a playlist"));
    assert!(refused(&["."]).contains("holds no tracks"));
    for names in [&["none.flac", "nil.mp3"][..], &["missing.m3u"]] {
        let mut opened = Playlist::open(&paths(&folder, names), Repeat::All, false).unwrap();
        assert!(!opened.playable && opened.track_errors.len() == 3, "{:?}", opened.track_errors);
        assert_eq!(opened.first.source.next_block(&mut Vec::new()).unwrap(), 1024);
    }
    // If there are many errors, the first errors, the number of omitted errors and the last error are reported.
    std::fs::write(folder.path().join("long.m3u"), "nowhere.wav\n".repeat(5000)).unwrap();
    let opened = Playlist::open(&paths(&folder, &["long.m3u"]), Repeat::All, true).unwrap();
    let [.., more, none] = &opened.track_errors[..] else { panic!("{:?}", opened.track_errors) };
    let reported = opened.track_errors.len() - 2;
    assert!(reported < 30 && more.starts_with(&format!("{} more", 5000 - reported)), "{reported} and {more}");
    assert!(none.contains("none of the 5000 tracks"), "{none}");
}

#[test]
fn dropped_files_become_the_list_if_they_can_be_played() {
    let folder = folder_of(&["1.wav", "2.wav", "3.wav"]);
    let mut list = Playlist::open(&paths(&folder, &["1.wav"]), Repeat::All, false).unwrap().list;
    let (none, reported) = found(&mut list, replaced(paths(&folder, &["x.wav"])));
    assert!(none == Err("nothing") && reported[0].contains("x.wav"), "{none:?}, {reported:?}");
    assert_eq!(following(&mut list, 0), Err("again"));
    assert_eq!(found(&mut list, replaced(paths(&folder, &["2.wav", "3.wav"]))).0, Ok(0));
    // The new files have new ids. The first new file follows the old track that is still playing.
    assert_eq!((following(&mut list, 1), following(&mut list, 0)), (Ok(1), Ok(0)));
}

#[test]
fn parts_of_a_file_have_their_names_and_lengths() {
    let folder = folder_of(&["disc.wav"]);
    let sheet = "FILE disc.wav WAVE\nTRACK 01 AUDIO\nTITLE \"One\"\nPERFORMER \"A\"\nINDEX 01 00:00:00\n\
                 TRACK 02 AUDIO\nTITLE \"Two\"\nINDEX 01 00:00:02\n";
    std::fs::write(folder.path().join("disc.cue"), sheet).unwrap();
    let mut opened = Playlist::open(&paths(&folder, &["disc.cue"]), Repeat::All, false).unwrap();
    assert_eq!((opened.first.info.name.as_str(), opened.first.info.count), ("A - One", 2));
    // The second track is not open yet; its data comes from the sheet.
    let shared = SharedListing::default();
    opened.list.fill_listing(shared.clone());
    let listed = &shared.tracks().entries[1];
    assert_eq!((listed.name.as_str(), listed.duration, listed.start), ("Two", None, Some(2.0 / 75.0)));
    assert!((opened.first.info.duration.unwrap() - 2.0 / 75.0).abs() < 1e-9);
    let second = opened.list.open_entry(1).unwrap();
    assert_eq!(second.info.name, "Two");
    assert!((second.info.duration.unwrap() - (0.05 - 2.0 / 75.0)).abs() < 1e-9);
}
