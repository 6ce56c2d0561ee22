//! The cycle of scenes for the commands "next scene" and "previous scene".

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::folder::Folder;
use super::{SceneSource, is_scene_file, shipped_names};

/// The cycle of scenes that contains a start scene, whichever scene is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneList {
    start: SceneSource,
}

impl SceneList {
    /// Returns the cycle that contains `start`. The cycle begins with `start` if this is a formula, or with the scene
    /// files of the folder if `start` is a file. The shipped scenes follow. Each group is sorted by name.
    pub fn around(start: &SceneSource) -> Self {
        Self { start: start.clone() }
    }

    /// Returns the scene after `current`. Reads the folder again. If the cycle lacks `current`, `current` is inserted
    /// in sorted order.
    pub fn next(&self, current: &SceneSource) -> SceneSource {
        let (mut round, at) = self.round(current);
        let next = (at + 1) % round.len();
        round.swap_remove(next)
    }

    /// Returns the scene before `current`, like [`Self::next`].
    pub fn previous(&self, current: &SceneSource) -> SceneSource {
        let (mut round, at) = self.round(current);
        let previous = (at + round.len() - 1) % round.len();
        round.swap_remove(previous)
    }

    /// Returns all scenes of the cycle, including `current`. Reads the folder again.
    pub fn all(&self, current: &SceneSource) -> Vec<SceneSource> {
        self.round(current).0
    }

    /// Returns the cycle, including `current`, and the index of `current`.
    fn round(&self, current: &SceneSource) -> (Vec<SceneSource>, usize) {
        let mut round: Vec<SceneSource> = shipped_names().into_iter().map(SceneSource::Shipped).collect();
        if let Some(file) = current.file().or(self.start.file()) {
            round.extend(scene_files(file).into_iter().map(SceneSource::File));
        }
        // The folder listing lacks a start scene whose extension is not that of scene files.
        round.push(self.start.clone());
        if self.start.file().is_some_and(|file| !file.is_file()) {
            round.pop();
        }
        round.push(current.clone());
        round.sort_by(|a, b| rank(a).cmp(&rank(b)));
        round.dedup();
        let at = round.iter().position(|scene| scene == current).unwrap_or(0);
        (round, at)
    }
}

fn rank(scene: &SceneSource) -> (u8, &OsStr, &OsStr) {
    match scene {
        SceneSource::Formula(text) => (0, OsStr::new(text), OsStr::new("")),
        SceneSource::File(path) => (1, path.file_name().unwrap_or_default(), path.as_os_str()),
        SceneSource::Shipped(name) => (2, OsStr::new(name), OsStr::new("")),
        SceneSource::Blend(blend) => rank(&blend.to.source),
    }
}

/// Returns the scene files in the folder of `file`, without hidden files. The list is empty if the folder cannot be
/// read.
fn scene_files(file: &Path) -> Vec<PathBuf> {
    let folder = Folder::of(file);
    let shown = folder.beside("").into_iter().filter(|name| !name.starts_with('.'));
    let paths = shown.map(|name| folder.path(&name));
    paths.filter(|path| is_scene_file(path) && path.is_file()).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn folder(names: &[&str]) -> (tempfile::TempDir, impl Fn(&str) -> SceneSource) {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            fs::write(folder.path().join(name), "y").unwrap();
        }
        let path = folder.path().to_owned();
        (folder, move |name: &str| SceneSource::File(path.join(name)))
    }

    fn shipped() -> Vec<SceneSource> {
        shipped_names().into_iter().map(SceneSource::Shipped).collect()
    }

    /// Walks the cycle from `start`, checks that `previous` is the inverse of `next`, and returns the visited
    /// scenes.
    #[track_caller]
    fn round(start: &SceneSource) -> Vec<SceneSource> {
        let list = SceneList::around(start);
        let mut met = vec![start.clone()];
        loop {
            let last = met.last().unwrap().clone();
            let next = list.next(&last);
            assert_eq!(list.previous(&next), last);
            if next == *start {
                return met;
            }
            met.push(next);
            assert!(met.len() < 100, "the cycle does not return to its start: {met:?}");
        }
    }

    #[test]
    fn files_of_the_folder_and_shipped_scenes_form_the_cycle() {
        let (_kept, file) = folder(&["b.scene", "a.scene", ".hidden.scene", "note.txt", "c.scene"]);
        let mut expected = vec![file("b.scene"), file("c.scene")];
        expected.extend(shipped());
        expected.push(file("a.scene"));
        assert_eq!(round(&file("b.scene")), expected);
    }

    #[test]
    fn without_a_folder_the_cycle_has_only_shipped_scenes() {
        assert_eq!(round(&shipped()[0]), shipped());
        let formula = SceneSource::Formula("y".into());
        let mut expected = vec![formula.clone()];
        expected.extend(shipped());
        assert_eq!(round(&formula), expected);
    }

    #[test]
    fn new_files_appear_and_a_deleted_one_keeps_its_place() {
        let (kept, file) = folder(&["a.scene", "b.scene", "c.scene"]);
        let list = SceneList::around(&file("b.scene"));
        fs::write(kept.path().join("bb.scene"), "y").unwrap();
        assert_eq!(list.next(&file("b.scene")), file("bb.scene"));
        fs::remove_file(kept.path().join("b.scene")).unwrap();
        assert_eq!(list.next(&file("b.scene")), file("bb.scene"));
        assert_eq!(list.previous(&file("b.scene")), file("a.scene"));
        assert_eq!(list.next(&file("a.scene")), file("bb.scene"));
        drop(kept);
        assert_eq!(list.next(&file("b.scene")), shipped()[0]);
        assert_eq!(list.previous(&shipped()[0]), *shipped().last().unwrap());
    }

    #[test]
    fn a_start_with_another_extension_stays_in_the_cycle() {
        let (_kept, file) = folder(&["a.scene", "b.txt", "c.txt"]);
        let mut expected = vec![file("b.txt")];
        expected.extend(shipped());
        expected.push(file("a.scene"));
        assert_eq!(round(&file("b.txt")), expected);
    }

    #[test]
    fn a_folder_is_not_a_scene() {
        let (kept, file) = folder(&["a.scene"]);
        fs::create_dir(kept.path().join("b.scene")).unwrap();
        assert_eq!(SceneList::around(&file("a.scene")).next(&file("a.scene")), shipped()[0]);
    }
}
