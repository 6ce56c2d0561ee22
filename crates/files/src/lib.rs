//! Files of a user that no failure costs: written whole or not at all, removed where a signal ends the program in the middle,
//! and texts that come back after a crash.
//!
//! ```
//! use mariana_files::atomic_file::AtomicFile;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("notes.txt");
//! std::fs::write(&path, "before")?;
//! drop(AtomicFile::create(&path)?);
//! assert_eq!(std::fs::read_to_string(&path)?, "before");
//! AtomicFile::create(&path)?.write(b"after")?;
//! assert_eq!(std::fs::read_to_string(&path)?, "after");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`documents`] reads, watches and saves the texts of an editor on a thread of its own, and keeps what was not saved.
//! [`Folders`] says where all that lies.

pub mod atomic_file;
pub mod documents;
pub mod ending;
mod folders;
pub mod limits;

pub use folders::Folders;
