//! Glass, translucent bodies, thin films and velvet: known cases of light, both modes, invalid values.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::media::{assert_light, light_in_the_middle, renderer};
use crate::support::compare::{LOOSE, assert_alike};
use crate::support::test_renderer::silence;
use mariana::gpu::renderer::Counting;
use mariana::gpu::scene_program::Mode;

/// A scene with a narrow view of the origin, whose only light is in `parts`.
fn scene(parts: &str) -> String {
    format!(
        "{parts}
         picture {{ exposure = 1  bloom = 0  vignette = 0 }}
         camera {{ position = vec3(0, 0, -6)  target = vec3(0)  fov = 2 }}"
    )
}

/// A body before a sky that is red on the left, green on the right.
fn before_the_sky(body: &str) -> String {
    scene(&format!(
        "{body}
         sky {{ color = if direction.x < 0 then vec3(1, 0, 0) else vec3(0, 1, 0)  ambient = 0 }}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }}"
    ))
}

fn before_an_even_sky(body: &str) -> String {
    scene(&format!(
        "{body} sky {{ color = 1  ambient = 0 }}  light dark {{ position = vec3(0, 90, 0)  color = 0 }}"
    ))
}

#[test]
fn glass_absorbs_light_exponentially() {
    let slab = "material clear { glass = 1  ior = 1  roughness = 1  absorb = vec3(0.5, 0.1, 0) }
                object slab { shape = box(p, vec3(9, 9, 1))  material = clear }";
    let left = [0.5f32, 0.1, 0.0].map(|absorb| (-2.0 * absorb).exp());
    assert_light(&before_an_even_sky(slab), left, 0.02);
}

#[test]
fn glass_neither_gains_nor_loses_the_light_of_an_even_sky() {
    for (name, shape) in [
        ("ball", "sphere(p, 1)"),
        ("hollow ball", "max(sphere(p, 1), -sphere(p, 0.9))"),
        ("turned box", "box(vec3(0.8 * x + 0.6 * z, y, 0.8 * z - 0.6 * x), 0.7)"),
    ] {
        let body = format!(
            "material clear {{ glass = 1  ior = 1.5 }} object body {{ shape = {shape}  material = clear }}"
        );
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let [light, ..] = light_in_the_middle(&before_an_even_sky(&body), mode);
            assert!((light - 1.0).abs() < 0.05, "{name}, {mode}: {light}");
        }
    }
}

#[test]
fn a_ball_of_glass_turns_the_picture_around() {
    let ball = "material clear { glass = 1  ior = 1.5 }
                object ball { shape = sphere(p - vec3(-0.3, 0, 0), 1)  material = clear }";
    // The eye looks at the right half of the ball, in front of the middle of the sky.
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let [red, green, _] = light_in_the_middle(&before_the_sky(ball), mode);
        assert!(red > 0.7 && green < 0.3, "{mode}: {red} {green}");
    }
}

/// Objects in the order of their names, before a red sky.
fn before_a_red_sky(objects: &[&str]) -> String {
    let objects = objects.concat();
    scene(&format!(
        "material tinted {{ glass = 1  ior = 1  roughness = 1  absorb = vec3(0, 0.5, 0) }}
         material patterned {{ glass = min(1, 2 + x)  ior = 1  roughness = 1  absorb = vec3(0, 0.5, 0) }}
         material shining {{ color = 0  roughness = 1  emission = vec3(0, 1, 1) }}
         {objects} sky {{ color = vec3(1, 0, 0)  ambient = 0 }}
         light dark {{ position = vec3(0, 90, 0)  color = 0 }}"
    ))
}

#[test]
fn an_opaque_thing_in_solid_glass_is_seen_through_the_glass() {
    let core = "object core { shape = sphere(p, 0.5)  material = shining }";
    let left = (-0.5f32 * 1.5).exp();
    for material in ["tinted", "patterned"] {
        let ball = format!("object ball {{ shape = sphere(p, 2)  material = {material} }}");
        for objects in [[core, ball.as_str()], [ball.as_str(), core]] {
            assert_light(&before_a_red_sky(&objects), [0.0, left, 1.0], 0.02);
        }
        // Without the core, the sky shines through.
        assert_light(&before_a_red_sky(&[&ball]), [1.0, 0.0, 0.0], 0.02);
    }
}

#[test]
fn a_lamp_lights_a_thing_deep_in_glass() {
    let lit = |glass: &str| {
        let text = scene(&format!(
            "object core {{ shape = sphere(p, 0.5)  material = white }} {glass}
             material white {{ roughness = 1 }} material clear {{ glass = 1  ior = 1  roughness = 1 }}
             sky {{ color = 0  ambient = 0 }}  light sun {{ direction = vec3(0, 0, 1)  color = 3  radius = 0 }}"
        ));
        text.replace("-6", "-20")
    };
    let [bare, ..] = light_in_the_middle(&lit(""), Mode::Compiled);
    assert!(bare > 0.3);
    assert_light(&lit("object ball { shape = sphere(p, 8)  material = clear }"), [bare; 3], 0.02 * bare);
}

