//! Scenes whose images follow from their texts alone, and checks of these images.

use std::time::{Duration, Instant};

use image::RgbaImage;

pub(crate) fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n\
         sky {{ color = 0  ambient = 0 }}\npicture {{ tone_map = none  bloom = 0 }}\n"
    )
}

/// The emission of a motionless wall that is red on the left and blue on the right.
pub(crate) const TWO_COLOURS: &str = "mix(vec3(0.5, 0.01, 0.01), vec3(0.01, 0.01, 0.5), step(0, p.x))";
/// The emission of a wall that slowly becomes brighter and darker. The change is no flash.
pub(crate) const BREATHES: &str = "vec3(0.3 + 0.2 * sin(2 * t))";

/// Returns the colour at a position, which is given in fractions of the image's size.
pub(crate) fn at(picture: &RgbaImage, x: f32, y: f32) -> [u8; 3] {
    let place = |fraction: f32, side: u32| ((fraction * side as f32) as u32).min(side - 1);
    let [red, green, blue, _] = picture.get_pixel(place(x, picture.width()), place(y, picture.height())).0;
    [red, green, blue]
}

pub(crate) fn is_red([red, _, blue]: [u8; 3]) -> bool {
    red > 100 && blue < 60
}

pub(crate) fn is_blue([red, _, blue]: [u8; 3]) -> bool {
    blue > 100 && red < 60
}

pub(crate) fn is_black(color: [u8; 3]) -> bool {
    color == [0; 3]
}

/// Waits until the log reports that the scene `p_foam` is refused. Meanwhile, `wait_for_motion` checks that the last
/// good scene keeps moving.
pub(crate) fn wait_for_refusal(log: impl Fn() -> String, wait_for_motion: impl Fn()) {
    let begun = Instant::now();
    while !log().contains("p_foam is too much for this machine; the last good scene stays") {
        assert!(begun.elapsed() < Duration::from_secs(150), "the scene was not refused: {}", log());
        wait_for_motion();
    }
}

/// Returns `count` spheres.
pub(crate) fn foam(count: usize) -> String {
    format!(
        "object foam {{ shape = smooth_union(for i in 0..{count}: sphere(p - vec3(3 * sin(i * 12.9898), \
         2 + 2 * sin(i * 78.233), 3 * sin(i * 37.719)), 0.25 + 0.1 * sin(t + i)), 0.2) }}"
    )
}

/// Returns a ball with 12,000 ripples. All ripples matter everywhere, so no cell of the tree can drop any: a tree and a
/// frame take minutes. With 1,500 ripples, a fast machine built the tree and drew small frames within the limits.
pub(crate) fn ripples() -> String {
    "object foam { shape = (length(p - vec3(0, 2, 0)) - 3 + 0.02 * sum(for k in 0..8: for i in 0..1500: sin(\
     p.x * sin(i * 12.9898 + k) + p.y * sin(i * 78.233 - k) + p.z * sin(i * 37.719 + k) + t + i))) / 40 }"
        .to_owned()
}
