//! Compares the diagnostic views with rays and formulas on the CPU, and compares the two modes.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::compare::{TIGHT, assert_alike, check_golden};
use crate::support::test_renderer::{TestRenderer, loud_music, silence, speakers};
use glam::DVec3;
use image::RgbaImage;
use mariana::frame::Frame;
use mariana::gpu::program::Program;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::{Mode, as_views, variant_of};
use mariana::gpu::shader_source::ShaderLibrary;
use mariana::scenes::SceneSource;
use mariana::view::legend::{LegendPainter, byte};
use mariana::view::scale::{self, Color, HEAT};
use mariana::view::setup::ViewSetup;
use mariana::view::{VIEWS, View, ViewChoice};
use mariana_field::graph::Point;

/// This size is too small for a legend.
const SIZE: (u32, u32) = (160, 90);

const BALL: &str = "object ball { shape = sphere(p - vec3(0, 1, 0), 1) }
    object floor { shape = p.y }
    light lamp { position = vec3(0, 9, 0)  color = 100 }
    camera { position = vec3(1, 2, -6)  target = vec3(0, 1, 0)  fov = 40 }";

const FLOOR: &str = "object floor { shape = p.y }
    light lamp { position = vec3(0, 9, 0)  color = 100 }
    camera { position = vec3(0, 3, -6)  target = vec3(0)  fov = 50 }";

struct Viewer {
    test_renderer: TestRenderer,
    program: Program,
    mode: Mode,
}

fn written(text: &str) -> SceneSource {
    SceneSource::Formula(text.to_owned())
}

impl Viewer {
    fn of(scene: &SceneSource, mode: Mode) -> Self {
        let test_renderer = TestRenderer::of(scene, mode, Counting::Off);
        let resources = &test_renderer.resources;
        let info = test_renderer.context.gl().info();
        let (buffers, plan) = (resources.buffers(), resources.plan());
        let variant = variant_of(test_renderer.world(), buffers, plan, mode, info, Counting::On).unwrap();
        let program = test_renderer.link(&ShaderLibrary::embedded(), &as_views(variant));
        Self { test_renderer, program, mode }
    }

    fn setup(&self, choice: impl Into<ViewChoice>, frame: &Frame) -> ViewSetup {
        let drawn = self.test_renderer.resources.drawn(self.mode);
        ViewSetup::of(choice.into(), frame, self.test_renderer.world(), drawn)
    }

    fn draw(&mut self, choice: impl Into<ViewChoice>, frame: &Frame, with_legend: bool) -> RgbaImage {
        let setup = self.setup(choice, frame);
        let legend = LegendPainter::default().picture(setup.legend, frame.size).filter(|_| with_legend);
        self.test_renderer
            .renderer
            .draw_view(frame, &self.test_renderer.resources, &self.program, &setup.block, legend.as_deref())
            .unwrap();
        RgbaImage::from_raw(frame.size.0, frame.size.1, self.test_renderer.renderer.read()).unwrap()
    }

    fn frame(&self, size: (u32, u32)) -> Frame {
        self.test_renderer.frame(3.0, silence(), size)
    }

    fn view(&mut self, choice: impl Into<ViewChoice>) -> RgbaImage {
        let frame = self.frame(SIZE);
        self.draw(choice, &frame, false)
    }
}

fn ray(frame: &Frame, x: u32, y: u32) -> (DVec3, DVec3) {
    let camera = &frame.camera;
    let (width, height) = (f64::from(frame.size.0), f64::from(frame.size.1));
    let place = (2.0 * (f64::from(x) + 0.5) / width - 1.0, 1.0 - 2.0 * (f64::from(y) + 0.5) / height);
    let direction =
        camera.forward + place.0 * camera.tan_half.0 * camera.right + place.1 * camera.tan_half.1 * camera.up;
    (camera.position, direction.normalize())
}

/// Intersects a pixel's ray with [`BALL`]. Returns the distance, the normal, and true for the ball; `Some(None)` for
/// the sky; `None` if the ray is too close to the ball's edge or to the horizon.
fn meets(frame: &Frame, x: u32, y: u32) -> Option<Option<(f64, DVec3, bool)>> {
    let (origin, direction) = ray(frame, x, y);
    let center = DVec3::new(0.0, 1.0, 0.0);
    let middle = (center - origin).dot(direction);
    let miss = (origin + middle * direction - center).length();
    if (0.96..1.04).contains(&miss) {
        return None;
    }
    if miss < 1.0 {
        let t = middle - (1.0 - miss * miss).sqrt();
        return Some(Some((t, origin + t * direction - center, true)));
    }
    if direction.y.abs() < 0.01 {
        return None;
    }
    Some((direction.y < 0.0).then(|| (-origin.y / direction.y, DVec3::Y, false)))
}

