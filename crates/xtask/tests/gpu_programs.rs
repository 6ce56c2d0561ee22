//! What compilers for AMD's GPUs make of the programs, against what was accepted.

#![allow(clippy::unwrap_used)]

use std::process::Command;

/// Programs whose names hold one of these: every scene compiled, the passes, and the largest interpreter. All of them
/// take a minute.
const PROGRAMS: [&str; 3] = [".frag", "compiled", "speakers, interpreted"];

#[test]
fn no_program_got_worse_for_a_gpu() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_xtask")).args(["gpu", "--check"]).args(PROGRAMS).output().unwrap();
    let (told, wrong) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if !output.status.success() && wrong.contains("is not there") {
        println!("Nothing was compared: {wrong}");
        return;
    }
    assert!(output.status.success(), "{told}{wrong}");
    assert!(told.contains("Not compared") || told.contains("No program got worse"), "{told}");
}
