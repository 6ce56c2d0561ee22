//! Scenes with pictures that follow from their texts alone, and how to look at those pictures.

use image::RgbaImage;

/// A wall that shines by itself and fills the picture.
pub(crate) fn wall(emission: &str) -> String {
    format!(
        "material paint {{ color = 0  roughness = 1  emission = {emission} }}\n\
         object wall {{ shape = 5 - p.z  material = paint }}\n\
         light none {{ direction = vec3(0, -1, 0)  color = 0 }}\n\
         camera {{ position = vec3(0)  target = vec3(0, 0, 5) }}\n\
         sky {{ color = 0  ambient = 0 }}\npicture {{ tone_map = none  bloom = 0 }}\n"
    )
}

/// It never moves, is red on the left and blue on the right.
pub(crate) const TWO_COLOURS: &str = "mix(vec3(0.5, 0.01, 0.01), vec3(0.01, 0.01, 0.5), step(0, p.x))";
/// It becomes brighter and darker, slowly enough to be no flash.
pub(crate) const BREATHES: &str = "vec3(0.3 + 0.2 * sin(2 * t))";

/// The colour of the window at a place, in shares of it.
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
