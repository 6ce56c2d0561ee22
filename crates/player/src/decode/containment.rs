//! Containment of codec libraries: if a library panics, the program reports a decoding error and continues.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};

use super::Problem;

thread_local! {
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

pub(super) fn contained<T>(run: impl FnOnce() -> T) -> Result<T, Problem> {
    let outer = INSIDE.replace(true);
    let result = catch_unwind(AssertUnwindSafe(run));
    INSIDE.set(outer);
    result.map_err(|payload| {
        let what = payload
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "it left no message".into());
        Problem::CodecFailure(what)
    })
}

/// Installs a panic hook that logs contained panics at debug level instead of printing them. All other panics are
/// printed as usual. The program calls this function once.
pub fn quiet_contained_panics() {
    let print = take_hook();
    set_hook(Box::new(
        move |panic| {
            if INSIDE.get() { tracing::debug!("contained: {panic}") } else { print(panic) }
        },
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_with_its_message() {
        let error = contained(|| panic!("overflow at {}", 7)).unwrap_err().to_string();
        assert!(error.contains("overflow at 7"), "{error}");
        assert!(!INSIDE.get());
        assert_eq!(contained(|| 5).unwrap(), 5);
    }
}
