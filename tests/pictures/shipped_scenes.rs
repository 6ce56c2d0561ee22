//! Checks of the shipped scenes. Each scene has one test, which compiles the scene's programs once for all checks.

#![allow(clippy::unwrap_used)]

use crate::support::test_renderer::TestRenderer;
use crate::{followed_sounds, ray_oracle, scene_looks, scene_modes, shaders};
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::scenes::{SceneSource, shipped_names};

fn check(name: &str) {
    let scene = SceneSource::Shipped(name.to_owned());
    let mut renderer = TestRenderer::of(&scene, Mode::Compiled, Counting::On);
    scene_looks::check_look(name, &mut renderer);
    scene_modes::check_modes(name, &mut renderer);
    followed_sounds::check_follows(name, &mut renderer);
    drop(renderer);
    shaders::check_embedded_shaders(&scene);
    ray_oracle::check_hits(name);
}

macro_rules! tests_of {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            check(stringify!($name));
        })*

        #[test]
        fn every_shipped_scene_has_a_test() {
            assert_eq!(shipped_names(), [$(stringify!($name)),*]);
        }
    };
}

tests_of! {
    barth
    cathedral
    city
    clockwork
    cloud_sea
    fireflies
    first_steps
    forest
    glass_organ
    gyroid
    heart
    ink
    kaleidoscope
    lattice
    lava_lamp
    letters
    library
    mandelbulb
    marbling
    metaballs
    moonrise
    nave
    orb
    quadric
    rain
    reef
    speakers
    spiral
    terrain
    tunnel
    village
    wave_tank
    wax_world
}
