//! Input files: sounds, playlists and settings. Each input is written to a file in a folder of this process.

use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Once};

use mariana::config::{SettingsFile, StoredFileError};
use mariana_player::decode::{Decoder, quiet_contained_panics};
use mariana_player::playlist::{Kind, Playlist, Reference};
use mariana_player::source::FrameSource;
use mariana_player::track::{Found, Repeat, TrackList, Wanted};

use super::bytes::{Bytes, hash};
use super::random::Random;
use super::seeds;

/// Maximum number of sample frames to decode. With this limit, a hostile file takes only some seconds.
const FRAMES_MAX: usize = 1 << 21;
/// Number of sample frames to decode after each seek.
const FRAMES_AFTER_SEEK: usize = 1 << 15;

/// File extensions, chosen by the first byte of an input. The content determines the container, and the extension is
/// a hint.
pub(crate) const SOUND_ENDS: [&str; 12] =
    ["wav", "flac", "mp3", "ogg", "opus", "m4a", "aac", "aiff", "caf", "mkv", "webm", "mp4"];
pub(crate) const LIST_ENDS: [&str; 4] = ["m3u", "m3u8", "pls", "cue"];

/// Prefer a folder in memory, because a disk would take most of the time.
static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let memory = Path::new("/dev/shm");
    tempfile::tempdir_in(memory).or_else(|_| tempfile::tempdir()).unwrap()
});

/// Writes a file with these bytes. Tests run in parallel, so each kind of input has its own folder.
pub(super) fn file(folder: &str, name: &str, bytes: &[u8]) -> PathBuf {
    let folder = FOLDER.path().join(folder);
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Replaces libFuzzer's panic hook, which would abort before a codec's panic becomes an error.
pub(super) fn contain_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(quiet_contained_panics);
}

/// Opens and decodes a sound file and seeks in it.
pub(crate) fn decode(data: &[u8]) {
    contain_panics();
    let mut bytes = Bytes(data);
    let path = file("sounds", &format!("a.{}", SOUND_ENDS[bytes.below(SOUND_ENDS.len())]), bytes.0);
    // Not by ffmpeg, which takes a tenth of a second to start.
    let Ok(mut decoder) = Decoder::open_track(&path, 0) else { return };
    let info = decoder.info().clone();
    assert!(
        (mariana_music::limits::SAMPLE_RATE_MIN..=mariana_music::limits::SAMPLE_RATE_MAX)
            .contains(&info.sample_rate),
        "{info:?}"
    );
    assert!(info.source_channels <= usize::from(mariana_player::limits::CHANNELS_MAX), "{info:?}");
    assert!(
        info.duration
            .is_none_or(|seconds| (0.0..=mariana_player::limits::CLAIMED_DURATION_MAX).contains(&seconds)),
        "{info:?}"
    );
    assert!(info.scene_gain.is_finite() && info.scene_gain >= 0.0, "{info:?}");
    play(&mut decoder, FRAMES_MAX);
    let mut random = Random(hash(data));
    for _ in 0..3 {
        let seconds = match random.below(4) {
            0 => info.duration.unwrap_or(1.0) * f64::from(random.between(0.0, 1.1)),
            1 => f64::from(f32::from_bits(random.word() as u32)),
            _ => f64::from(random.between(0.0, 2.0)),
        };
        let Ok(reached) = decoder.seek(seconds) else { return };
        assert!(reached.is_finite() && reached >= 0.0, "a seek to {seconds} s reached {reached} s");
        play(&mut decoder, FRAMES_AFTER_SEEK);
    }
}

/// Decodes `enough` frames, or all frames if the source has fewer.
fn play(source: &mut dyn FrameSource, enough: usize) {
    let (mut block, mut played) = (Vec::new(), 0);
    while played < enough {
        block.clear();
        match source.next_block(&mut block) {
            Ok(frames) => {
                assert_eq!(frames, block.len());
                if frames == 0 {
                    return;
                }
                played += frames;
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                return;
            }
        }
    }
}

/// Reads a playlist in a folder with two songs, and plays the playlist.
pub(crate) fn lists(data: &[u8]) {
    contain_panics();
    let mut bytes = Bytes(data);
    let end = LIST_ENDS[bytes.below(LIST_ENDS.len())];
    let path = file("lists", &format!("list.{end}"), bytes.0);
    for song in ["a.wav", "b.wav"] {
        if !path.with_file_name(song).exists() {
            file("lists", song, &seeds::wave(8_000, 4_000));
        }
    }
    let Some(kind) = Kind::of(&path) else { panic!("{end} is not a playlist extension") };
    let items = match kind.read(&path, bytes.0) {
        Ok(items) => items,
        Err(error) => return assert!(error.to_string().contains("list."), "{error}"),
    };
    assert!(!items.is_empty() && items.len() <= mariana_player::limits::PLAYLIST_LOOKS_MAX);
    for cut in items.iter().filter_map(|item| item.cut) {
        assert!(cut.end.is_none_or(|end| end >= cut.start), "{cut:?}");
    }
    // Do not open files elsewhere on this machine.
    let within = |reference: &Reference| match reference {
        Reference::Path(path) => stays_within(path),
        Reference::Address(_) => true,
    };
    if items.len() > 200 || !items.iter().all(|item| within(&item.reference)) {
        return;
    }
    let Ok(mut opened) = Playlist::open(&[path], Repeat::Off, false) else { return };
    assert!(opened.first.info.count <= mariana_player::limits::PLAYLIST_TRACKS_MAX);
    if !opened.playable {
        return;
    }
    let mut track = opened.first;
    for _ in 0..8 {
        assert!(track.info.entry < track.info.count);
        assert!(track.info.duration.is_none_or(|seconds| seconds >= 0.0));
        play(&mut *track.source, FRAMES_AFTER_SEEK);
        if let Ok(reached) = track.source.seek(0.3) {
            assert!(reached.is_finite() && reached >= 0.0);
            play(&mut *track.source, FRAMES_AFTER_SEEK);
        }
        let wanted = Wanted::Following { after: track.info.id, anew: true };
        let Found::Track(next) = opened.list.find(&wanted, &mut |reported| assert!(!reported.is_empty()))
        else {
            return;
        };
        track = next;
    }
}

/// True if a path is within the playlist's folder and has no `..`.
fn stays_within(path: &Path) -> bool {
    let folder = FOLDER.path().join("lists");
    path.strip_prefix(folder).is_ok_and(|rest| !rest.components().any(|part| part.as_os_str() == ".."))
}

/// Reads a settings file, changes the settings and reads the file again.
pub(crate) fn settings(data: &[u8]) {
    let path = file("settings", "settings.toml", data);
    let (mut file, reported) = SettingsFile::open(Some(path.clone()));
    let in_range = |file: &SettingsFile| {
        file.settings().latency_ms.values().all(|shift| shift.abs() <= mariana_player::limits::LATENCY_MS_MAX)
    };
    assert!(in_range(&file));
    assert!(reported.is_none_or(|error| error.to_string().contains("settings.toml")));
    file.change(|settings| settings.microphone = Some("fuzz".into())).unwrap();
    let (again, reported) = SettingsFile::open(Some(path));
    // If the settings are from a newer version, the file keeps them, so opening the file reports them again.
    let readable = reported.as_ref().is_none_or(|error| matches!(error, StoredFileError::Newer { .. }));
    assert!(readable, "the written settings cannot be read: {reported:?}");
    assert_eq!(again.settings(), file.settings());
    assert!(in_range(&again));
}