fn near(pixel: &image::Rgba<u8>, color: Color, steps: u8) -> bool {
    (0..3).all(|channel| pixel.0[channel].abs_diff(byte(color[channel])) <= steps)
}

/// Compares a view of [`BALL`] in both modes with the colours of `witness`. Each channel may differ by `steps` of
/// 0..255.
fn assert_ball(view: ViewChoice, steps: u8, witness: impl Fn(Option<(f64, DVec3, bool)>) -> Option<Color>) {
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut viewer = Viewer::of(&written(BALL), mode);
        let (frame, picture) = (viewer.frame(SIZE), viewer.view(view));
        let mut compared = 0;
        for (x, y, pixel) in picture.enumerate_pixels() {
            let Some(color) = meets(&frame, x, y).and_then(&witness) else { continue };
            compared += 1;
            assert!(near(pixel, color, steps), "{view}, {mode}, at {x}, {y}: {pixel:?}, not {color:?}");
        }
        assert!(compared > 4_000, "only {compared} pixels were compared");
    }
}

#[test]
fn normals_match_the_ball() {
    let exact = |met: Option<(f64, DVec3, bool)>| {
        let color = |n: DVec3| (0.5 + 0.5 * n).as_vec3().to_array();
        Some(met.map_or(scale::NOTHING, |(_, normal, _)| color(normal)))
    };
    assert_ball(View::Normals.into(), 3, exact);
    // Finite differences with a short step also give the ball's normals. With a long step, a box's edges look rounded.
    assert_ball(ViewChoice { view: View::Normals, number: Some(0.02) }, 3, exact);
    let text = "object box { shape = box(p, vec3(1, 1, 1)) }
        camera { position = vec3(0, 0, -6)  target = vec3(0)  fov = 40 }";
    let mut viewer = Viewer::of(&written(text), Mode::Compiled);
    let (fine, coarse) =
        (viewer.view(View::Normals), viewer.view(ViewChoice { view: View::Normals, number: Some(1.0) }));
    let front = [0.5, 0.5, 0.0];
    let fraction = |picture: &RgbaImage| picture.pixels().filter(|pixel| near(pixel, front, 3)).count();
    assert!(
        fraction(&fine) > 900 && fraction(&coarse) < fraction(&fine) / 2,
        "{} {}",
        fraction(&fine),
        fraction(&coarse)
    );
}

#[test]
fn depth_is_the_distance_along_the_ray() {
    assert_ball(ViewChoice { view: View::Depth, number: Some(20.0) }, 1, |met| {
        Some(met.map_or(scale::NOTHING, |(t, _, _)| [(1.0 - t / 20.0).max(0.0) as f32; 3]))
    });
}

#[test]
fn materials_have_the_colours_of_their_objects() {
    assert_ball(View::Materials.into(), 0, |met| {
        Some(met.map_or(scale::NOTHING, |(_, _, ball)| scale::of_object(usize::from(!ball))))
    });
}

#[test]
fn unobstructed_surfaces_are_lit() {
    // The lamp is above the ball. The ball shades only a disc around its foot, and the ball's lower half faces away
    // from the light.
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut viewer = Viewer::of(&written(BALL), mode);
        let (frame, picture) = (viewer.frame(SIZE), viewer.view(View::Shadow));
        let (mut lit, mut dark, mut away) = (0, 0, 0);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let Some(Some((t, normal, ball))) = meets(&frame, x, y) else { continue };
            let (origin, direction) = ray(&frame, x, y);
            let foot = (origin + t * direction) * DVec3::new(1.0, 0.0, 1.0);
            if ball && normal.y > 0.3 || !ball && foot.length() > 2.0 {
                assert!(near(pixel, [1.0; 3], 0), "{mode}: {x}, {y} is {pixel:?}");
                lit += 1;
            } else if ball && normal.y < -0.05 {
                assert!(near(pixel, scale::FACES_AWAY, 0), "{mode}: {x}, {y} is {pixel:?}");
                away += 1;
            } else if !ball && foot.length() < 0.8 {
                assert!(near(pixel, [0.0; 3], 0), "{mode}: {x}, {y} is {pixel:?}");
                dark += 1;
            }
        }
        assert!(lit > 1_000 && away > 100 && dark > 10, "{lit} {away} {dark}");
    }
}

