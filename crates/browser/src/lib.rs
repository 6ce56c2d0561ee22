//! Runs `mariana-field` and `mariana-music` as a web page would, as WebAssembly. `scripts/check-targets` builds this
//! crate for wasm32 and calls its functions in node; the tests of the workspace call them natively.
//!
//! Each function returns 0, or the line of the first expectation that failed.

#![expect(unsafe_code, reason = "the attribute that exports a function by its name")]

mod field;
mod music;

/// Compiles, evaluates and prunes a formula.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn check_field() -> u32 {
    field::check().err().unwrap_or(0)
}

/// Analyzes generated music.
// SAFETY: no other function has this name.
#[unsafe(no_mangle)]
pub extern "C" fn check_music() -> u32 {
    music::check().err().unwrap_or(0)
}

/// Fails with `line` unless `met`.
fn expect(met: bool, line: u32) -> Result<(), u32> {
    if met { Ok(()) } else { Err(line) }
}

#[cfg(test)]
mod tests {
    #[test]
    fn all_expectations_are_met_natively() {
        assert_eq!((super::check_field(), super::check_music()), (0, 0));
    }
}
