//! Fault injection for tests: driver failures and slow work at a chosen time.
//!
//! In builds with debug assertions, the variable `MARIANA_FAULT` names a fault and the seconds until it occurs, such as
//! `context-lost@3`. Most faults occur once. Other builds never inject faults.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};
use web_time::Instant;

/// A fault that a test can inject.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fault {
    /// The driver reports a lost context, as after a reset of the GPU.
    ContextLost,
    /// The driver has lost the contents of textures, as after a suspension of the computer.
    MemoryPurged,
    /// The driver has no memory for a render target.
    NoTarget,
    /// Every pixel seems to take 0.1 ms.
    DearPixels,
    /// The driver rejects an interpreter.
    NoInterpreter,
    /// The driver crashes the process while compiling an interpreter.
    DeadlyInterpreter,
    /// The driver takes seconds to compile a program, and is reported as slow after a fraction of a second.
    SlowCompiler,
    /// Like [`Fault::SlowCompiler`], for an interpreter.
    SlowInterpreter,
    /// The driver takes an hour to compile a long program.
    EndlessCompiler,
    /// The first region tree of a changed text takes longer than the show waits. Trees of the previous text were fast.
    SlowTree,
    /// The show waits for the first region tree of a scene for a tenth of the usual time.
    LittlePatience,
}

static WANTED: OnceLock<Option<(Fault, Instant)>> = OnceLock::new();
static STRUCK: AtomicBool = AtomicBool::new(false);

/// Returns true if the one-time `fault` occurs now. Its seconds count from the first call of any function here.
pub fn strikes(fault: Fault) -> bool {
    lasts(fault) && !STRUCK.swap(true, Ordering::Relaxed)
}

/// Returns true while the lasting `fault` is in effect.
pub fn lasts(fault: Fault) -> bool {
    due_of(fault).is_some_and(|due| Instant::now() >= due)
}

/// Returns true if `fault` occurs in this run, now or later.
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
    let fault = Fault::deserialize(StrDeserializer::<Error>::new(name)).ok()?;
    Some((fault, Instant::now().checked_add(after)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_parsed_with_their_time() {
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