#[test]
fn a_mirror_in_solid_glass_shows_what_is_in_the_glass() {
    let objects = [
        "object ball { shape = sphere(p, 2)  material = tinted }",
        "object mirror { shape = box(vec3(0.8 * x + 0.6 * z, y, 0.8 * z - 0.6 * x), vec3(0.8, 0.8, 0.1))  material = mirror }",
        "object side { shape = min(x + 1.5, 1.5 - x)  material = shining }",
        "material mirror { color = 1  metalness = 1  roughness = 1  reflect = 1 }",
    ];
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let [red, green, blue] = light_in_the_middle(&before_a_red_sky(&objects), mode);
        let is_tinted = (0.1..0.6).contains(&green);
        assert!(red < 0.05 && is_tinted && blue > 0.9, "{mode}: {red} {green} {blue}");
    }
}

#[test]
fn glass_that_touches_a_plane_shows_the_plane() {
    let wall = "object wall { shape = 1 - z  material = shining }";
    for shape in ["sphere(p, 1)", "box(p, 1)", "sphere(p, 1.001)", "sphere(p, 0.999)"] {
        let body = format!("object body {{ shape = {shape}  material = tinted }}");
        assert_light(&before_a_red_sky(&[wall, &body]), [0.0, (-1.0f32).exp(), 1.0], 0.02);
    }
}

#[test]
fn glass_casts_no_shadow_and_other_bodies_do() {
    let floor = |glass: f32| {
        scene(&format!(
            "material clear {{ glass = {glass}  ior = 1  roughness = 1 }}
             material wall {{ color = 1  roughness = 1 }}
             object wall {{ shape = 1 - z  material = wall }}
             object ball {{ shape = sphere(p - vec3(3, 0, -2), 1)  material = clear }}
             light sun {{ direction = vec3(-1, 0, 1)  color = 3 }}
             sky {{ color = 0  ambient = 0 }}"
        ))
    };
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let [clear, solid] = [1.0, 0.0].map(|glass| light_in_the_middle(&floor(glass), mode)[0]);
        assert!(clear > 0.5 && solid < 0.01, "{mode}: {clear} and {solid}");
    }
}

#[test]
fn light_behind_a_translucent_slab_fades_with_its_thickness() {
    let behind = |thickness: f32| {
        let text = scene(&format!(
            "material wax {{ color = 1  translucent = 1  depth = 0.5  roughness = 1 }}
             object slab {{ shape = box(p, vec3(9, 9, {thickness} / 2))  material = wax }}
             light sun {{ direction = vec3(0, 0, -1)  color = 3 }}
             sky {{ color = 0  ambient = 0 }}"
        ));
        [Mode::Compiled, Mode::Interpreted].map(|mode| light_in_the_middle(&text, mode)[0])
    };
    let (thin, thick) = (behind(0.5), behind(1.0));
    for (thin, thick) in thin.into_iter().zip(thick) {
        let expected = 3.0 * 0.5 / std::f32::consts::PI * (-1.0f32).exp();
        assert!((thin / expected - 1.0).abs() < 0.1, "{thin} instead of {expected}");
        assert!((thick / thin / (-1.0f32).exp() - 1.0).abs() < 0.1, "{thick} behind {thin}");
    }
}

#[test]
fn a_thin_film_colours_what_a_mirror_shows() {
    let mirror = |film: f32| {
        format!(
            "material silver {{ color = 1  metalness = 1  reflect = 1  film = {film} }}
             object mirror {{ shape = -z  material = silver }}"
        )
    };
    // Half a wavelength of green light in the film, there and back: green is brightest.
    let green = 540.0 / (4.0 * 1.4);
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let plain = light_in_the_middle(&before_an_even_sky(&mirror(0.0)), mode);
        assert!(plain.iter().all(|part| (part - 1.0).abs() < 0.01), "{mode}: {plain:?}");
        let [r, g, b] = light_in_the_middle(&before_an_even_sky(&mirror(green)), mode);
        assert!(g > r && g > b && g > 1.8, "{mode}: {r} {g} {b}");
    }
}

#[test]
fn velvet_shines_at_grazing_angles() {
    let cloth = |velvet: f32, slope: f32| {
        let facing = (1.0 - slope * slope).sqrt();
        let text = scene(&format!(
            "material cloth {{ color = 0.2  roughness = 0.4  velvet = {velvet} }}
             object cloth {{ shape = {slope} * x - {facing} * z  material = cloth }}
             light sun {{ direction = vec3(1, 0, 0.2)  color = 3 }}
             sky {{ color = 0  ambient = 0 }}"
        ));
        light_in_the_middle(&text, Mode::Compiled)[0]
    };
    let gain = |slope: f32| cloth(1.0, slope) - cloth(0.0, slope);
    let (facing, grazing) = (gain(0.0), gain(-0.97));
    assert!(grazing > 3.0 * facing && facing >= 0.0, "{grazing} against {facing}");
}

