//! Tests the code that usually only GPUs run: the interpreter's loop over single clauses, the edge stencil and the
//! uniform block without copies. Mesa's option `force_gl_renderer` lets its software renderer pass for a GPU.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use crate::support::compare::{LOOSE, TIGHT, assert_alike};
use crate::support::program::{Outcome, Workplace};
use crate::support::test_renderer::{TestRenderer, driver, loud_sound, ready};
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::{Interpreter, Mode};
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::{SceneSource, shipped_names};
use mariana_field::world::SceneFeatures;

/// A non-Lipschitz formula, mirrors, and a scene with bands. These scenes have no textures, because a CPU needs minutes
/// to filter textures as GPUs do.
const SCENES: [&str; 3] = ["gyroid", "kaleidoscope", "first_steps"];

/// What the program takes the software renderer for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Renderer {
    Software,
    Gpu,
    /// A GPU with OpenGL ES only, like that of a Raspberry Pi.
    EmbeddedGpu,
}

fn run(place: &Workplace, renderer: Renderer, arguments: &[&str]) -> String {
    let mut command = place.command(arguments);
    if renderer == Renderer::EmbeddedGpu {
        command.env("MESA_GL_VERSION_OVERRIDE", "3.1").env("MESA_GLES_VERSION_OVERRIDE", "3.0");
    }
    if renderer != Renderer::Software {
        // Hide Mesa's message about the option.
        command.env("force_gl_renderer", "GPU").env("MESA_DEBUG", "silent");
    }
    Outcome::of(&mut command).done()
}

/// Writes shaders without beams. Then additional samples start at the eye on a software renderer too, as on a GPU.
fn shaders_without_beams(place: &Workplace) -> String {
    let folder = place.path("shaders");
    std::fs::create_dir(&folder).unwrap();
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders")).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        let has_beams = path.ends_with("beams.glsl");
        assert_eq!(has_beams, text.contains(BEAMS), "{}", path.display());
        std::fs::write(folder.join(path.file_name().unwrap()), text.replace(BEAMS, "")).unwrap();
    }
    folder.to_str().unwrap().to_owned()
}

const BEAMS: &str = "#define BEAMS\n";

#[test]
fn the_gpu_path_draws_the_same_images() {
    let place = Workplace::new();
    for (renderer, interface) in [(Renderer::Gpu, "OpenGL"), (Renderer::EmbeddedGpu, "OpenGL ES")] {
        let info = run(&place, renderer, &["--gl-info"]);
        assert!(info.contains("software renderer    no"), "the hardware path is not used: {info}");
        assert!(info.contains(&format!("interface            {interface}\n")), "{info}");
    }
    let without_beams = shaders_without_beams(&place);
    for scene in SCENES {
        let still = |renderer, mode, more: &[&str]| {
            let arguments = ["still", "--scene", scene, "--sdf", mode, "--at", "62", "--size", "96x54"];
            run(&place, renderer, &[&arguments[..], more, &["-o", "still.png"]].concat());
            image::open(place.path("still.png")).unwrap().to_rgba8()
        };
        for mode in ["compiled", "interpreted"] {
            let actual = still(Renderer::Gpu, mode, &[]);
            let expected = still(Renderer::Software, mode, &["--shaders", &without_beams]);
            assert_alike(&format!("hardware-{scene}-{mode}"), &actual, &expected, TIGHT);
            let embedded = still(Renderer::EmbeddedGpu, mode, &[]);
            assert_alike(&format!("hardware-es-{scene}-{mode}"), &embedded, &expected, TIGHT);
            // With beams, rays start farther from the eye, so their hits differ by up to a quarter of a pixel.
            let with_beams = still(Renderer::Software, mode, &[]);
            assert_alike(&format!("hardware-{scene}-{mode}-beams"), &actual, &with_beams, LOOSE);
        }
    }
}

/// The first scene has rods of a fifth of a pixel in front of a ball. The second has a pin on a block that fills its
/// bounds. Additional samples miss the rods and the pin if the samples' rays start too far from the eye.
const THIN: [&str; 2] = [
    "material white { color = vec3(1) }\n\
     material red { color = vec3(0.8, 0.1, 0.1) }\n\
     object rods { shape = length(vec2(mod(p.x + 0.1, 0.2) - 0.1, p.z + 1.5)) - 0.004  material = white }\n\
     object ball { shape = sphere(p, 1)  material = red }\n\
     camera { position = vec3(0.3, 0.6, -5)  target = vec3(0) }",
    "object block { shape = box(p, vec3(1, 0.6, 0.8)) }\n\
     object pin { shape = box(p - vec3(0, 0.9, -0.79), vec3(0.004, 0.3, 0.004)) }\n\
     camera { position = vec3(2.5, 1.4, -4)  target = vec3(0) }",
];

#[test]
fn further_samples_find_details_thinner_than_a_pixel() {
    let place = Workplace::new();
    for (number, scene) in THIN.into_iter().enumerate() {
        place.write("thin.scene", scene);
        let [beams, all] = [Renderer::Software, Renderer::Gpu].map(|renderer| {
            let arguments = [
                "still",
                "--scene",
                "thin.scene",
                "--sdf",
                "compiled",
                "--size",
                "160x90",
                "-o",
                "still.png",
            ];
            run(&place, renderer, &arguments);
            image::open(place.path("still.png")).unwrap().to_rgba8()
        });
        // On a GPU, samples start at the eye, so `all` contains every detail.
        assert_alike(&format!("beams-{number}"), &beams, &all, TIGHT);
    }
}

