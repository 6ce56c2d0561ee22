//! `cargo xtask gpu` compiles every shader program with the compilers of real GPUs, without these GPUs.
//!
//! Mesa's package `mesa-drm-shim` replaces the kernel driver of the GPU. Mesa's user space driver then compiles as on
//! the real GPU and reports registers, waves, spills and code size, but draws nothing. The figures do not depend on
//! the load of the machine, so they can be compared with the accepted figures of the same version of Mesa
//! ([`budgets`]).
//!
//! `cargo xtask gpu-programs` prints the figures for the GPU of this machine, if the driver reports any.

mod budgets;
mod counts;
mod programs;
mod table;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, anyhow, bail};
use clap::Parser;

use programs::Linked;
pub(crate) use programs::run as programs;

/// The default GPUs: the oldest AMD family with many users, and a newer family.
const GPUS: [&str; 2] = ["vega10", "navi21"];

/// The library of `mesa-drm-shim` for AMD GPUs.
const SHIM: &str = "libamdgpu_noop_drm_shim.so";

#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct Arguments {
    #[arg(long)]
    shim: Option<PathBuf>,
    /// Folder of the shaders, instead of the embedded ones.
    #[arg(long)]
    shaders: Option<String>,
    #[arg(long = "gpu", default_values = GPUS)]
    gpus: Vec<String>,
    /// Additional values of `AMD_DEBUG`, such as `useaco`.
    #[arg(long = "option")]
    options: Vec<String>,
    #[arg(long)]
    check: bool,
    #[arg(long)]
    accept: bool,
    /// Selects programs whose names contain one of these words. An empty list selects all programs.
    names: Vec<String>,
}

/// Finds the shim in the folders where packages install it and where `scripts/lib/setup.sh` unpacks it.
fn shim() -> Option<PathBuf> {
    let unpacked = Path::new(crate::root::ROOT).join("target/mesa-drm-shim");
    let folders = [PathBuf::from("/"), unpacked];
    let places = ["usr/lib/x86_64-linux-gnu", "usr/lib/aarch64-linux-gnu", "usr/lib64", "usr/lib"];
    let files = folders.iter().flat_map(|folder| places.map(|place| folder.join(place).join(SHIM)));
    files.into_iter().find(|file| file.exists())
}

/// Prints a table of programs and GPUs. With `--accept`, records the figures as accepted. With `--check`, fails if a
/// program got worse. The check compiles only programs whose text has changed since their figures were accepted,
/// because a compiler gives the same figures for the same text.
///
/// # Errors
/// Fails if the shim or the driver is missing, if a driver rejects a program, or if a program got worse.
pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let requested = Arguments::parse_from(arguments);
    let shim = requested.shim.clone().or_else(shim).with_context(|| {
        format!("cannot find {SHIM}: install mesa-drm-shim (Debian 13, or backports of 12), or use --shim")
    })?;
    let all = std::thread::scope(|scope| {
        let ask = |gpu: &String| -> anyhow::Result<_> {
            let programs = compile(&shim, gpu, &requested).with_context(|| format!("compiling for {gpu}"))?;
            Ok((gpu.clone(), programs))
        };
        let asked: Vec<_> = requested.gpus.iter().map(|gpu| scope.spawn(move || ask(gpu))).collect();
        let answers =
            asked.into_iter().map(|asked| asked.join().map_err(|_| anyhow!("a thread panicked"))?);
        answers.collect::<anyhow::Result<Vec<_>>>()
    })?;
    print!("{}", table::table(&all));
    if requested.accept {
        budgets::accept(&all)?;
    }
    if requested.check {
        let worse = budgets::worse(&all)?;
        if !worse.is_empty() {
            bail!("these programs got worse than accepted:\n  {}", worse.join("\n  "));
        }
        println!("No program got worse than accepted.");
    }
    Ok(())
}

/// Compiles the programs for one GPU in a separate process, because a process cannot change its GPU.
fn compile(shim: &Path, gpu: &str, requested: &Arguments) -> anyhow::Result<Vec<Linked>> {
    // Disable optimized variants, which the driver compiles after linking.
    let mut options = vec!["nooptvariant".to_owned()];
    options.extend(requested.options.iter().cloned());
    let is_known = requested.check && requested.options.is_empty();
    let output = Command::new(std::env::current_exe()?)
        .args(["gpu-programs", "--json"])
        .args(requested.shaders.iter().flat_map(|folder| ["--shaders", folder]))
        .args(is_known.then_some(["--known", gpu]).into_iter().flatten())
        .args(&requested.names)
        .env("LD_PRELOAD", shim)
        .env("AMDGPU_GPU_ID", gpu)
        .env("AMD_DEBUG", options.join(","))
        .env("radeonsi_sync_compile", "true")
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .env_remove("LIBGL_ALWAYS_SOFTWARE")
        .stderr(Stdio::inherit())
        .output()?;
    if !output.status.success() {
        bail!("the process ended with {}", output.status);
    }
    let lines = String::from_utf8(output.stdout)?;
    let found = lines.lines().filter(|line| line.starts_with('{'));
    found.map(|line| Ok(serde_json::from_str(line)?)).collect()
}