#[test]
fn surfaces_throw_light_into_a_corner() {
    let corner = |bounce: f32| {
        let text = scene(&format!(
            "material white {{ color = 0.8  roughness = 1 }}
             object walls {{ shape = min(1 - z, 0.02 + x)  material = white }}
             light sun {{ direction = vec3(-1, 0, 0)  color = 3 }}
             sky {{ color = 0  ambient = 0  reach = 1  bounce = {bounce} }}"
        ));
        [Mode::Compiled, Mode::Interpreted].map(|mode| light_in_the_middle(&text, mode)[0])
    };
    for (without, with) in corner(0.0).into_iter().zip(corner(1.0)) {
        assert!(without < 1e-3 && with > 0.05 && with < 0.5, "{without} and {with}");
    }
}

const ALL_KINDS: &str = "
material clear { glass = 0.9  ior = 1.5  absorb = vec3(0.4, 0.1, 0.2)  blur = 0.1 }
material wax { color = vec3(0.9, 0.6, 0.3)  translucent = 0.8  depth = 0.3 }
material beetle { color = 0.8  metalness = 1  film = 300 + 100 * y  reflect = 0.3 }
material cloth { color = vec3(0.5, 0.1, 0.1)  velvet = 1 }
object floor { shape = y + 1  material = cloth }
object glass { shape = sphere(p - vec3(-1.5, 0, 0), 1)  material = clear }
object candle { shape = box(p - vec3(0.3, 0, 1), vec3(0.5, 1, 0.5))  material = wax }
object bug { shape = sphere(p - vec3(1.8, -0.3, 0), 0.7)  material = beetle }
light lamp { position = vec3(1, 3, 4)  color = vec3(40, 36, 30) }
sky { bounce = 0.7 }
camera { position = vec3(0, 1, -5)  target = vec3(0) }
";

#[test]
fn both_modes_draw_the_same_materials() {
    let [compiled, interpreted] = [Mode::Compiled, Mode::Interpreted]
        .map(|mode| renderer(ALL_KINDS, mode, Counting::Off).picture(1.0, silence(), (320, 180)));
    assert_alike("glass, wax, film and velvet", &compiled, &interpreted, LOOSE);
}

#[test]
fn invalid_materials_leave_a_valid_picture() {
    for fields in [
        "glass = 1  ior = 0",
        "glass = 1  ior = 1 / (y - y)",
        "glass = 1  ior = -3  absorb = vec3(sqrt(-1 - y * y), -5, 1e30)",
        "glass = 1 / (y - y)  ior = 1e30",
        "translucent = 5  depth = 0",
        "translucent = 1  depth = -1 / (y - y)",
        "film = -300  velvet = 9",
        "film = 1e30  reflect = 1  velvet = sqrt(-1 - y * y)",
    ] {
        let text = format!(
            "material odd {{ {fields} }}  object ball {{ shape = sphere(p, 1)  material = odd }}
             camera {{ position = vec3(0, 0, -3)  target = vec3(0) }}"
        );
        for mode in [Mode::Compiled, Mode::Interpreted] {
            let mut renderer = renderer(&text, mode, Counting::Off);
            renderer.picture(0.0, silence(), (32, 32));
            let light = renderer.renderer.read_light().unwrap();
            assert!(light.iter().all(|part| part.is_finite() && *part >= 0.0), "{mode}: {fields}");
        }
    }
}

#[test]
fn a_camera_in_glass_in_glass_in_fog_sees_a_picture() {
    let text = "material clear { glass = 1  ior = 1.5  absorb = 0.1 }
                material thick { glass = 1  ior = 1.3  absorb = vec3(0.2, 0, 0) }
                object outer { shape = max(sphere(p, 2), -sphere(p, 1.5))  material = clear }
                object inner { shape = sphere(p, 1)  material = thick }
                medium fog { density = 0.2 }
                light lamp { position = vec3(0, 0.2, 0)  color = 5 }
                camera { position = vec3(0, 0, -0.5)  target = vec3(0, 0, 1) }";
    for mode in [Mode::Compiled, Mode::Interpreted] {
        let mut renderer = renderer(text, mode, Counting::Off);
        let picture = renderer.picture(0.0, silence(), (64, 36));
        let lit = picture.pixels().filter(|pixel| pixel.0[..3].iter().any(|part| *part > 8)).count();
        assert!(lit > 64 * 36 / 2, "{mode}: only {lit} pixels are lit");
    }
}
