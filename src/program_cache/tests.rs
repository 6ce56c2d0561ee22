use std::fs::File;
use std::time::{Duration, SystemTime};

use super::*;

fn cache() -> (tempfile::TempDir, ProgramCache) {
    let folder = tempfile::tempdir().unwrap();
    let cache = ProgramCache::in_folder(folder.path().join("mariana/programs"));
    (folder, cache)
}

fn names(cache: &ProgramCache) -> Vec<String> {
    let entries = fs::read_dir(&cache.folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_program_is_found_in_the_next_run_for_the_same_driver_and_sources_only() {
    let (_folder, cache) = cache();
    let key = ProgramKey::of(["driver 1", "text"]);
    assert_eq!(cache.load(key), None);
    cache.save(key, b"code");
    let next = ProgramCache::in_folder(cache.folder.clone());
    assert_eq!(next.load(key).as_deref(), Some(&b"code"[..]));
    for other in [["driver 2", "text"], ["driver 1", "texts"], ["driver 1t", "ext"]] {
        assert_eq!(next.load(ProgramKey::of(other)), None, "{other:?}");
    }
    next.discard(key);
    assert_eq!(cache.load(key), None);
    assert!(names(&cache).is_empty());
    // The store without a cache.
    ().save(key, b"code");
    assert!(().load(key).is_none() && ().attempt(key, Work::Taking).is_none());
}

#[test]
fn a_damaged_or_foreign_file_is_removed() {
    let (_folder, cache) = cache();
    let [key, other] = ["a", "b"].map(|text| ProgramKey::of([text]));
    cache.save(key, b"code");
    let path = cache.path(key, PROGRAM);
    let whole = fs::read(&path).unwrap();
    fs::copy(&path, cache.path(other, PROGRAM)).unwrap();
    assert_eq!(cache.load(other), None);
    assert_eq!(names(&cache), [format!("{key}.program")], "the file with another key was not removed");
    for damaged in [&whole[..whole.len() - 1], b"", &[0; 100]] {
        fs::write(&path, damaged).unwrap();
        assert_eq!(cache.load(key), None);
        assert!(!path.exists());
    }
    fs::create_dir(&path).unwrap();
    assert_eq!(cache.load(key), None);
    let large = vec![0; limits::KEPT_PROGRAM_BYTES_MAX + 1];
    cache.save(other, &large);
    fs::write(cache.path(other, PROGRAM), sealed(&[other.bytes(), &large[..]].concat())).unwrap();
    assert_eq!(cache.load(other), None);
}

#[test]
fn no_damaged_program_is_loaded() {
    let (_folder, cache) = cache();
    let key = ProgramKey::of(["driver", "text"]);
    cache.save(key, b"machine code");
    let path = cache.path(key, PROGRAM);
    let whole = fs::read(&path).unwrap();
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 1;
        for bytes in [&damaged[..], &whole[..at]] {
            fs::write(&path, bytes).unwrap();
            assert_eq!(cache.load(key), None, "byte {at}");
        }
    }
    fs::write(&path, [&whole[..], &[0]].concat()).unwrap();
    assert_eq!(cache.load(key), None);
}

#[test]
fn a_folder_that_cannot_be_written_causes_no_error() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    let cache = ProgramCache::in_folder(folder.path().join("taken/programs"));
    let key = ProgramKey::of([]);
    cache.save(key, b"code");
    cache.record_refused(key);
    cache.record_crash(key);
    assert!(cache.load(key).is_none() && cache.given_up(key).is_none());
    assert!(cache.attempt(key, Work::Compiling).is_none() && cache.death(key).is_none());
    assert!(cache.complained.load(Ordering::Relaxed));
}

#[test]
fn the_least_recently_used_files_are_deleted_first() {
    let (_folder, cache) = cache();
    let keys = ["a", "b", "c"].map(|text| ProgramKey::of([text]));
    for (age, key) in (1..).zip(keys) {
        cache.save(key, &[0; 5000]);
        let file = File::options().write(true).open(cache.path(key, PROGRAM)).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(100 * age)).unwrap();
    }
    let folder = cache.folder.clone();
    fs::write(folder.join("notes.txt"), "of the user's").unwrap();
    // Loading makes the oldest program the most recently used one.
    assert!(cache.load(keys[2]).is_some());
    cache.forget_oldest(2 * (5000 + 33));
    assert_eq!(keys.map(|key| cache.load(key).is_some()), [true, false, true]);
    cache.forget_oldest(0);
    assert_eq!(names(&cache), ["notes.txt"]);
}

#[test]
fn a_crash_is_reported_once_and_running_or_finished_work_is_no_crash() {
    let (_folder, cache) = cache();
    let key = ProgramKey::of([]);
    let path = cache.path(key, ATTEMPT);
    for work in [Work::Taking, Work::Compiling] {
        let attempt = cache.attempt(key, work).unwrap();
        assert_eq!(cache.death(key), None, "the work is still running");
        assert!(cache.attempt(key, work).is_none(), "two attempts at the same time");
        let mark = fs::read_to_string(&path).unwrap();
        drop(attempt);
        assert!(!path.exists(), "finished work left its mark");
        fs::write(&path, &mark).unwrap();
        assert_eq!(cache.death(key), None, "a killed process counts as a crash");
        fs::write(&path, mark + attempt::CRASHED).unwrap();
        assert_eq!((cache.death(key), cache.death(key)), (Some(work), None));
    }
    fs::write(&path, "something else").unwrap();
    assert_eq!(cache.death(key), None);
}

#[test]
fn a_program_stays_given_up_until_the_file_is_deleted() {
    let (_folder, cache) = cache();
    let [key, other] = ["a", "b"].map(|text| ProgramKey::of([text]));
    for why in [GivenUp::Refused, GivenUp::DiedTwice] {
        cache.give_up(key, why);
        let (known, path) = cache.given_up(key).unwrap();
        assert_eq!((known, cache.given_up(other)), (why, None));
        fs::remove_file(path).unwrap();
        assert_eq!(cache.given_up(key), None);
    }
}

#[test]
fn one_crash_while_compiling_banned_a_program_for_ever() {
    let (_folder, cache) = cache();
    let key = ProgramKey::of(["driver 1", "text"]);
    let path = cache.folder.clone();
    let start = || ProgramCache::in_folder(path.clone());
    let why = |run: &ProgramCache| run.given_up(key).map(|(why, _)| why);
    let die = |run: ProgramCache| {
        assert_eq!(why(&run), None, "the program is not tried");
        let attempt = run.attempt(key, Work::Compiling).unwrap();
        let mark = run.path(key, ATTEMPT);
        let content = fs::read_to_string(&mark).unwrap();
        drop(attempt);
        fs::write(mark, content + attempt::CRASHED).unwrap();
    };
    let find_out = || {
        let run = start();
        assert_eq!(run.death(key), Some(Work::Compiling));
        run.record_crash(key);
        run
    };
    die(start());
    let next = find_out();
    assert_eq!(
        [why(&next), why(&next)],
        [Some(GivenUp::DiedOnce); 2],
        "the program is not skipped in the next run"
    );
    let retried = start();
    assert_eq!(why(&retried), None, "a later run does not try it");
    retried.record_compiled(key);
    assert!(names(&cache).is_empty(), "the crash is not forgotten");
    // Two crashes without a success in between suffice.
    die(start());
    find_out();
    die(start());
    find_out();
    assert_eq!([why(&start()), why(&start())], [Some(GivenUp::DiedTwice); 2]);
    // Another version of the driver has another key.
    assert_eq!(start().given_up(ProgramKey::of(["driver 2", "text"])), None);
}
