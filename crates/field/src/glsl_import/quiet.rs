//! Catches panics of naga's front end without the report that Rust prints to standard error.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

static HOOK: Once = Once::new();

/// Calls a function; `None` if it panics. The panic is not reported. Panics of other threads still are.
pub(super) fn catch_quietly<T>(call: impl FnOnce() -> T) -> Option<T> {
    HOOK.call_once(|| {
        let report = take_hook();
        set_hook(Box::new(move |panic| {
            if !IS_QUIET.get() {
                report(panic);
            }
        }));
    });
    IS_QUIET.set(true);
    let result = catch_unwind(AssertUnwindSafe(call));
    IS_QUIET.set(false);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHILD: &str = "MARIANA_QUIET_CHILD";

    /// Standard error belongs to a process, so another process panics here.
    #[test]
    fn only_caught_panics_are_silent() {
        if std::env::var_os(CHILD).is_some() {
            assert_eq!(catch_quietly(|| if CHILD.is_empty() { 1 } else { panic!("a silent panic") }), None);
            assert_eq!(catch_quietly(|| 2), Some(2));
            let other = std::thread::spawn(|| panic!("a loud panic"));
            assert!(other.join().is_err());
            return;
        }
        let mut command = std::process::Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", "glsl_import::quiet::tests::only_caught_panics_are_silent", "--nocapture"]);
        let output = command.env(CHILD, "1").output().unwrap();
        let reported = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{reported}");
        assert!(reported.contains("a loud panic") && !reported.contains("a silent panic"), "{reported}");
    }
}
