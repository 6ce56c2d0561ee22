//! The file of what knobs turn, beside the settings.
//!
//! Each change is made in what the file holds at that moment, so that what another window or a hand has written meanwhile
//! stays. A file that is damaged is kept aside before another one takes its place. All that is done by a thread: what knobs
//! turn has changed here before.

use std::fs::{File, create_dir_all};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::aside::aside;
use super::writer_thread::WriterThread;
use mariana_control::limits::LIMITS as CONTROL_LIMITS;
use mariana_control::midi::{Mapping, MappingFile, MappingsError};
use mariana_files::Folders;
use mariana_files::atomic_file::AtomicFile;

/// A change of what knobs turn.
#[derive(Debug, Clone, PartialEq)]
pub enum KnobEdit {
    /// This is learned.
    Add(Mapping),
    /// This is forgotten.
    Remove(Mapping),
    /// The first is the second from now on.
    Change(Mapping, Mapping),
    /// Whether a device's clock sets the tempo.
    Clock(bool),
}

/// See the module.
pub struct KnobMemory {
    /// None where the system has no place for settings: then mappings last as long as the program.
    writer_thread: Option<WriterThread<KnobEdit, Kept>>,
    file: MappingFile,
    /// How many changes are not in the file yet.
    waiting: usize,
}

/// What the file holds after a change.
type Kept = Result<MappingFile, KnobsError>;

/// Why mappings are not read or not kept: a sentence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum KnobsError {
    /// The file is damaged.
    #[error("the knobs in {} cannot be understood ({reason}): none is mapped; correct the file, or learn anew and it is kept as {}", path.display(), aside.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: MappingsError,
        /// Where it will be kept.
        aside: PathBuf,
    },
    /// The system refuses.
    #[error("the knobs in {} cannot be {doing} ({reason}); check that folder's permissions", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// What was tried: read or written.
        doing: &'static str,
        /// What the system says.
        reason: String,
    },
}

impl KnobMemory {
    /// The user's file, and what is wrong with it, if anything. A missing file is none.
    pub fn among(folders: &Folders) -> (Self, Option<KnobsError>) {
        Self::open(folders.config.as_ref().map(|config| config.join("knobs.toml")))
    }

    /// The same for another file.
    pub fn open(path: Option<PathBuf>) -> (Self, Option<KnobsError>) {
        let (file, trouble) = match path.as_deref().map(read) {
            None => (MappingFile::default(), None),
            Some(Ok(file)) => (file, None),
            Some(Err(trouble)) => (MappingFile::default(), Some(trouble)),
        };
        let keeper = |path: PathBuf| WriterThread::start("knobs", move |edit| keep(&path, &edit));
        (Self { writer_thread: path.map(keeper), file, waiting: 0 }, trouble)
    }

    /// What is remembered.
    pub fn file(&self) -> &MappingFile {
        &self.file
    }

    /// The same, for knobs that take hold of what they turn.
    pub fn file_mut(&mut self) -> &mut MappingFile {
        &mut self.file
    }

    /// Makes a change here, and soon in the file.
    pub fn change(&mut self, edit: &KnobEdit) {
        apply(&mut self.file, edit);
        let is_kept =
            self.writer_thread.as_ref().is_some_and(|writer_thread| writer_thread.give(edit.clone()));
        self.waiting += usize::from(is_kept);
    }

    /// What became of a change in the file: what stands there holds here, too.
    ///
    /// # Errors
    /// The file cannot be read or written; then the change lasts as long as the program.
    pub fn poll(&mut self) -> Option<Result<(), KnobsError>> {
        let kept = self.writer_thread.as_ref()?.poll()?;
        Some(self.take(kept))
    }

    fn take(&mut self, kept: Kept) -> Result<(), KnobsError> {
        self.waiting = self.waiting.saturating_sub(1);
        let after = kept?;
        if self.waiting == 0 && after.mappings.list() != self.file.mappings.list() {
            self.file = after;
        }
        Ok(())
    }
}

