//! Faults that tests cause: failures of drivers and what takes too long, at a moment that a test chooses.
//!
//! In builds with debug assertions the variable `MARIANA_FAULT` names a fault and after how many seconds it strikes,
//! `context-lost@3`; most strike once. In other builds none of this is compiled.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The driver reports that the context is lost, as after a reset of the GPU.
    ContextLost,
    /// The driver has no memory for a render target.
    NoTarget,
    /// Every pixel seems to take 0.1 ms.
    DearPixels,
    /// The driver refuses an interpreter.
    NoInterpreter,
    /// The driver takes the process along while it compiles an interpreter.
    DeadlyInterpreter,
    /// The driver compiles a program for seconds, and that is told after a fraction of one.
    SlowCompiler,
    /// The same, of an interpreter.
    SlowInterpreter,
    /// The driver compiles a long program for an hour.
    EndlessCompiler,
    /// The first tree of regions of a changed text takes longer than anyone waits, and that of the last text did not.
    SlowTree,
}

impl Fault {
    fn named(name: &str) -> Option<Self> {
        match name {
            "context-lost" => Some(Self::ContextLost),
            "no-target" => Some(Self::NoTarget),
            "dear-pixels" => Some(Self::DearPixels),
            "no-interpreter" => Some(Self::NoInterpreter),
            "deadly-interpreter" => Some(Self::DeadlyInterpreter),
            "slow-compiler" => Some(Self::SlowCompiler),
            "slow-interpreter" => Some(Self::SlowInterpreter),
            "endless-compiler" => Some(Self::EndlessCompiler),
            "slow-tree" => Some(Self::SlowTree),
            _ => None,
        }
    }
}

/// The fault that is to strike, and when.
static WANTED: OnceLock<Option<(Fault, Instant)>> = OnceLock::new();
static STRUCK: AtomicBool = AtomicBool::new(false);

/// Whether a fault strikes here and now. The seconds count from the first call.
pub fn strikes(fault: Fault) -> bool {
    lasts(fault) && !STRUCK.swap(true, Ordering::Relaxed)
}

/// Whether a fault that strikes again and again does so now.
pub fn lasts(fault: Fault) -> bool {
    due_of(fault).is_some_and(|due| Instant::now() >= due)
}

/// Whether a fault strikes in this run, now or at another time.
pub fn is_wanted(fault: Fault) -> bool {
    due_of(fault).is_some()
}

fn due_of(fault: Fault) -> Option<Instant> {
    if !cfg!(debug_assertions) {
        return None;
    }
    let wanted = WANTED.get_or_init(|| wanted(&std::env::var("MARIANA_FAULT").ok()?));
    wanted.filter(|(wanted, _)| *wanted == fault).map(|(_, due)| due)
}

fn wanted(text: &str) -> Option<(Fault, Instant)> {
    let (name, seconds) = text.split_once('@')?;
    let after = Duration::try_from_secs_f64(seconds.parse().ok()?).ok()?;
    Some((Fault::named(name)?, Instant::now().checked_add(after)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_named_with_their_moment() {
        assert_eq!(wanted("context-lost@2").map(|(fault, _)| fault), Some(Fault::ContextLost));
        assert_eq!(wanted("no-target@0.5").map(|(fault, _)| fault), Some(Fault::NoTarget));
        assert_eq!(wanted("slow-compiler@0").map(|(fault, _)| fault), Some(Fault::SlowCompiler));
        for text in
            ["", "context-lost", "context-lost@", "@1", "nothing@1", "no-target@-1", "no-target@1e300"]
        {
            assert!(wanted(text).is_none(), "{text}");
        }
    }
}
