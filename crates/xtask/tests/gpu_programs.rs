//! What compilers for AMD's GPUs make of the programs, against what was accepted.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// Programs whose names hold one of these: every scene compiled, the passes, the universal interpreters, and the largest
/// of a scene's own. All of them take a minute.
const PROGRAMS: [&str; 4] = [".frag", "compiled", "universal", "speakers, interpreted"];

#[test]
fn no_program_got_worse_for_a_gpu() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_xtask")).args(["gpu", "--check"]).args(PROGRAMS).output().unwrap();
    let (reported, wrong) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if !output.status.success() && wrong.contains("is not there") {
        println!("Nothing was compared: {wrong}");
        return;
    }
    assert!(output.status.success(), "{reported}{wrong}");
    assert!(reported.contains("Not compared") || reported.contains("No program got worse"), "{reported}");
}

/// The shim of `mesa-drm-shim` for old AMD GPUs, if it is there.
fn old_gpu_shim() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/mesa-drm-shim");
    let folder = "usr/lib/x86_64-linux-gnu/libradeon_noop_drm_shim.so";
    [Path::new("/").join(folder), root.join(folder)].into_iter().find(|file| file.exists())
}

#[test]
fn a_gpu_with_opengl_2_kept_a_machine_from_drawing_without_a_window() {
    let Some(shim) = old_gpu_shim() else {
        println!("Nothing was tried: mesa-drm-shim is not there");
        return;
    };
    let output = Command::new(env!("CARGO_BIN_EXE_xtask"))
        .args(["gpu-programs", "--json", "edges.frag"])
        .env("LD_PRELOAD", shim)
        .env("RADEON_GPU_ID", "rv515")
        .output()
        .unwrap();
    let (reported, wrong) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && reported.contains("llvmpipe"), "{reported}{wrong}");
}