#[test]
fn a_single_plane_is_unoccluded_lit_and_needs_no_steps() {
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut viewer = Viewer::of(&written(FLOOR), mode);
        let frame = viewer.frame(SIZE);
        for (view, below, above) in [
            (View::Occlusion, [1.0; 3], scale::NOTHING),
            (View::Shadow, [1.0; 3], scale::NOTHING),
            (View::Steps, HEAT[0], HEAT[0]),
            (View::Normals, [0.5, 1.0, 0.5], scale::NOTHING),
        ] {
            let picture = viewer.view(view);
            for (x, y, pixel) in picture.enumerate_pixels() {
                let slope = ray(&frame, x, y).1.y;
                if slope.abs() > 0.02 {
                    let expected = if slope < 0.0 { below } else { above };
                    assert!(near(pixel, expected, 1), "{view:?}, {mode}, {x}, {y}: {pixel:?}");
                }
            }
        }
    }
}

#[test]
fn occlusion_darkens_only_the_foot_of_the_ball() {
    let mut viewer = Viewer::of(&written(BALL), Mode::Compiled);
    let (frame, picture) = (viewer.frame(SIZE), viewer.view(View::Occlusion));
    let (mut open, mut closed) = (0, 0);
    for (x, y, pixel) in picture.enumerate_pixels() {
        let Some(Some((t, normal, ball))) = meets(&frame, x, y) else { continue };
        let (origin, direction) = ray(&frame, x, y);
        let foot = ((origin + t * direction) * DVec3::new(1.0, 0.0, 1.0)).length();
        if ball && normal.y > 0.5 || !ball && foot > 3.0 {
            assert!(near(pixel, [1.0; 3], 0), "{x}, {y}: {pixel:?}");
            open += 1;
        } else if !ball && foot < 0.6 {
            assert!(pixel.0[0] < 128, "{x}, {y}: {pixel:?}");
            closed += 1;
        }
    }
    assert!(open > 1_000 && closed > 5, "{open} {closed}");
}

#[test]
fn the_slice_shows_the_sign_and_a_white_line_at_zero() {
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut viewer = Viewer::of(&speakers(), mode);
        let frame = viewer.test_renderer.frame(3.0, loud_music(), SIZE);
        let picture = viewer.draw(View::Slice, &frame, false);
        let world = viewer.test_renderer.world();
        let normal = frame.camera.forward;
        let pixel_width = 2.0 * frame.camera.tan_half.1 / f64::from(SIZE.1);
        let (mut sides, mut zeros) = ([0, 0], 0);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let (origin, direction) = ray(&frame, x, y);
            let t = normal.dot(frame.target() - origin) / normal.dot(direction);
            let p = (origin + t * direction).as_vec3();
            let value =
                world.scene.graph.evaluate(&[world.scene.distance], &Point::at(p.x, p.y, p.z), &frame.inputs)
                    [0];
            let [red, _, blue, _] = pixel.0;
            let width = (pixel_width * t) as f32;
            if value.abs() < 0.05 * width {
                assert!(red > 180 && blue > 180, "{mode}, {x}, {y}: {pixel:?} at the distance {value}");
                zeros += 1;
            } else if value.abs() > 4.0 * width {
                let inside = blue > red;
                assert_eq!(inside, value < 0.0, "{mode}, {x}, {y}: {pixel:?} at the distance {value}");
                sides[usize::from(inside)] += 1;
            }
        }
        assert!(sides[0] > 2_000 && sides[1] > 2_000 && zeros > 15, "{sides:?} {zeros}");
    }
}

#[test]
fn both_modes_show_the_same() {
    let mut pictures = [Mode::Compiled, Mode::Interpreted].map(|mode| {
        let mut viewer = Viewer::of(&speakers(), mode);
        let frame = viewer.test_renderer.frame(12.0, loud_music(), SIZE);
        let same = VIEWS.iter().filter(|row| row.view != View::Clauses);
        same.map(|row| (row.name, viewer.draw(row.view, &frame, false))).collect::<Vec<_>>()
    });
    let [compiled, interpreted] = &mut pictures;
    for ((name, one), (_, other)) in compiled.iter().zip(interpreted.iter()) {
        assert_alike(&format!("view-{name}"), one, other, TIGHT);
        let first = one.get_pixel(80, 80);
        assert!(one.pixels().any(|pixel| pixel != first), "{name} has only one colour");
    }
}

