//! The file of controller mappings, `knobs.toml`, next to the settings file. A change applies at once in memory; a
//! writer thread applies it to the file's current contents, so that changes by other windows or by an editor are
//! kept. A damaged file is renamed before a new one is written.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::stored_file::{KNOBS, StoredFileError};
use mariana_control::midi::{Mapping, MappingFile};
use mariana_files::Folders;
use mariana_work::{Worker, in_order};

/// A change to the controller mappings.
#[derive(Debug, Clone, PartialEq)]
pub enum KnobEdit {
    /// Adds a learned mapping.
    Add(Mapping),
    /// Removes a mapping.
    Remove(Mapping),
    /// Replaces the first mapping by the second.
    Change(Mapping, Mapping),
    /// Sets whether a device's MIDI clock controls the tempo.
    Clock(bool),
}

/// The controller mappings and the thread that writes them.
pub struct KnobMemory {
    /// Without a settings folder, it writes nothing, and mappings last until the program ends.
    writer_thread: Worker<KnobEdit, Kept>,
    /// The current mappings. Only the pick-up state of the knobs may be changed here.
    pub file: MappingFile,
}

type Kept = Result<MappingFile, StoredFileError>;

impl KnobMemory {
    /// Opens the user's file and returns its problem, if any. A missing file counts as empty.
    pub fn among(folders: &Folders) -> (Self, Option<StoredFileError>) {
        Self::open(folders.config.as_ref().map(|config| config.join("knobs.toml")))
    }

    /// Opens the file at `path`.
    pub fn open(path: Option<PathBuf>) -> (Self, Option<StoredFileError>) {
        let (file, trouble) = match path.as_deref().map(|path| KNOBS.read(path, MappingFile::read)) {
            None => (MappingFile::default(), None),
            Some(Ok(file)) => (file, None),
            Some(Err(trouble)) => (MappingFile::default(), Some(trouble)),
        };
        let keeper = |path: PathBuf| {
            let work = move |edit| Some(keep(&path, &edit));
            in_order("knobs", || {}, || work).unwrap_or_default().finished_at_drop(Duration::MAX)
        };
        (Self { writer_thread: path.map(keeper).unwrap_or_default(), file }, trouble)
    }

    /// Changes the mappings at once, and the file soon after.
    pub fn change(&mut self, edit: &KnobEdit) {
        apply(&mut self.file, edit);
        self.writer_thread.send(edit.clone());
    }

    /// Returns the next result of a write, if any, and adopts the contents of the file.
    ///
    /// # Errors
    /// Fails if the file cannot be read or written. The change then lasts until the program ends.
    pub fn poll(&mut self) -> Option<Result<(), StoredFileError>> {
        Some(self.writer_thread.poll()?.map(|after| {
            if self.writer_thread.is_idle() && after.mappings.list() != self.file.mappings.list() {
                self.file = after;
            }
        }))
    }
}

fn keep(path: &Path, edit: &KnobEdit) -> Kept {
    let mut after = KNOBS.read_or_rename(path, MappingFile::read)?.unwrap_or_default();
    apply(&mut after, edit);
    let text = after.text().map_err(|error| KNOBS.refused(path, "written", &error))?;
    KNOBS.write(path, &text)?;
    Ok(after)
}

fn apply(file: &mut MappingFile, edit: &KnobEdit) {
    let mappings = &mut file.mappings;
    let place = |wanted: &Mapping| mappings.list().iter().position(|one| one == wanted);
    match edit {
        KnobEdit::Add(mapping) => drop(mappings.add(mapping.clone())),
        KnobEdit::Remove(mapping) => {
            if let Some(place) = place(mapping) {
                mappings.remove(place);
            }
        }
        KnobEdit::Change(before, after) => {
            if let Some(place) = place(before) {
                mappings.change(place, |mapping| mapping.clone_from(after));
            }
        }
        KnobEdit::Clock(on) => file.clock = *on,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::midi::{Source, Target};

    fn mapping(name: &str) -> Mapping {
        let target = Target::Param { scene: "orb".to_owned(), name: name.to_owned() };
        Mapping::learned("desk", Source::Control { channel: 0, number: 7 }, target)
    }

    fn change(memory: &mut KnobMemory, edit: KnobEdit) -> Result<(), StoredFileError> {
        memory.change(&edit);
        let poll = || {
            std::thread::sleep(Duration::from_millis(1));
            memory.poll()
        };
        std::iter::repeat_with(poll).take(30_000).find_map(|kept| kept).expect("the thread has ended")
    }

    fn names(memory: &KnobMemory) -> Vec<String> {
        let name = |mapping: &Mapping| match &mapping.target {
            Target::Param { name, .. } => name.clone(),
            Target::Action { name, .. } => name.clone(),
        };
        memory.file.mappings.list().iter().map(name).collect()
    }

    #[test]
    fn mappings_are_read_back_and_merged_with_another_windows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mariana/knobs.toml");
        let open = || KnobMemory::open(Some(path.clone())).0;
        let (mut one, mut other) = (open(), open());
        change(&mut one, KnobEdit::Add(mapping("size"))).unwrap();
        change(&mut other, KnobEdit::Add(mapping("glow"))).unwrap();
        assert_eq!(names(&other), ["size", "glow"]);
        assert_eq!(names(&open()), ["size", "glow"]);
        let mut inverted = mapping("size");
        inverted.invert();
        // Dropping the memory waits until all changes are written.
        one.change(&KnobEdit::Change(mapping("size"), inverted.clone()));
        one.change(&KnobEdit::Remove(mapping("glow")));
        one.change(&KnobEdit::Clock(false));
        drop(one);
        let last = open();
        assert_eq!((last.file.mappings.list(), last.file.clock), (&[inverted][..], false));
    }

    #[test]
    fn a_damaged_file_is_reported_and_kept_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knobs.toml");
        for (number, name) in ["knobs.toml.broken", "knobs.toml.broken-2"].into_iter().enumerate() {
            let text = format!("[[knob]]\ndevice = {number}\n");
            std::fs::write(&path, &text).unwrap();
            let (mut memory, trouble) = KnobMemory::open(Some(path.clone()));
            let said = trouble.unwrap().to_string();
            assert!(said.contains("knobs.toml cannot be understood") && said.contains(name), "{said}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "reading must not change the file");
            change(&mut memory, KnobEdit::Add(mapping("size"))).unwrap();
            assert_eq!(std::fs::read_to_string(folder.path().join(name)).unwrap(), text);
            assert_eq!(names(&KnobMemory::open(Some(path.clone())).0), ["size"]);
        }
    }

    #[test]
    fn mappings_that_cannot_be_written_last_until_the_program_ends() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("mariana"), "a file where the folder should be").unwrap();
        let (mut memory, _) = KnobMemory::open(Some(folder.path().join("mariana/knobs.toml")));
        let refused = change(&mut memory, KnobEdit::Add(mapping("size"))).unwrap_err();
        assert!(refused.to_string().contains("cannot be"), "{refused}");
        assert_eq!(names(&memory), ["size"]);
        let (mut nowhere, trouble) = KnobMemory::open(None);
        nowhere.change(&KnobEdit::Clock(false));
        assert_eq!((nowhere.file.clock, nowhere.poll(), trouble), (false, None, None));
    }
}
