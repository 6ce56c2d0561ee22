//! Tests of folders and lists on disk, valid and broken.

use super::*;

fn folder_of(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn gathered(folder: &Path, names: &[&str]) -> (Vec<String>, Vec<String>) {
    let paths: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
    let found = gather(&paths);
    let name = |entry: &PlaylistEntry| match &entry.content.song {
        Song::File(path) => path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned(),
        Song::Embedded { name, .. } => (*name).into(),
    };
    (found.entries.iter().map(name).collect(), found.track_errors.iter().map(ToString::to_string).collect())
}

#[test]
fn folders_are_read_to_the_bottom_in_natural_order() {
    let files = [
        "10.MP3",
        "9.flac",
        "a/2.ogg",
        "a/1.wav",
        "B.m4a",
        "cover.jpg",
        ".hidden.mp3",
        "list.m3u",
        "c/x.txt",
    ];
    let folder = folder_of(&files.map(|name| (name, "")));
    let (names, track_errors) = gathered(folder.path(), &["", "9.flac"]);
    assert_eq!(names, ["9.flac", "10.MP3", "a/1.wav", "a/2.ogg", "B.m4a", "9.flac"]);
    assert_eq!(track_errors, [""; 0]);
    let (names, track_errors) = gathered(folder.path(), &["c"]);
    assert!(
        names.is_empty() && track_errors.len() == 1 && track_errors[0].contains("c holds no tracks"),
        "{track_errors:?}"
    );
}

#[test]
fn lists_name_files_folders_and_lists() {
    let folder = folder_of(&[
        ("a.m3u", "x.mp3\nsub/b.pls\nmissing.m3u\nmusic\nhttps://radio/live\n"),
        ("sub/b.pls", "[playlist]\nFile1=y.mp3\n"),
        ("music/1.ogg", ""),
    ]);
    let (names, track_errors) = gathered(folder.path(), &["a.m3u"]);
    // A missing file is reported when it is played.
    assert_eq!(names, ["x.mp3", "sub/y.mp3", "missing.m3u", "music/1.ogg"]);
    assert!(
        track_errors.len() == 1 && track_errors[0].contains("https://radio/live in a.m3u"),
        "{track_errors:?}"
    );
}

#[test]
fn lists_that_contain_themselves_end() {
    let folder =
        folder_of(&[("a.m3u", "1.mp3\nb.m3u\n2.mp3\n"), ("b.m3u", "3.mp3\n./a.m3u\nb.m3u\n4.mp3\n")]);
    let (names, track_errors) = gathered(folder.path(), &["a.m3u", "a.m3u"]);
    let once = ["1.mp3", "3.mp3", "4.mp3", "2.mp3"];
    assert_eq!(names, [once, once].concat());
    assert!(track_errors.len() == 4 && track_errors[0].contains("a.m3u contains itself"), "{track_errors:?}");
}

#[cfg(unix)]
#[test]
fn links_in_circles_end() {
    let folder = folder_of(&[("a/1.mp3", ""), ("b/2.mp3", "")]);
    for (link, target) in [("a/up", ".."), ("a/b", "../b"), ("b/a", "../a"), ("b/self", ".")] {
        std::os::unix::fs::symlink(target, folder.path().join(link)).unwrap();
    }
    let (names, _) = gathered(folder.path(), &[""]);
    assert_eq!(names.len(), 2, "{names:?}");
}

#[test]
fn nesting_is_bounded() {
    let deep: Vec<(String, String)> = (0..limits::PLAYLIST_DEPTH_MAX + 2)
        .map(|n| (format!("{n}.m3u"), format!("{n}.mp3\n{}.m3u", n + 1)))
        .collect();
    let files: Vec<(&str, &str)> = deep.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    let folder = folder_of(&files);
    let (names, track_errors) = gathered(folder.path(), &["0.m3u"]);
    assert_eq!(names.len(), limits::PLAYLIST_DEPTH_MAX);
    let limit = limits::PLAYLIST_DEPTH_MAX.to_string();
    assert!(track_errors.len() == 1 && track_errors[0].contains(&limit), "{track_errors:?}");
}

#[test]
fn excessive_sizes_are_bounded_and_reported() {
    let tracks = limits::PLAYLIST_TRACKS_MAX;
    let folder = folder_of(&[
        ("long.m3u", &"x.mp3\n".repeat(tracks + 5)),
        ("wide.m3u", &"long.m3u\n".repeat(limits::PLAYLIST_LISTS_MAX + 9)),
        ("addresses.m3u", &"http://x\n".repeat(1000)),
        ("many.m3u", &"none.m3u\n".repeat(limits::PLAYLIST_LISTS_MAX + 9)),
        ("none.m3u", "# nothing\n"),
        ("large.m3u", &"#".repeat(limits::PLAYLIST_BYTES_MAX + 1)),
    ]);
    for list in ["long.m3u", "wide.m3u"] {
        let (names, track_errors) = gathered(folder.path(), &[list]);
        assert_eq!(names.len(), tracks);
        assert!(track_errors[0].contains(&format!("more than {tracks} tracks")), "{track_errors:?}");
    }
    assert_eq!(gathered(folder.path(), &["addresses.m3u"]).1.len(), TRACK_ERRORS_KEPT);
    let limit = limits::PLAYLIST_LISTS_MAX;
    let mut many = gather(&[folder.path().join("many.m3u")]);
    assert_eq!(many.lists, limit);
    assert!(many.entries.is_empty() && many.track_errors.pop().is_some());
    let (names, track_errors) = gathered(folder.path(), &["large.m3u"]);
    assert!(
        names.is_empty() && track_errors[0].contains(&limits::PLAYLIST_BYTES_MAX.to_string()),
        "{track_errors:?}"
    );
}

#[cfg(unix)]
#[test]
fn pipes_and_unreadable_files_are_reported() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder_of(&[("secret.m3u", "a.mp3"), ("ok.m3u", "a.mp3")]);
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe.m3u")).status().unwrap();
    assert!(made.success());
    fs::set_permissions(folder.path().join("secret.m3u"), fs::Permissions::from_mode(0o000)).unwrap();
    let (names, track_errors) = gathered(folder.path(), &["pipe.m3u", "secret.m3u", "ok.m3u"]);
    assert!(track_errors[0].contains("pipe.m3u is not a regular file"), "{track_errors:?}");
    // A privileged user can read the file despite its permissions.
    let may_read = fs::read(folder.path().join("secret.m3u")).is_ok();
    assert_eq!((names.len(), track_errors.len()), if may_read { (2, 1) } else { (1, 2) });
}
