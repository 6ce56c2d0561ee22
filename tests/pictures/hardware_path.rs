//! What only GPUs run otherwise: the interpreter's loop over single clauses, the stencil's edges, the frame's block
//! without copies. Mesa's option `force_gl_renderer` makes its software renderer pass for a GPU.

#![allow(clippy::unwrap_used)]

use crate::support::compare::{TIGHT, assert_alike};
use crate::support::program::{Outcome, RUN_LIMIT, Workplace};
use crate::support::studio::{Studio, driver, loud_sound, ready};
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::{Interpreter, Mode};
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::{SceneSource, shipped_names};

/// A formula that is no distance, mirrors, and a scene with bands. None has textures: filtered as on a GPU they take
/// minutes on a processor.
const SCENES: [&str; 3] = ["gyroid", "kaleidoscope", "first_steps"];

/// What the program prints, on the software path or as on a GPU.
fn run(place: &Workplace, hardware: bool, arguments: &[&str]) -> String {
    let mut command = place.command(arguments);
    if hardware {
        // Silent about the option itself.
        command.env("force_gl_renderer", "GPU").env("MESA_DEBUG", "silent");
    }
    Outcome::of(&mut command, RUN_LIMIT).done()
}

#[test]
fn a_gpu_would_show_the_same_pictures() {
    let place = Workplace::new();
    let info = run(&place, true, &["--gl-info"]);
    assert!(info.contains("software renderer    no"), "the hardware path is not taken: {info}");
    for scene in SCENES {
        let still = |hardware, mode| {
            let arguments = [
                "still",
                "--scene",
                scene,
                "--sdf",
                mode,
                "--at",
                "62",
                "--size",
                "96x54",
                "-o",
                "still.png",
            ];
            run(&place, hardware, &arguments);
            image::open(place.path("still.png")).unwrap().to_rgba8()
        };
        for mode in ["compiled", "interpreted"] {
            let expected = still(false, mode);
            let actual = still(true, mode);
            assert_alike(&format!("hardware-{scene}-{mode}"), &actual, &expected, TIGHT);
        }
    }
}

#[test]
fn the_universal_interpreter_covers_every_shipped_scene() {
    for name in shipped_names() {
        let scene = ready(&SceneSource::Shipped(name.clone()));
        let own = Interpreter::for_scene(scene.world.traits, &scene.buffers, &scene.plan, &driver(false));
        assert!(Interpreter::universal(own.is_steep()).covers(&own), "{name}: {own:?}");
        assert!(!Interpreter::universal(!own.is_steep()).covers(&own), "{name}");
    }
}

#[test]
fn the_universal_interpreter_draws_what_a_scene_s_own_draws() {
    // With pictures and panels; with a lens; a formula that is no distance.
    for name in ["speakers", "orb", "quadric"] {
        let scene = SceneSource::Shipped(name.to_owned());
        let mut studio = Studio::of(&scene, Mode::Interpreted, Counting::Off);
        let expected = studio.picture(12.0, loud_sound(), (64, 36));
        let steep = studio.world().steep;
        let variant = Interpreter::universal(steep).variant(Counting::Off);
        studio.program = studio.link(&ShaderLibrary::embedded(), &variant);
        let actual = studio.picture(12.0, loud_sound(), (64, 36));
        assert_alike(&format!("universal-{name}"), &actual, &expected, TIGHT);
    }
}
