//! Projections and motion blur: the shader's rays are those of the CPU, in both modes.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::silence;
use glam::DVec3;
use image::RgbaImage;
use mariana::config::SdfChoice;
use mariana::export::SceneChoice;
use mariana::export::show_painter::ShowPainter;
use mariana::frame::Frame;
use mariana::frame::projection::{EyeRay, Projection, ProjectionKind, Stereo};
use mariana::scenes::{ReadyScene, SceneSource};

/// The camera is inside a ball, whose colours are the coordinates of its points.
const INSIDE: &str = "material paint { color = 0  roughness = 1  emission = srgb(0.5 + p / 12) }\n\
    object ball { shape = 5 - length(p)  material = paint }\n\
    light none { direction = vec3(0, -1, 0)  color = 0 }\n\
    camera { position = vec3(1, 0.5, -0.5)  target = vec3(2, 1, 1)  fov = 70  roll = 0.2 }\n";
const PLAIN: &str = "\npicture { tone_map = none  bloom = 0  grain = 0";
const RADIUS: f64 = 5.0;
const MODES: [SdfChoice; 2] = [SdfChoice::Interpreted, SdfChoice::Compiled];

fn painter(text: &str, projection: Projection, sdf: SdfChoice) -> (ShowPainter, ReadyScene) {
    // Only the corners of flat pictures become darker.
    let vignette = if projection.is_plain() { 0.0 } else { 0.5 };
    let source = SceneSource::Formula(format!("{text}{PLAIN}  vignette = {vignette} }}"));
    let ready = source.ready().unwrap();
    let choice = SceneChoice { projection, sdf, ..source.into() };
    (ShowPainter::of_scene(&choice, ready.clone(), &[]).unwrap(), ready)
}

fn drawn(painter: &mut ShowPainter, size: (u32, u32)) -> RgbaImage {
    painter.draw(0.0, vec![(0.0, silence().into())], Vec::new(), size).unwrap();
    RgbaImage::from_raw(size.0, size.1, painter.read()).unwrap()
}

fn met(EyeRay { origin, direction }: EyeRay) -> DVec3 {
    let middle = -origin.dot(direction);
    origin + direction * (middle + (middle * middle - origin.length_squared() + RADIUS * RADIUS).sqrt())
}

fn all_projections() -> impl Iterator<Item = Projection> {
    let kinds = [ProjectionKind::Flat, ProjectionKind::Sphere, ProjectionKind::Dome, ProjectionKind::Vr180];
    let stereos = [Stereo::None, Stereo::SideBySide, Stereo::OverUnder];
    kinds.into_iter().flat_map(move |kind| {
        let of = move |stereo| Projection { kind, stereo, eye_distance: 1.5, dome_tilt: 30.0 };
        stereos.into_iter().map(of)
    })
}

#[test]
fn every_pixel_shows_the_point_that_its_ray_meets() {
    for sdf in MODES {
        for projection in all_projections() {
            let size = (32, 24);
            let (mut painter, scene) = painter(INSIDE, projection, sdf);
            let picture = drawn(&mut painter, size);
            let frame = Frame::new(&scene.world, 0.0, silence(), size).projected(&scene.world, projection);
            let mut outside = 0;
            for (x, y, pixel) in picture.enumerate_pixels() {
                let at = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                let wanted = match projection.ray(&frame.camera, size, at) {
                    Some(ray) => met(ray).to_array().map(|place| 255.0 * (0.5 + place / 12.0)),
                    None => {
                        outside += 1;
                        // Further samples of a pixel at the rim see the ball.
                        continue;
                    }
                };
                // A pixel at the rim of a dome is partly black.
                let around = [(-0.7, 0.0), (0.7, 0.0), (0.0, -0.7), (0.0, 0.7)].into_iter();
                let around = around.chain([(-0.45, -0.45), (0.45, -0.45), (-0.45, 0.45), (0.45, 0.45)]);
                let near_rim = around
                    .map(|(right, down)| (at.0 + right, at.1 + down))
                    .any(|at| projection.ray(&frame.camera, size, at).is_none());
                let is_right = pixel.0.iter().zip(wanted).all(|(byte, wanted)| {
                    // Pixels are wide, and their samples are averaged.
                    (f64::from(*byte) - wanted).abs() < 5.0
                });
                assert!(is_right || near_rim, "{projection:?} {sdf:?}: {pixel:?} at {x},{y}, not {wanted:?}");
            }
            assert_eq!(outside > 100, projection.kind == ProjectionKind::Dome, "{outside}");
            if outside > 0 {
                assert_eq!(picture.get_pixel(0, 0).0[..3], [0; 3]);
            }
        }
    }
}

#[test]
fn a_flat_picture_is_a_part_of_the_sphere() {
    let text = "object ball { shape = sphere(p - vec3(0.4, 1, 0), 1) }\nobject floor { shape = y }\n\
                sky { color = 0.5 + 0.4 * direction }\n\
                camera { position = vec3(0, 1, -4)  target = vec3(0.5, 1, 0)  fov = 60 }\n";
    let (flat_size, size) = ((64, 48), (1024, 512));
    let sphere = Projection { kind: ProjectionKind::Sphere, ..Projection::default() };
    let flat = drawn(&mut painter(text, Projection::default(), SdfChoice::Compiled).0, flat_size);
    let (mut sphere_painter, scene) = painter(text, sphere, SdfChoice::Compiled);
    let whole = drawn(&mut sphere_painter, size);
    let camera = Frame::new(&scene.world, 0.0, silence(), flat_size).camera;
    let mut differences: Vec<u8> = Vec::new();
    for (x, y, pixel) in flat.enumerate_pixels() {
        let at = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let direction = Projection::default().ray(&camera, flat_size, at).unwrap().direction;
        let (right, up, forward) =
            (direction.dot(camera.right), direction.dot(camera.up), direction.dot(camera.forward));
        let across = 0.5 + right.atan2(forward) / std::f64::consts::TAU;
        let down = 0.5 - up.asin() / std::f64::consts::PI;
        let place = |fraction: f64, side: u32| (fraction * f64::from(side)) as u32;
        let other = whole.get_pixel(place(across, size.0), place(down, size.1));
        differences.extend(pixel.0.iter().zip(other.0).map(|(a, b)| a.abs_diff(b)));
    }
    let large = differences.iter().filter(|difference| **difference > 12).count();
    // At edges, pixels of different sizes differ.
    assert!(large * 25 < differences.len(), "{large} of {}", differences.len());
}

#[test]
fn each_eye_sees_the_whole_of_a_scene_of_pixels() {
    for sdf in MODES {
        let stereo =
            Projection { kind: ProjectionKind::Sphere, stereo: Stereo::OverUnder, ..Projection::default() };
        let (mut painter, _) = painter("sky { color = srgb(vec3(pixel / resolution, 0)) }", stereo, sdf);
        let picture = drawn(&mut painter, (32, 32));
        for (x, y, pixel) in picture.enumerate_pixels() {
            let wanted = [(x as f32 + 0.5) / 32.0, 1.0 - ((y % 16) as f32 + 0.5) / 16.0];
            for (byte, wanted) in pixel.0.iter().zip(wanted) {
                assert!((f32::from(*byte) - 255.0 * wanted).abs() < 1.6, "{pixel:?} at {x},{y}");
            }
        }
    }
}
