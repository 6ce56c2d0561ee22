//! Storage of programs from earlier runs: the driver's binaries, and records of programs that a driver failed to
//! compile. The embedding program implements [`ProgramStore`] and chooses the location.

use std::any::Any;
use std::fmt;
use std::hash::Hasher as _;
use std::path::{Path, PathBuf};

/// Identifies a program by driver, driver version and texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ProgramKey([u8; 16]);

impl ProgramKey {
    /// The key of the program that `parts` describe. It depends on Mariana's version.
    pub fn of<'a>(parts: impl IntoIterator<Item = &'a str>) -> Self {
        // Two hashes of 64 bits. If another version of Rust hashes differently, all programs are compiled again.
        let mut hashers = [0_u8, 1].map(|first| {
            let mut hasher = std::hash::DefaultHasher::new();
            hasher.write_u8(first);
            hasher
        });
        for part in [env!("CARGO_PKG_VERSION")].into_iter().chain(parts) {
            for hasher in &mut hashers {
                hasher.write_usize(part.len());
                hasher.write(part.as_bytes());
            }
        }
        let [a, b] = hashers.map(|hasher| hasher.finish());
        Self(((u128::from(a) << 64) | u128::from(b)).to_le_bytes())
    }

    /// The key as bytes.
    pub fn bytes(&self) -> &[u8; 16] {
        &self.0
    }
}

impl fmt::Display for ProgramKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// An operation that a driver performs on a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// Loading the program's binary.
    Taking,
    /// Compiling the program's text.
    Compiling,
}

/// The reason why a program is not tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GivenUp {
    /// The driver rejected the program.
    Refused,
    /// A process crashed while the driver compiled the program. The next run tries the program once more.
    DiedOnce,
    /// Two processes crashed while the driver compiled the program.
    DiedTwice,
}

impl GivenUp {
    /// A message for the user. `mark` is the file with the record.
    pub fn sentence(self, mark: &Path) -> String {
        let reason = match self {
            Self::Refused => "the driver rejected it before",
            Self::DiedOnce => {
                return "it is skipped this time, because Mariana crashed while the driver compiled it before; \
                        the next start tries it once more"
                    .to_owned();
            }
            Self::DiedTwice => "Mariana crashed twice while the driver compiled it",
        };
        format!("it is not tried again, because {reason}; to try it again, delete {}", mark.display())
    }
}

/// Stores programs and records of failures between runs. Compiler threads call these methods, which may block. The
/// default methods do not store anything.
pub trait ProgramStore: Send + Sync {
    /// Loads the binary of this key.
    fn load(&self, _key: ProgramKey) -> Option<Vec<u8>> {
        None
    }

    /// Saves a binary.
    fn save(&self, _key: ProgramKey, _content: &[u8]) {}

    /// Deletes a binary.
    fn discard(&self, _key: ProgramKey) {}

    /// Records that a driver starts working on a program. Drop the result to record that the process survived.
    fn attempt(&self, _key: ProgramKey, _work: Work) -> Option<Box<dyn Any>> {
        None
    }

    /// Returns what the driver was doing with a program when an earlier run crashed. Returns each crash only once.
    fn death(&self, _key: ProgramKey) -> Option<Work> {
        None
    }

    /// Records that the driver rejected a program, so that the program is not tried again.
    fn record_refused(&self, _key: ProgramKey) {}

    /// Records that an earlier process crashed while the driver compiled a program.
    fn record_crash(&self, _key: ProgramKey) {}

    /// Records that the driver compiled a program, and deletes records of crashes.
    fn record_compiled(&self, _key: ProgramKey) {}

    /// The reason why a program must not be tried in this run, and the file of the record. `None` if it may be tried.
    fn given_up(&self, _key: ProgramKey) -> Option<(GivenUp, PathBuf)> {
        None
    }
}

impl ProgramStore for () {}
