//! Lights and materials in images: panels, ranges, shadows, glow, mirrors, blends, and invalid values.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support::test_renderer::{TestRenderer, loud_music, silence};
use image::RgbaImage;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;
use mariana::scenes::SceneSource;

const SIZE: (u32, u32) = (96, 54);

/// A floor seen from above, 8 units wide. Each test adds the lights.
const FLOOR: &str = "
object floor { shape = p.y  material = chalk }
material chalk { color = 0.6  roughness = 1 }
sky { color = 0  ambient = 0 }
camera { position = vec3(0, 7, 0)  target = vec3(0, 0, 0.001)  fov = 35 }
";

fn test_renderer_of(text: &str) -> TestRenderer {
    TestRenderer::of(&SceneSource::Formula(text.into()), Mode::Compiled, Counting::Off)
}

fn picture(text: &str) -> RgbaImage {
    test_renderer_of(text).picture(0.0, silence(), SIZE)
}

fn on_floor(lights: &str) -> RgbaImage {
    picture(&format!("{FLOOR}{lights}"))
}

/// Returns the sum of red, green and blue at a position, which is given in fractions of the image's size.
fn brightness(picture: &RgbaImage, x: f64, y: f64) -> i32 {
    colour(picture, x, y).into_iter().sum()
}

fn colour(picture: &RgbaImage, x: f64, y: f64) -> [i32; 3] {
    let at = |fraction: f64, side: u32| (fraction * f64::from(side)) as u32;
    let [r, g, b, _] = picture.get_pixel(at(x, SIZE.0), at(y, SIZE.1)).0.map(i32::from);
    [r, g, b]
}

#[test]
fn a_light_too_weak_for_a_visible_shadow_sends_no_rays() {
    let counted = |lights: &str| {
        let text = format!("{FLOOR}object ball {{ shape = sphere(p - vec3(0, 1, 0), 0.7) }}\n{lights}");
        let mut drawn = TestRenderer::of(&SceneSource::Formula(text), Mode::Compiled, Counting::On);
        (drawn.picture(0.0, silence(), SIZE), drawn.renderer.evaluations(1.0).shadow)
    };
    let sun = "light sun { direction = vec3(0.4, -1, 0.2)  color = 3 }\n";
    let lamp = |color: f64| format!("{sun}light lamp {{ direction = vec3(-0.8, -1, 0)  color = {color} }}");
    let ((one, rays), (weak, weak_rays), (_, strong_rays)) =
        (counted(sun), counted(&lamp(0.002)), counted(&lamp(0.2)));
    assert!(strong_rays > 1.5 * rays, "{strong_rays} evaluations with a second light, {rays} without");
    // Where the sun's light does not arrive, the weak light is all there is.
    assert!(weak_rays < 1.1 * rays, "{weak_rays} evaluations with a weak second light, {rays} without");
    let off = one.pixels().zip(weak.pixels()).map(|(a, b)| a.0[0].abs_diff(b.0[0])).max();
    assert!(off <= Some(4), "{off:?}");
}

/// The bound is small where two cells meet, also far above the balls.
#[test]
fn no_curtain_hangs_where_the_cells_of_a_repetition_meet() {
    let view = "camera { position = vec3(0, 1.6, -5.5)  target = vec3(0.3, 1.6, 4)  fov = 50 }";
    let balls = format!(
        "fn ball(q, cell) = sphere(q, 0.2 + 0.7 * hash(cell))\n\
         object balls {{\n  shape = ball(repeat(p, vec3(2, 0, 2)), cell_of(p, vec3(2, 0, 2)))\n  \
         bound = other_cells(p, vec3(2, 0, 2), 0.9) }}\n{view}"
    );
    let sky = picture(&format!("object floor {{ shape = y }}\n{view}"));
    let scene = SceneSource::Formula(balls);
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let drawn = TestRenderer::of(&scene, mode, Counting::Off).picture(0.0, silence(), SIZE);
        for (x, y, pixel) in drawn.enumerate_pixels().filter(|(_, y, _)| y * 5 < SIZE.1 * 2) {
            let expected = sky.get_pixel(x, y);
            let off = pixel.0.iter().zip(expected.0).map(|(a, b)| a.abs_diff(b)).max();
            assert!(off <= Some(4), "{mode}, {x}, {y}: {pixel:?}, but the sky is {expected:?}");
        }
    }
}

#[test]
fn a_small_panel_lights_like_a_lamp_to_one_side() {
    // In front of a small panel, the light is the same as from a lamp whose strength is the panel's area times the
    // panel's radiance.
    let lamp = on_floor("light a { position = vec3(0, 3, 0)  color = 4 }");
    let panel = "position = vec3(0, 3, 0)  right = vec3(0.05, 0, 0)  color = 400";
    let below = on_floor(&format!("light a {{ {panel}  up = vec3(0, 0, 0.05) }}"));
    let above = on_floor(&format!("light a {{ {panel}  up = vec3(0, 0, -0.05) }}"));
    let (expected, found) = (brightness(&lamp, 0.5, 0.5), brightness(&below, 0.5, 0.5));
    assert!(expected > 100, "the lamp is too dark for this test: {expected}");
    assert!((expected - found).abs() <= 6, "a panel gives {found}, a lamp {expected}");
    assert_eq!(brightness(&above, 0.5, 0.5).max(6), 6, "a panel lights its back");
    // To the side, a panel gives less light than a lamp.
    assert!(brightness(&below, 0.05, 0.5) < brightness(&lamp, 0.05, 0.5) - 10);
}

