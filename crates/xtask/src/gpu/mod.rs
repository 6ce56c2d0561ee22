//! What the compilers of real GPUs make of every program, without such a GPU: `cargo xtask gpu`.
//!
//! Mesa's package `mesa-drm-shim` stands in for the kernel driver of a GPU that is not there. Mesa's own driver of that GPU
//! then compiles as it would on the real one and reports registers, waves, spills and the length of the code; only
//! drawing does nothing. Counts do not depend on how busy the machine is, so they are compared with those that were
//! accepted ([`budgets`]), within one version of Mesa.
//!
//! `cargo xtask gpu-programs` prints the same for the GPU that is there, where its driver reports something.

mod budgets;
mod counts;
mod programs;
mod table;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, anyhow, bail};

use programs::Linked;
pub(crate) use programs::run as programs;

/// The GPUs that are asked unless others are named: the oldest AMD family with many users, and a newer one.
const GPUS: [&str; 2] = ["vega10", "navi21"];

/// The library of `mesa-drm-shim` for AMD GPUs.
const SHIM: &str = "libamdgpu_noop_drm_shim.so";

/// What is wanted of [`run`].
#[derive(Debug, Default)]
struct Arguments {
    shim: Option<PathBuf>,
    /// Where the shaders are, if not those that are built in.
    shaders: Option<String>,
    gpus: Vec<String>,
    /// More of Mesa's own debug options, as `useaco`.
    options: Vec<String>,
    /// Words of which a program's name must hold one; all programs if there are none.
    names: Vec<String>,
    check: bool,
    accept: bool,
}

fn requested(arguments: &[String]) -> anyhow::Result<Arguments> {
    let mut requested = Arguments::default();
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().cloned().with_context(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--shim" => requested.shim = Some(value()?.into()),
            "--shaders" => requested.shaders = Some(value()?),
            "--gpu" => requested.gpus.push(value()?),
            "--option" => requested.options.push(value()?),
            "--check" => requested.check = true,
            "--accept" => requested.accept = true,
            name if !name.starts_with('-') => requested.names.push(name.to_owned()),
            _ => bail!(
                "there is no {argument}; there are --shim, --shaders, --gpu, --option, --check and --accept"
            ),
        }
    }
    if requested.gpus.is_empty() {
        requested.gpus = GPUS.map(str::to_owned).into();
    }
    Ok(requested)
}

/// Where the shim is: where packages put it, or where `scripts/lib/setup.sh` unpacks it.
fn shim() -> Option<PathBuf> {
    let unpacked = Path::new(crate::root::ROOT).join("target/mesa-drm-shim");
    let folders = [PathBuf::from("/"), unpacked];
    let places = ["usr/lib/x86_64-linux-gnu", "usr/lib/aarch64-linux-gnu", "usr/lib64", "usr/lib"];
    let files = folders.iter().flat_map(|folder| places.map(|place| folder.join(place).join(SHIM)));
    files.into_iter().find(|file| file.exists())
}

/// Prints a table of all programs on some GPUs; with `--check` fails where one got worse, with `--accept` notes what is
/// there as what is accepted.
///
/// # Errors
/// A shim or driver that is not there, a program that a driver refuses, and programs that got worse.
pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let requested = requested(arguments)?;
    let shim = requested.shim.clone().or_else(shim).with_context(|| {
        format!("{SHIM} is not there: install mesa-drm-shim (Debian 13; in the backports of 12), or name it with --shim")
    })?;
    let all = std::thread::scope(|scope| {
        let ask = |gpu: &String| -> anyhow::Result<_> {
            let programs =
                ask(&shim, gpu, &requested).with_context(|| format!("asking the compiler for {gpu}"))?;
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
            bail!("these programs got worse than what was accepted:\n  {}", worse.join("\n  "));
        }
        println!("No program got worse than what was accepted.");
    }
    Ok(())
}

/// All programs on one GPU, from a process of its own: which GPU there is, is settled when a process starts.
fn ask(shim: &Path, gpu: &str, requested: &Arguments) -> anyhow::Result<Vec<Linked>> {
    // Without variants that are compiled later, and with linking that waits for its compiler.
    let mut options = vec!["nooptvariant".to_owned()];
    options.extend(requested.options.iter().cloned());
    let output = Command::new(std::env::current_exe()?)
        .args(["gpu-programs", "--json"])
        .args(requested.shaders.iter().flat_map(|folder| ["--shaders", folder]))
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
        bail!("it ended with {}", output.status);
    }
    let lines = String::from_utf8(output.stdout)?;
    let found = lines.lines().filter(|line| line.starts_with('{'));
    found.map(|line| Ok(serde_json::from_str(line)?)).collect()
}
