//! Regression test: single pixels of a surface that directly faces the lamp were in shadow. The shader had assumed that
//! the closest approach of the shadow ray was behind the ray's start.

use crate::support::test_renderer::TestRenderer;
use mariana::demo_track::DEMO_TRACK;
use mariana::export::song_features::SongFeatures;

/// The error was visible at this time and size.
const TIME: f64 = 62.0;
const SIZE: (u32, u32) = (1280, 720);
/// The middle of the right woofer and a radius inside the woofer's rim, in units of the scene.
const WOOFER: glam::DVec3 = glam::DVec3::new(5.0, 2.0, 7.8);
const RADIUS: f64 = 1.25;

#[test]
fn no_single_pixel_of_a_lit_woofer_is_dark() {
    let features = SongFeatures::open(&DEMO_TRACK, TIME).unwrap().require(TIME).unwrap().features;
    let mut test_renderer = TestRenderer::new();
    let frame = test_renderer.frame(TIME, features, SIZE);
    let picture = test_renderer.picture(TIME, features, SIZE);

    let pixel_of = |point| {
        let (x, y) = frame.camera.project(point).unwrap();
        ((0.5 + 0.5 * x) * f64::from(SIZE.0), (0.5 - 0.5 * y) * f64::from(SIZE.1))
    };
    let (left, top) = pixel_of(WOOFER + glam::DVec3::new(-RADIUS, RADIUS, 0.0));
    let (right, bottom) = pixel_of(WOOFER + glam::DVec3::new(RADIUS, -RADIUS, 0.0));
    let green = |x: usize, y: usize| i32::from(picture.get_pixel(x as u32, y as u32).0[1]);
    let mut looked_at = 0;
    for y in top as usize..bottom as usize {
        for x in left as usize..right as usize {
            let darkest_around =
                [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)].map(|(x, y)| green(x, y)).into_iter().min();
            assert!(
                green(x, y) + 12 > darkest_around.unwrap(),
                "the pixel {x}, {y} is darker than its neighbours"
            );
            looked_at += 1;
        }
    }
    assert!(looked_at > 10_000, "only {looked_at} pixels of the woofer were compared");
}
