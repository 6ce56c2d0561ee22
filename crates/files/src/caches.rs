//! Folders of files that may be deleted at any time. The least recently used files are deleted first.

use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Marks a file as used. If that fails, the file may be deleted too early.
pub fn touch(path: &Path) {
    let _ = File::options().write(true).open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// Deletes the least recently used of the files with these `endings`, until the others cost at most `most` together.
pub fn make_room(folder: &Path, endings: &[&str], cost: impl Fn(&Metadata) -> u64, most: u64) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let file = |path: PathBuf| {
        let is_ours = endings.iter().any(|ending| path.extension() == Some(OsStr::new(ending)));
        let about = path.symlink_metadata().ok().filter(|about| is_ours && about.is_file())?;
        Some((about.modified().ok()?, cost(&about), path))
    };
    let mut files: Vec<_> = entries.flatten().filter_map(|entry| file(entry.path())).collect();
    files.sort();
    let mut sum: u64 = files.iter().map(|(_, its, _)| its).sum();
    for (_, its, path) in files {
        if sum <= most {
            break;
        }
        if fs::remove_file(path).is_ok() {
            sum -= its;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_within_the_limit_and_other_files_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["1.png", "2.png", "3.png", "4"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        make_room(folder.path(), &["png"], |_| 1, 3);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
        make_room(folder.path(), &["png"], |_| 1, 1);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        make_room(&folder.path().join("missing"), &["png"], |_| 1, 3);
    }
}
