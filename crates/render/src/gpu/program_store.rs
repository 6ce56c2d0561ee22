//! Programs from earlier runs: the driver's binaries, and records of programs at which a driver failed.
//!
//! The program that embeds the renderer implements [`ProgramStore`] and decides where these are kept.

use std::any::Any;
use std::fmt;
use std::hash::Hasher as _;
use std::path::{Path, PathBuf};

/// Identifies a program: the driver, its version and the texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ProgramKey([u8; 16]);

impl ProgramKey {
    /// The key of a program that `parts` describe. Another version of Mariana has other keys.
    pub fn of<'a>(parts: impl IntoIterator<Item = &'a str>) -> Self {
        // Two hashes of 64 bits. Another version of Rust may hash otherwise, which costs compiling once.
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

/// What a driver is asked to do with a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// To take its own form of it.
    Taking,
    /// To compile its text.
    Compiling,
}

/// Why a program is not tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GivenUp {
    /// The driver refused it.
    Refused,
    /// A process died while the driver compiled it. The next run tries it once more.
    DiedOnce,
    /// Two processes died while the driver compiled it.
    DiedTwice,
}

impl GivenUp {
    /// A sentence for the user; `mark` is the file that remembers it.
    pub fn sentence(self, mark: &Path) -> String {
        let reason = match self {
            Self::Refused => "the driver refused it before",
            Self::DiedOnce => {
                return "it is left out this time, because Mariana ended while the driver compiled it before; \
                        the next start tries it once more"
                    .to_owned();
            }
            Self::DiedTwice => "Mariana ended twice while the driver compiled it",
        };
        format!("it is not tried again, because {reason}; delete {} to have it tried", mark.display())
    }
}

/// Keeps programs and records of failures from run to run. Compiling threads call it and may block in it. The default
/// methods keep nothing.
pub trait ProgramStore: Send + Sync {
    /// The program of this key in the driver's own form.
    fn load(&self, _key: ProgramKey) -> Option<Vec<u8>> {
        None
    }

    /// Keeps a program in the driver's own form.
    fn save(&self, _key: ProgramKey, _content: &[u8]) {}

    /// Forgets a program.
    fn discard(&self, _key: ProgramKey) {}

    /// Notes that a driver begins to work on a program. Dropping the result says that the process has outlived it.
    fn attempt(&self, _key: ProgramKey, _work: Work) -> Option<Box<dyn Any>> {
        None
    }

    /// The work on a program in which an earlier run died. It is told once.
    fn death(&self, _key: ProgramKey) -> Option<Work> {
        None
    }

    /// Notes that the driver refused a program: it is not tried again.
    fn note_refused(&self, _key: ProgramKey) {}

    /// Notes that an earlier process died while the driver compiled a program.
    fn note_died(&self, _key: ProgramKey) {}

    /// Notes that the driver compiled a program: earlier deaths are forgotten.
    fn note_compiled(&self, _key: ProgramKey) {}

    /// Why a program is not tried in this run, and the file of the record; `None` if it may be tried.
    fn given_up(&self, _key: ProgramKey) -> Option<(GivenUp, PathBuf)> {
        None
    }
}

/// Keeps nothing.
impl ProgramStore for () {}