#[test]
fn a_light_ends_at_its_range() {
    let without = on_floor("light a { position = vec3(0, 1, 0)  color = 3 }");
    let within = on_floor("light a { position = vec3(0, 1, 0)  color = 3  range = 2 }");
    assert!(brightness(&without, 0.95, 0.5) > 20);
    assert!(brightness(&within, 0.95, 0.5) <= 6, "{}", brightness(&within, 0.95, 0.5));
    assert!(brightness(&within, 0.5, 0.5) > 200);
}

#[test]
fn shadows_have_the_strength_of_their_light() {
    let under_a_ball = |shadow: &str| {
        let ball = "object ball { shape = sphere(p - vec3(0, 1, 0), 0.5)  material = chalk }";
        let lamp = format!("light a {{ position = vec3(3, 4, 0)  color = 60 {shadow} }}");
        brightness(&on_floor(&format!("{ball}{lamp}")), 0.36, 0.5)
    };
    let (dark, half, lit) = (under_a_ball(""), under_a_ball("shadow = 0.5"), under_a_ball("shadow = 0"));
    assert!(dark < 20 && dark + 60 < half && half + 30 < lit, "{dark} {half} {lit}");
}

#[test]
fn emissive_objects_light_nearby_surfaces() {
    let tube = |emission: &str, reach: &str| {
        let tube = format!(
            "object tube {{ shape = capsule(p, vec3(0, 0.3, -1), vec3(0, 0.3, 1), 0.1)  material = neon }}
             material neon {{ color = 0  emission = {emission} }}"
        );
        let sky = FLOOR.replace("ambient = 0", &format!("ambient = 0  {reach}"));
        picture(&format!("{sky}{tube}light off {{ position = vec3(0, 9, 0)  color = 0 }}"))
    };
    let (dark, red) = (tube("0", ""), tube("vec3(4, 0, 0)", ""));
    let [near, far] = [0.56, 0.95].map(|x| colour(&red, x, 0.5));
    assert!(brightness(&dark, 0.56, 0.5) <= 6);
    assert!(near[0] > 60 && near[0] > 2 * near[1], "{near:?}");
    assert!(far[0] <= 4, "the tube lights the floor far away: {far:?}");
    // The sky's `reach` extends the range.
    let wide = tube("vec3(4, 0, 0)", "reach = 6");
    assert!(colour(&wide, 0.75, 0.5)[0] > colour(&red, 0.75, 0.5)[0] + 10);
}

#[test]
fn mirrors_show_mirrors() {
    // A red ball is between two mirrors that face each other. It appears once directly and repeatedly in the mirrors.
    let scene = |reflect: &str| {
        format!(
            "object near {{ shape = 1.5 + p.z  material = glass }}
             object far {{ shape = 3 - p.z  material = glass }}
             object ball {{ shape = sphere(p - vec3(0.9, 0.3, 0.6), 0.25)  material = red }}
             material glass {{ color = 0.02  {reflect} }}
             material red {{ color = vec3(0.9, 0.05, 0.05)  emission = vec3(1, 0.05, 0.05) }}
             sky {{ color = vec3(0.05, 0.05, 0.2) }}
             camera {{ position = vec3(0, 0.2, -1.2)  target = vec3(0.55, 0.25, 3)  fov = 60 }}"
        )
    };
    let red = |picture: &RgbaImage| {
        let reds = |row: u32| {
            (0..SIZE.0)
                .map(move |x| picture.get_pixel(x, row).0)
                .map(|[r, g, b, _]| r > 90 && r > 2 * g.max(b))
        };
        let runs = |row: u32| {
            let row: Vec<bool> = reds(row).collect();
            row.windows(2).filter(|two| !two[0] && two[1]).count()
        };
        (0..SIZE.1).map(runs).max().unwrap_or(0)
    };
    assert_eq!(red(&picture(&scene(""))), 1);
    assert!(red(&picture(&scene("reflect = 0.8"))) >= 3, "{}", red(&picture(&scene("reflect = 0.8"))));
}

