//! Compiles the shader programs for AMD GPUs and compares the figures with the accepted figures.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// Parts of the names of the programs to compile: every compiled scene, the passes, the universal interpreters, and
/// the largest interpreter of a scene. Compiling all of them takes a minute.
const PROGRAMS: [&str; 4] = [".frag", "compiled", "universal", "speakers, interpreted"];

#[test]
fn no_program_got_worse_for_a_gpu() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_xtask")).args(["gpu", "--check"]).args(PROGRAMS).output().unwrap();
    let (reported, wrong) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if !output.status.success() && wrong.contains("cannot find lib") {
        println!("Skipped: {wrong}");
        return;
    }
    assert!(output.status.success(), "{reported}{wrong}");
    assert!(reported.contains("Not compared") || reported.contains("No program got worse"), "{reported}");
}

fn old_gpu_shim() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/mesa-drm-shim");
    let folder = "usr/lib/x86_64-linux-gnu/libradeon_noop_drm_shim.so";
    [Path::new("/").join(folder), root.join(folder)].into_iter().find(|file| file.exists())
}

#[test]
fn without_opengl_3_3_on_the_gpu_llvmpipe_draws() {
    let Some(shim) = old_gpu_shim() else {
        println!("Skipped: mesa-drm-shim is not installed");
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
