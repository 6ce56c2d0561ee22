//! Fades between scenes: the first frame, the last frame and the frames between. Rehearsals (invisible frames that warm
//! up a scene) must not change the image.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::{TestRenderer, ready, silence};
use mariana::frame::Frame;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::{Mode, link_scene, variant_of};
use mariana::gpu::scene_resources::SceneResources;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::{ReadyScene, SceneSource};

const SIZE: (u32, u32) = (64, 36);

/// A wall that emits light and fills the frame, without a tone map.
fn wall(light: f64) -> SceneSource {
    SceneSource::Formula(format!(
        "material paint {{ color = 0 roughness = 1 emission = {light} }}\n\
         object wall {{ shape = 5 - p.z material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0) color = 0 }}\n\
         camera {{ position = vec3(0) target = vec3(0, 0, 5) }}\n\
         sky {{ color = 0 ambient = 0 }}\npicture {{ tone_map = none bloom = 0 }}\n"
    ))
}

struct Other {
    resources: SceneResources,
    program: Program,
}

impl Other {
    fn of(scene: &SceneSource, test_renderer: &TestRenderer) -> Self {
        let ReadyScene { world, buffers, plan, .. } = ready(scene);
        let gl = test_renderer.context.gl();
        let variant = variant_of(&world, &buffers, &plan, Mode::Compiled, gl.info(), Counting::Off).unwrap();
        let program = link_scene(gl, &ShaderLibrary::embedded(), &variant).unwrap();
        Self { resources: SceneResources::upload(gl, None, world, buffers, plan).unwrap(), program }
    }

    fn frame(&self) -> Frame {
        Frame::new(self.resources.world(), 0.0, silence(), SIZE)
    }

    fn picture(&self, test_renderer: &mut TestRenderer) -> Vec<u8> {
        test_renderer.renderer.draw(&self.frame(), &self.resources, &self.program).unwrap();
        test_renderer.renderer.read()
    }
}

fn steps(a: &[u8], b: &[u8]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

#[test]
fn a_fade_begins_with_one_scene_and_ends_with_the_other() {
    let mut test_renderer =
        TestRenderer::of(&SceneSource::Shipped("first_steps".into()), Mode::Compiled, Counting::Off);
    let other = Other::of(&SceneSource::Shipped("moonrise".into()), &test_renderer);
    let pure = other.picture(&mut test_renderer);
    let before = test_renderer.picture(0.0, silence(), SIZE).into_raw();
    assert!(steps(&pure, &before) > 60, "the two images are too similar for this test");
    assert!(test_renderer.renderer.keep_light().unwrap());
    let mut with = |fraction| {
        test_renderer.renderer.set_fade(fraction);
        other.picture(&mut test_renderer)
    };
    // The stored light is rounded to 16 bits.
    assert!(steps(&with(Some(1.0)), &before) <= 1);
    let between = with(Some(0.5));
    assert!(steps(&between, &before) > 20 && steps(&between, &pure) > 20);
    assert_eq!(with(Some(0.0)), pure);
    assert_eq!(with(None), pure);
}

#[test]
fn between_two_scenes_is_the_mean_of_their_light() {
    let mut test_renderer = TestRenderer::of(&wall(0.8), Mode::Compiled, Counting::Off);
    let [other, mean] = [0.1, 0.45].map(|light| Other::of(&wall(light), &test_renderer));
    let mean = mean.picture(&mut test_renderer);
    test_renderer.picture(0.0, silence(), SIZE);
    assert!(test_renderer.renderer.keep_light().unwrap());
    test_renderer.renderer.set_fade(Some(0.5));
    let faded = other.picture(&mut test_renderer);
    assert!(steps(&faded, &mean) <= 1, "{:?} and {:?}", &faded[..4], &mean[..4]);
}

#[test]
fn a_fade_needs_an_earlier_frame() {
    let mut test_renderer = TestRenderer::of(&wall(0.8), Mode::Compiled, Counting::Off);
    assert!(!test_renderer.renderer.keep_light().unwrap());
}

#[test]
fn a_rehearsal_leaves_the_picture_and_its_light_alone() {
    let mut test_renderer = TestRenderer::of(&wall(0.8), Mode::Compiled, Counting::Off);
    let other = Other::of(&wall(0.1), &test_renderer);
    let before = test_renderer.picture(0.0, silence(), SIZE).into_raw();
    let small = Frame::new(other.resources.world(), 0.0, silence(), (18, 14));
    test_renderer.renderer.rehearse(&small, &other.resources, &other.program).unwrap();
    assert_eq!(test_renderer.renderer.read(), before);
    assert!(test_renderer.renderer.keep_light().unwrap());
    test_renderer.renderer.set_fade(Some(1.0));
    assert!(steps(&other.picture(&mut test_renderer), &before) <= 1);
}