/// Makes a change in the file.
fn keep(path: &Path, edit: &KnobEdit) -> Kept {
    let mut after = match read(path) {
        Ok(there) => there,
        Err(KnobsError::Damaged { aside, .. }) => {
            std::fs::rename(path, aside).map_err(|error| refused(path, "written", &error))?;
            MappingFile::default()
        }
        Err(error) => return Err(error),
    };
    apply(&mut after, edit);
    write(path, &after)?;
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

fn refused(path: &Path, doing: &'static str, reason: &dyn std::fmt::Display) -> KnobsError {
    KnobsError::System { path: path.to_owned(), doing, reason: reason.to_string() }
}

fn read(path: &Path) -> Result<MappingFile, KnobsError> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(MappingFile::default()),
        Err(error) => return Err(refused(path, "read", &error)),
    };
    let mut bytes = Vec::new();
    let most = CONTROL_LIMITS.mapping_bytes_max as u64 + 1;
    file.take(most).read_to_end(&mut bytes).map_err(|error| refused(path, "read", &error))?;
    MappingFile::read(&bytes).map_err(|reason| KnobsError::Damaged {
        path: path.to_owned(),
        reason,
        aside: aside(path),
    })
}

fn write(path: &Path, file: &MappingFile) -> Result<(), KnobsError> {
    let failed = |error: &dyn std::fmt::Display| refused(path, "written", error);
    let text = file.text().map_err(|error| failed(&error))?;
    create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(|error| failed(&error))?;
    let written = AtomicFile::create(path).and_then(|file| file.write(text.as_bytes()));
    written.map_err(|error| failed(&error.reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::midi::{Source, Target};

    fn mapping(name: &str) -> Mapping {
        let target = Target::Param { scene: "orb".to_owned(), name: name.to_owned() };
        Mapping::learned("desk", Source::Control { channel: 0, number: 7 }, target)
    }

    /// Makes a change and waits until it is in the file.
    fn change(memory: &mut KnobMemory, edit: KnobEdit) -> Result<(), KnobsError> {
        memory.change(&edit);
        let kept = memory.writer_thread.as_ref().unwrap().wait().unwrap();
        memory.take(kept)
    }

    fn names(memory: &KnobMemory) -> Vec<String> {
        let name = |mapping: &Mapping| match &mapping.target {
            Target::Param { name, .. } => name.clone(),
            Target::Action { name, .. } => name.clone(),
        };
        memory.file().mappings.list().iter().map(name).collect()
    }

    #[test]
    fn what_is_learned_is_found_again_and_so_is_what_another_window_learned() {
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
        // All of them are there when it is gone.
        one.change(&KnobEdit::Change(mapping("size"), inverted.clone()));
        one.change(&KnobEdit::Remove(mapping("glow")));
        one.change(&KnobEdit::Clock(false));
        drop(one);
        let last = open();
        assert_eq!((last.file().mappings.list(), last.file().clock), (&[inverted][..], false));
    }

    #[test]
    fn a_damaged_file_is_said_and_kept_aside_and_nothing_is_lost() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knobs.toml");
        for (number, name) in ["knobs.toml.broken", "knobs.toml.broken-2"].into_iter().enumerate() {
            let text = format!("[[knob]]\ndevice = {number}\n");
            std::fs::write(&path, &text).unwrap();
            let (mut memory, trouble) = KnobMemory::open(Some(path.clone()));
            let said = trouble.unwrap().to_string();
            assert!(said.contains("knobs.toml cannot be understood") && said.contains(name), "{said}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "reading changes nothing");
            change(&mut memory, KnobEdit::Add(mapping("size"))).unwrap();
            assert_eq!(std::fs::read_to_string(folder.path().join(name)).unwrap(), text);
            assert_eq!(names(&KnobMemory::open(Some(path.clone())).0), ["size"]);
        }
    }

    #[test]
    fn what_cannot_be_written_lasts_as_long_as_the_program() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("mariana"), "a file where the folder should be").unwrap();
        let (mut memory, _) = KnobMemory::open(Some(folder.path().join("mariana/knobs.toml")));
        let refused = change(&mut memory, KnobEdit::Add(mapping("size"))).unwrap_err();
        assert!(refused.to_string().contains("cannot be"), "{refused}");
        assert_eq!(names(&memory), ["size"]);
        let (mut nowhere, trouble) = KnobMemory::open(None);
        nowhere.change(&KnobEdit::Clock(false));
        assert_eq!((nowhere.file().clock, nowhere.poll(), trouble), (false, None, None));
    }
}