#[test]
fn a_rough_mirror_blurs_and_a_metal_colours() {
    let scene = |material: &str| {
        format!(
            "object floor {{ shape = p.y  material = mirror }}
             object wall {{ shape = box(p - vec3(0, 2, 4), vec3(9, 2, 0.5))  material = stripes }}
             material stripes {{ color = 0  emission = vec3(step(0.5, fract(p.x))) }}
             material mirror {{ color = vec3(0.9, 0.3, 0.1)  roughness = 1  reflect = 0.9  {material} }}
             light off {{ position = vec3(0, 9, 0)  color = 0 }}
             sky {{ color = 0  ambient = 0  reach = 0.001 }}
             camera {{ position = vec3(0, 2, -4)  target = vec3(0, 0, 1)  fov = 40 }}"
        )
    };
    // The difference between the brightest and the darkest part of a row of the floor.
    let contrast = |picture: &RgbaImage| -> i32 {
        let column = |x: u32| (36..48).map(|y| i32::from(picture.get_pixel(x, y).0[1])).sum::<i32>() / 12;
        let row: Vec<i32> = (0..SIZE.0).map(column).collect();
        // Average three pixels, so that noise does not count as a stripe.
        let means: Vec<i32> = row.windows(3).map(|three| three.iter().sum::<i32>() / 3).collect();
        means.iter().max().unwrap() - means.iter().min().unwrap()
    };
    let (sharp, rough) = (picture(&scene("")), picture(&scene("blur = 0.9")));
    assert!(
        contrast(&sharp) > 100 && contrast(&rough) < contrast(&sharp) / 2,
        "{} {}",
        contrast(&sharp),
        contrast(&rough)
    );
    let gold = picture(&scene("metalness = 1"));
    let brightest = |picture: &RgbaImage| picture.rows().nth(40).unwrap().map(|pixel| pixel.0).max().unwrap();
    let ([r, g, b, _], [gray, _, other, _]) = (brightest(&gold), brightest(&sharp));
    assert!(r > g && g > b && gray.abs_diff(other) < 4, "{:?} {:?}", brightest(&gold), brightest(&sharp));
}

#[test]
fn materials_mix_where_objects_melt() {
    let text = format!(
        "{FLOOR}
         object left {{ shape = sphere(p - vec3(-0.8, 0.5, 0), 0.8)  material = red }}
         object right {{ shape = sphere(p - vec3(0.8, 0.5, 0), 0.8)  material = blue  melt = 0.8 }}
         material red {{ color = 0  emission = vec3(0.5, 0, 0) }}
         material blue {{ color = 0  emission = vec3(0, 0, 0.5) }}
         light off {{ position = vec3(0, 9, 0)  color = 0 }}"
    );
    let melted = picture(&text);
    let [left, seam, right] = [0.38, 0.5, 0.62].map(|x| colour(&melted, x, 0.5));
    assert!(left[0] > 3 * left[2] && right[2] > 3 * right[0], "{left:?} {right:?}");
    assert!((seam[0] - seam[2]).abs() < 40 && seam[0] > 40, "{seam:?}");
}

/// Invalid values that mistakes, sliders or loud notes may produce.
const RUBBISH: [&str; 8] = [
    "object a { shape = sphere(p, 0) } light l { position = vec3(0, 0, 0)  color = 1000 }",
    "object a { shape = sphere(p, -1) } object b { shape = box(p, vec3(-1, 2, 0)) }",
    "object a { shape = sphere(p, 9)  material = m } material m { roughness = -5  metalness = 70  reflect = 9  blur = 100  coat = -3  color = vec3(-1, 1e30, 7) }",
    "param a = 0 in 0 .. 1
     object a { shape = sphere(p, 1)  material = m } material m { color = log(a - 1) / a  emission = vec3(1e38) * 1e38  blur = 0 / a  reflect = exp(999) - exp(999) }
     sky { color = vec3(exp(999) - exp(999)) ambient = vec3(1e38)  reach = 0 - 1 }",
    "object a { shape = p.y } light l { position = vec3(0, 0, 0)  right = vec3(0)  up = vec3(0)  color = 1 }
     light m { position = vec3(0, 1, 2)  right = vec3(1e30, 0, 0)  up = vec3(0, 0, 1e30)  color = 1e30 }",
    "object a { shape = p.y } light l { direction = vec3(0)  color = 9 } light m { position = vec3(0, 0, 3)  color = 1e30  radius = -2  range = -1  shadow = 7 }",
    "object a { shape = sphere(p, 1) } object b { shape = sphere(p - vec3(1, 0, 0), 1)  melt = -3 }
     camera { position = vec3(0)  target = vec3(0)  fov = 0 }",
    "object a { shape = log(p.x) * 0 + (exp(999) - exp(999)) } camera { position = vec3(1e30)  fov = 9000  roll = 1e30 }",
];

#[test]
fn invalid_values_give_an_opaque_reproducible_image() {
    for text in RUBBISH {
        let mut test_renderer = test_renderer_of(text);
        for size in [SIZE, (1, 1), (300, 1)] {
            let rubbish = test_renderer.picture(0.0, loud_music(), size);
            assert!(rubbish.pixels().all(|pixel| pixel.0[3] == 255), "{text} at {size:?}");
            assert!(
                rubbish == test_renderer.picture(0.0, loud_music(), size),
                "{text} differs between two frames"
            );
        }
    }
}