/// A scene with a lens, and with edges that need additional samples.
const LENS: &str = "object ball { shape = sphere(p - vec3(0, 1, 0), 1) }\n\
                    object floor { shape = p.y }\n\
                    camera { position = vec3(0, 1, -4)  target = vec3(0, 1, 0)  aperture = 0.05 }";

/// Maximum number of pixels in one draw call: 0.12 s at 0.1 ms per pixel, and some room for the overhead.
const PART_PIXELS: u64 = 1_300;

#[test]
fn expensive_pixels_are_drawn_in_small_parts() {
    let place = Workplace::new();
    place.write("lens.scene", LENS);
    let jobs: [&[&str]; 3] = [
        &["still", "--size", "96x54", "-o", "pictures/0.png"],
        &["still", "--size", "96x54", "--view", "steps", "-o", "pictures/0.png"],
        &["video", "--size", "96x54", "--duration", "0.1", "--fps", "30", "-o", "pictures/"],
    ];
    for (job, mode, hardware) in jobs
        .iter()
        .flat_map(|job| [(job, "compiled", true), (job, "interpreted", true), (job, "compiled", false)])
    {
        let pictures = |fault: Option<&str>| {
            let folder = place.path("pictures");
            let _ = std::fs::remove_dir_all(&folder);
            std::fs::create_dir(&folder).unwrap();
            let arguments = [job, &["--scene", "lens.scene", "--sdf", mode, "-vv"][..]].concat();
            let mut command = place.command(&arguments);
            if hardware {
                command.env("force_gl_renderer", "GPU").env("MESA_DEBUG", "silent");
            }
            command.envs(fault.map(|fault| ("MARIANA_FAULT", fault)));
            let outcome = Outcome::of(&mut command);
            assert_eq!(outcome.code, 0, "{outcome:?}");
            let mut names: Vec<_> =
                std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
            names.sort();
            let read = |name| image::open(name).unwrap().to_rgba8();
            (names.into_iter().map(read).collect::<Vec<_>>(), draws(&outcome.stderr))
        };
        let (expected, _) = pictures(None);
        let (actual, draws) = pictures(Some("dear-pixels@0"));
        let name = format!("{job:?}, {mode}, as on a GPU: {hardware}");
        assert!(actual == expected, "{name}: images drawn in parts differ");
        assert_eq!(draws.len(), expected.len(), "{name}");
        for (number, largest) in draws {
            assert!(number > 96 * 54 / PART_PIXELS && largest <= PART_PIXELS, "{name}: {number}, {largest}");
        }
    }
}

/// For each frame in the log: the number of draw calls, and the number of pixels in the largest draw call.
fn draws(log: &str) -> Vec<(u64, u64)> {
    let number = |text: &str| text.split_whitespace().next_back()?.parse().ok();
    let of_line = |line: &str| {
        let (draws, rest) = line.split_once(" draws, the largest of ")?;
        Some((number(draws)?, rest.split_once(' ')?.0.parse().ok()?))
    };
    log.lines().filter_map(of_line).collect()
}

#[test]
fn the_universal_interpreter_covers_every_shipped_scene() {
    for name in shipped_names() {
        let scene = ready(&SceneSource::Shipped(name.clone()));
        let mut own =
            Interpreter::for_scene(scene.world.features, &scene.buffers, &scene.plan, &driver(false));
        let general = scene.world.features.with_usual();
        if general != SceneFeatures::USUAL {
            // Scenes with rare features share other interpreters, which differ in the code for these alone.
            assert!(
                own == Interpreter::for_scene(general, &scene.buffers, &scene.plan, &driver(false)),
                "{name}"
            );
            own = Interpreter::for_scene(SceneFeatures::USUAL, &scene.buffers, &scene.plan, &driver(false));
        }
        assert!(Interpreter::universal(own.is_non_lipschitz()).covers(&own), "{name}: {own:?}");
        assert!(!Interpreter::universal(!own.is_non_lipschitz()).covers(&own), "{name}");
    }
}

#[test]
fn the_universal_interpreter_draws_the_same_as_a_scenes_own() {
    // Rounding moves the edges in blurred mirrors: at 12 s, five pixels of the speakers.
    for (name, time) in [("speakers", 7.0), ("orb", 12.0), ("quadric", 12.0)] {
        let scene = SceneSource::Shipped(name.to_owned());
        let mut test_renderer = TestRenderer::of(&scene, Mode::Interpreted, Counting::Off);
        let expected = test_renderer.picture(time, loud_sound(), (64, 36));
        let non_lipschitz = test_renderer.world().non_lipschitz;
        let variant = Interpreter::universal(non_lipschitz).variant(Counting::Off);
        test_renderer.program = test_renderer.link(&ShaderLibrary::embedded(), &variant);
        let actual = test_renderer.picture(time, loud_sound(), (64, 36));
        assert_alike(&format!("universal-{name}"), &actual, &expected, TIGHT);
    }
}
