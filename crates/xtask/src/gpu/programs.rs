//! Links every program of the renderer on the current GPU and collects the compiler's figures.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context as _, bail};
use clap::Parser;
use cpu_time::ProcessTime;
use mariana::ending::begin_to_leave;
use mariana::gpu::flash_pass::FLASH_SHADERS;
use mariana::gpu::media::{MEDIA_FILTER_SHADER, media_filter_variant};
use mariana::gpu::post::POST_SHADERS;
use mariana::gpu::program::ProgramTexts;
use mariana::gpu::renderer::{EDGE_SHADER, PLACING_SHADERS, UPSCALE_SHADER};
use mariana::gpu::scene_program::{SCENE_SHADER, as_views, drawing_variant_of, variant_of};
use mariana::gpu::{CellUse, Counting, Headless, Interpreter, Mode, Program, ShaderLibrary, Variant};
use mariana::scenes::{SceneSource, shipped_names};
use serde::{Deserialize, Serialize};
use tracing_subscriber::layer::{Context, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

use super::budgets;
use super::counts::Counts;

/// A formula similar to the formulas that section 4.4 of the thesis measures (Abt 2022).
const FORMULA: &str = "min(y, sqrt(x*x + (y-1)*(y-1) + (z-6)*(z-6)) - 1)";

/// The tool also links the diagnostic views of this scene.
const VIEWED: &str = "speakers";

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Linked {
    pub(super) driver: String,
    pub(super) name: String,
    /// The hash of the program's texts.
    pub(super) hash: String,
    /// Figures of the fragment shader; `None` if the driver reports none.
    pub(super) counts: Option<Counts>,
    /// CPU time of compiling and linking in seconds, summed over all threads.
    pub(super) seconds: f64,
}

struct Wanted {
    name: String,
    file: &'static str,
    variant: Variant,
}

/// Returns the programs to link: all scenes in both modes, the views of one scene, the universal interpreters, and
/// the passes.
fn wanted(gl: &mariana::gpu::gl::Gl, names: &[String]) -> anyhow::Result<Vec<Wanted>> {
    let is_wanted = |name: &str| names.is_empty() || names.iter().any(|word| name.contains(word.as_str()));
    let mut found = Vec::new();
    let plain = [EDGE_SHADER, UPSCALE_SHADER].into_iter().chain(PLACING_SHADERS).map(|file| (file, &[][..]));
    for (file, defines) in plain.chain(FLASH_SHADERS).chain(POST_SHADERS) {
        let name = format!("{file} {}", defines.join(" ")).trim_end().to_owned();
        if is_wanted(&name) {
            found.push(Wanted { name, file, variant: Variant::of(defines) });
        }
    }
    if is_wanted(MEDIA_FILTER_SHADER) {
        let variant = media_filter_variant();
        found.push(Wanted { name: MEDIA_FILTER_SHADER.to_owned(), file: MEDIA_FILTER_SHADER, variant });
    }
    let shipped = shipped_names().into_iter().map(|name| (name.clone(), SceneSource::Shipped(name)));
    let formula = ("a plane and a ball".to_owned(), SceneSource::Formula(FORMULA.into()));
    for (name, source) in std::iter::once(formula).chain(shipped) {
        let countings: &[Counting] =
            if name == VIEWED { &[Counting::Off, Counting::On] } else { &[Counting::Off] };
        let of_mode = |mode| countings.iter().map(move |&counting| (mode, counting));
        let kinds = [Mode::Compiled, Mode::Interpreted].into_iter().flat_map(of_mode);
        let mut kinds = kinds
            .map(|(mode, counting)| {
                // Only views count evaluations.
                let views = if counting == Counting::On { ", views" } else { "" };
                (format!("{name}, {mode}{views}"), mode, counting)
            })
            .filter(|(name, ..)| is_wanted(name))
            .peekable();
        if kinds.peek().is_none() {
            continue;
        }
        let ready = source.ready().with_context(|| name.clone())?;
        for (name, mode, counting) in kinds {
            let (world, buffers, plan) = (&ready.world, &ready.buffers, &ready.plan);
            let variant = match counting {
                Counting::On => as_views(variant_of(world, buffers, plan, mode, gl.info(), counting)?),
                Counting::Off => {
                    drawing_variant_of(world, buffers, plan, mode, CellUse::WhereTheyPay, gl.info())?
                }
            };
            found.push(Wanted { name, file: SCENE_SHADER, variant });
        }
    }
    for (name, non_lipschitz) in
        [("universal interpreter", false), ("universal interpreter, non-Lipschitz", true)]
    {
        if is_wanted(name) {
            let variant = Interpreter::universal(non_lipschitz).variant(Counting::Off);
            found.push(Wanted { name: name.to_owned(), file: SCENE_SHADER, variant });
        }
    }
    Ok(found)
}

/// Driver messages since the last call of `take`.
#[derive(Default, Clone)]
struct Heard(Arc<Mutex<Vec<String>>>);

impl Heard {
    fn drain(&self) -> Vec<String> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl<S: tracing::Subscriber> tracing_subscriber::Layer<S> for Heard {
    fn on_event(&self, event: &tracing::Event<'_>, _: Context<'_, S>) {
        struct Message(String);
        impl tracing::field::Visit for Message {
            fn record_debug(&mut self, field: &tracing::field::Field, value: &dyn std::fmt::Debug) {
                if field.name() == "message" {
                    self.0 = format!("{value:?}");
                }
            }
        }
        let mut message = Message(String::new());
        event.record(&mut message);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(message.0);
    }
}

#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct Arguments {
    #[arg(long)]
    json: bool,
    #[arg(long)]
    shaders: Option<PathBuf>,
    /// Does not compile programs whose text has not changed since their figures for this GPU were accepted.
    #[arg(long)]
    known: Option<String>,
    names: Vec<String>,
}

/// Prints a line for each program whose name contains one of the arguments, or for all programs. `--json` prints
/// JSON; `--shaders FOLDER` uses other shaders.
///
/// # Errors
/// Fails if the driver is missing or rejects a program.
pub(crate) fn run(arguments: &[String]) -> anyhow::Result<()> {
    let Arguments { json, shaders, known, names } = Arguments::parse_from(arguments);
    let library = shaders.map_or_else(ShaderLibrary::embedded, |folder| ShaderLibrary::on_disk(&folder));
    let heard = Heard::default();
    tracing_subscriber::registry().with(heard.clone()).init();
    let context = Headless::new(true)?;
    let gl = context.gl();
    let driver = format!("{}, {}", gl.info().renderer, gl.info().version);
    let known = known.map(|gpu| budgets::known(&gpu, &driver)).transpose()?.unwrap_or_default();
    let mut refused = Vec::new();
    for Wanted { name, file, variant } in wanted(gl, &names)? {
        let texts = ProgramTexts::assemble(&library, file, &variant, gl.info())?;
        let hash = texts.text_key().to_string();
        heard.drain();
        let start = ProcessTime::now();
        let counts = match known.get(&hash) {
            Some(counts) => Some(*counts),
            None => {
                if let Err(error) = Program::of(gl, &texts) {
                    refused.push(format!("{name}: {error}"));
                    continue;
                }
                // Skip the vertex shader, which is much shorter.
                heard.drain().iter().filter_map(|line| Counts::read(line)).max_by_key(|counts| counts.code)
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let linked = Linked { driver: driver.clone(), name, hash, counts, seconds };
        if json {
            println!("{}", serde_json::to_string(&linked)?);
        } else {
            let counts = linked.counts.map_or_else(|| "no figures".to_owned(), |counts| counts.to_string());
            println!("{:40} {counts}, {:.2} s", linked.name, linked.seconds);
        }
    }
    if !refused.is_empty() {
        bail!("{driver} rejects:\n{}", refused.join("\n"));
    }
    // Mesa 22.3 crashes in exit handlers while its threads still compile for AMD.
    begin_to_leave().leave(0)
}
