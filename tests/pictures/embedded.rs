//! Tests that OpenGL ES 3.0 draws the same images as OpenGL 3.3.

#![allow(clippy::unwrap_used)]

use crate::support::compare::{LOOSE, TIGHT, assert_alike};
use crate::support::test_renderer::{TestRenderer, loud_sound, ready};
use mariana::gpu::api::Api;
use mariana::gpu::headless::Headless;
use mariana::gpu::picture_reader::PictureReader;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::placement::Placement;
use mariana::scenes::SceneSource;

/// Textures and mirrors, sound tables, a formula that is not a distance, and depth of field.
const SCENES: [&str; 4] = ["speakers", "terrain", "gyroid", "tunnel"];

/// A context of OpenGL ES.
fn embedded() -> Headless {
    Headless::with(&[Api::Embedded], false).unwrap()
}

fn renderer(context: Headless, scene: &str, mode: Mode) -> TestRenderer {
    let scene = ready(&SceneSource::Shipped(scene.to_owned()));
    TestRenderer::in_context(context, scene, mode, Counting::Off)
}

#[test]
fn opengl_es_draws_the_same_images() {
    for scene in SCENES {
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let [expected, actual] = [Api::Desktop, Api::Embedded].map(|api| {
                let context = Headless::with(&[api], false).unwrap();
                let mut test_renderer = renderer(context, scene, mode);
                let image = test_renderer.picture(62.0, loud_sound(), (96, 54));
                (test_renderer.context.gl().info().api, image)
            });
            assert_eq!((expected.0, actual.0), (Api::Desktop, Api::Embedded));
            assert_alike(&format!("embedded-{scene}-{mode}"), &actual.1, &expected.1, TIGHT);
        }
    }
}

/// The tree of this scene fills more than the first row of its texture in OpenGL ES.
#[test]
fn lists_longer_than_a_row_grow_and_shrink() {
    let mut test_renderer = renderer(embedded(), "lattice", Mode::Interpreted);
    let mut image = |cells: bool| {
        test_renderer.resources.set_cells(cells, Mode::Interpreted);
        let image = test_renderer.picture(1.0, loud_sound(), (48, 27));
        let texels = test_renderer.resources.regions().unwrap().regions.texels.len();
        (texels, image)
    };
    let (few, whole) = image(false);
    let (many, divided) = image(true);
    assert!(few < 2048 && many > 8192, "{few} and {many} texels");
    // Rays that skip cells hit surfaces at slightly different points.
    assert_alike("embedded-lattice-cells", &divided, &whole, LOOSE);
    assert!(image(false) == (few, whole), "the image without cells has changed");
}

#[test]
fn an_image_is_sent_unchanged() {
    let size = (40, 24);
    let mut test_renderer = renderer(embedded(), "first_steps", Mode::Compiled);
    let gl = test_renderer.context.gl().clone();
    test_renderer.renderer.prepare_for_window(&ShaderLibrary::embedded()).unwrap();
    let expected = test_renderer.picture(2.0, loud_sound(), size);
    let mut reader = PictureReader::new(&gl, size).unwrap();
    let whole = Placement::default();
    assert!(test_renderer.renderer.send_placed(&mut reader, &whole.map(), whole.part()).unwrap());
    gl.finish();
    assert!(reader.drain().unwrap() == expected.into_raw(), "the sent image differs");
}