#[test]
fn more_clauses_run_at_visible_objects() {
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut viewer = Viewer::of(&speakers(), mode);
        let frame = viewer.test_renderer.frame(12.0, loud_music(), SIZE);
        let picture = viewer.draw(View::Clauses, &frame, false);
        // The position on the colour scale that is closest to the pixel's colour.
        let fraction = |x: u32, y: u32| {
            let pixel = picture.get_pixel(x, y);
            let off = |fraction: f32| -> i32 {
                let color = scale::heat(fraction).map(byte);
                (0..3).map(|channel| i32::from(pixel.0[channel].abs_diff(color[channel]))).sum()
            };
            (0..=200_u8).map(|step| f32::from(step) / 200.0).min_by_key(|fraction| off(*fraction)).unwrap()
        };
        let mean = |rows: std::ops::Range<u32>| {
            let count = rows.len() as f32 * SIZE.0 as f32;
            rows.flat_map(|y| (0..SIZE.0).map(move |x| (x, y))).map(|(x, y)| fraction(x, y)).sum::<f32>()
                / count
        };
        let (sky, speakers) = (mean(0..5), mean(25..55));
        assert!(sky < speakers && speakers > 0.01, "{mode}: {sky} in the sky, {speakers} at the speakers");
    }
}

#[test]
fn non_lipschitz_scenes_have_every_view() {
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut viewer = Viewer::of(&SceneSource::Shipped("gyroid".into()), mode);
        let frame = viewer.frame((64, 36));
        for row in &VIEWS {
            let picture = viewer.draw(row.view, &frame, false);
            let first = *picture.get_pixel(0, 0);
            let plain = row.view == View::Materials;
            assert!(plain || picture.pixels().any(|pixel| *pixel != first), "{}, {mode}", row.name);
        }
    }
}

#[test]
fn the_legend_covers_the_view_or_is_left_out_if_too_large() {
    let mut viewer = Viewer::of(&written(BALL), Mode::Compiled);
    let frame = viewer.frame((640, 360));
    for row in &VIEWS {
        let setup = viewer.setup(row.view, &frame);
        assert_eq!(setup.legend.title, row.name);
        let legend = LegendPainter::default().picture(setup.legend, frame.size).expect("a legend");
        let (with, without) = (viewer.draw(row.view, &frame, true), viewer.draw(row.view, &frame, false));
        for (x, y, pixel) in with.enumerate_pixels() {
            let column = x.checked_sub(legend.margin).filter(|column| *column < legend.size.0);
            let line = y.checked_sub(legend.margin).filter(|line| *line < legend.size.1);
            let expected = match column.zip(line) {
                Some((column, line)) => {
                    let at = 4 * (line * legend.size.0 + column) as usize;
                    image::Rgba([legend.rgba[at], legend.rgba[at + 1], legend.rgba[at + 2], 255])
                }
                None => *without.get_pixel(x, y),
            };
            assert_eq!(*pixel, expected, "{} at {x}, {y}", row.name);
        }
    }
    let frame = viewer.frame(SIZE);
    for row in &VIEWS {
        assert_eq!(viewer.draw(row.view, &frame, true), viewer.draw(row.view, &frame, false), "{}", row.name);
    }
}

#[test]
fn a_view_does_not_change_the_next_frame() {
    let mut viewer = Viewer::of(&written(BALL), Mode::Compiled);
    let before = viewer.test_renderer.picture(3.0, silence(), SIZE);
    viewer.view(View::Cells);
    viewer.view(View::Normals);
    assert_eq!(viewer.test_renderer.picture(3.0, silence(), SIZE), before);
}

#[test]
fn every_view_matches_its_golden_image() {
    let mut viewer = Viewer::of(&speakers(), Mode::Interpreted);
    let frame = viewer.test_renderer.frame(12.0, loud_music(), SIZE);
    let results = VIEWS.iter().map(|row| {
        let picture = viewer.draw(row.view, &frame, false);
        check_golden(&format!("view-{}", row.name), &picture)
    });
    let failures: Vec<String> = results.filter_map(Result::err).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
