//! Texts in the scene language.

use mariana_field::glsl_import::{GlslFile, Shown, scene_around};
use mariana_field::graph::{FrameInputs, Levels, SoundInputs};
use mariana_field::lang::{self, Diagnostic, Sources};
use mariana_field::limits::LIMITS;
use mariana_field::world::{ShortPrograms, ShortenOptions, World, WorldError};

use super::bytes::hash;
use super::random::Random;
use super::words;

/// Scenes with more clauses are not compiled to GLSL here.
const GLSL_CLAUSES_MAX: usize = 6_000;

pub(crate) fn syntax(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let (diagnostics, sources) = lang::check_syntax("fuzz", &text);
    for diagnostic in &diagnostics {
        let span = diagnostic.span;
        assert!(span.start <= span.end && span.end as usize <= text.len(), "{diagnostic:?}");
    }
    // Render only some mistakes, because rendering a mistake is slower than finding it. The target `scene` renders
    // all mistakes.
    if hash(data).is_multiple_of(8) {
        check(&diagnostics, &sources);
    }
}

/// Checks that each mistake has a position in the text and can be rendered.
fn check(diagnostics: &[Diagnostic], sources: &Sources) {
    assert!(diagnostics.len() <= mariana_field::limits::LIMITS.scene_diagnostics_max + 1);
    for diagnostic in diagnostics {
        assert!(sources.place(diagnostic.span.start).is_some(), "{diagnostic:?}");
        assert!(diagnostic.span.start <= diagnostic.span.end, "{diagnostic:?}");
    }
    let reported = lang::render_all(diagnostics, sources, true);
    assert_eq!(reported.is_empty(), diagnostics.is_empty());
}

/// Imports a GLSL text: parses it, executes its functions, and writes a scene around it.
pub(crate) fn glsl(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let check_place = |problem: &Diagnostic| {
        let place = problem.span;
        assert!(place.start <= place.end && place.end as usize <= text.len(), "{problem:?}");
        assert!(!problem.message.is_empty());
    };
    for shown in [Shown::Picture, Shown::Shape] {
        match scene_around(&text, shown) {
            Ok(around) => {
                let compiled =
                    lang::compile("fuzz", &around.text("a.glsl"), &mut |_| Ok(text.clone().into_owned()));
                assert_eq!(compiled.scene.is_some(), compiled.diagnostics.is_empty());
                check(&compiled.diagnostics, &compiled.sources);
            }
            Err(problem) => check_place(&problem),
        }
    }
    match GlslFile::parse(&text, &LIMITS) {
        Ok(file) => {
            file.functions().iter().filter_map(|function| file.problem_of(function)).for_each(check_place)
        }
        Err(problem) => check_place(&problem),
    }
}

/// Compiles a text to a world; `None` if the text is not a valid scene. The text can include itself, or a file with a
/// function.
pub(crate) fn world(data: &[u8]) -> Option<World> {
    let text = String::from_utf8_lossy(data);
    let compiled = lang::compile("fuzz", &text, &mut |path| match path {
        "a.scene" => Ok("fn a(p) = length(p) - 1".to_owned()),
        "self.scene" => Ok(text.clone().into_owned()),
        _ => Err("there is no such file".to_owned()),
    });
    assert_eq!(compiled.scene.is_some(), compiled.diagnostics.is_empty());
    check(&compiled.diagnostics, &compiled.sources);
    match World::new("fuzz", compiled.scene?, Vec::new()) {
        Ok(world) => Some(world),
        Err(error @ (WorldError::Refused { .. } | WorldError::Text(_))) => panic!("{error}"),
        // The scene exceeds a limit.
        Err(WorldError::TooLarge { .. }) => None,
    }
}

/// Compiles a scene to all forms that are drawn.
pub(crate) fn scene(data: &[u8]) {
    let Some(world) = world(data) else { return };
    let buffers = world.tape_buffers();
    let mut random = Random(hash(data));
    for _ in 0..2 {
        let inputs = frame_of(&world, &mut random);
        world.frame_tape.values(&inputs);
        let options = ShortenOptions::default();
        let request = buffers.worth_shortening().request(&buffers, &inputs);
        let short = buffers.shorten(&inputs, &request, &options);
        for (short, most) in [(ShortPrograms::default(), 0), (short, options.texels_max)] {
            let texels = buffers.texels(&inputs, &short);
            assert!(texels.len() <= buffers.texels_max().max(most));
            words::check_directory(&texels, world.scene.objects.len());
        }
    }
    if buffers.cost.total <= GLSL_CLAUSES_MAX
        && let Err(error @ WorldError::Refused { .. }) = world.compiled_glsl()
    {
        panic!("{error}");
    }
}

/// Returns random frame inputs for a world, as the show could supply them.
pub(crate) fn frame_of(world: &World, random: &mut Random) -> FrameInputs {
    let mut inputs = some_sound(random);
    inputs.params = world.scene.params.iter().map(|param| random.between(param.min, param.max)).collect();
    inputs.hoisted = world.hoisted.values(&inputs);
    inputs
}

/// Returns random sound features within their ranges.
pub(crate) fn some_sound(random: &mut Random) -> FrameInputs {
    let loud = random.below(3) as f32 / 2.0;
    let mut unit = || loud * random.between(0.0, 1.0);
    let mut inputs = FrameInputs {
        levels: Levels::each(|list, _| list.range().1 * unit()),
        sound: SoundInputs::each(|input| input.range().1 * unit()),
        ..super::random::frame()
    };
    inputs.time = random.between(0.0, 600.0);
    inputs.params = Vec::new();
    inputs
}
