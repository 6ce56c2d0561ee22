//! Safe file access. Output files are complete or absent, a signal removes unfinished ones, and unsaved texts survive
//! a crash.
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
//! [`file_names`] makes names for new files. [`documents`] reads, watches and saves the editor's texts on a background thread. [`Folders`] contains the paths
//! of the user's folders.

pub mod atomic_file;
#[cfg(not(target_family = "wasm"))]
pub mod attempt;
pub mod caches;
pub mod child;
pub mod documents;
#[cfg_attr(target_family = "wasm", expect(dead_code, reason = "a page receives no signals"))]
pub mod ending;
pub mod file_names;
mod folders;
pub mod limits;
pub mod reading;

pub use folders::Folders;
