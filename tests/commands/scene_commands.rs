//! The subcommands `check`, `tape` and `eval`: printed scenes, printed values, and mistakes in scenes.

#![cfg(target_os = "linux")]

use crate::support::program::Workplace;
use mariana_testing::thesis::TABLE_1;

#[test]
fn the_tape_of_the_thesis_example_is_its_table_1() {
    let printed = Workplace::new().run(&["tape", "max(sqrt(x*x+y*y)-1, 0.5-sqrt(x*x+y*y))"]).done();
    let rows: Vec<Vec<String>> = printed
        .lines()
        .skip(1)
        .map(|line| line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).map(Into::into).collect())
        .collect();
    assert_eq!(rows, TABLE_1.map(|row| row.map(String::from).to_vec()), "{printed}");
}

#[test]
fn glsl_and_graph_are_printed_on_demand() {
    let place = Workplace::new();
    let formula = "min(y, sqrt(x*x+(y-1)*(y-1)+(z-6)*(z-6))-1)";
    let glsl = place.run(&["tape", formula, "--glsl"]).done();
    assert!(glsl.starts_with("float scene_distance(vec3 p") && glsl.contains("min("), "{glsl}");
    let dot = place.run(&["tape", formula, "--dot"]).done();
    assert!(dot.starts_with("digraph") && dot.contains("->"), "{dot}");
}

#[test]
fn the_tape_of_a_cell_has_one_of_two_shapes_and_bounds() {
    let place = Workplace::new();
    let formula = "min(length(p) - 1, length(p - vec3(9, 0, 0)) - 1)";
    let printed = place.run(&["tape", formula, "--at", "0.9,0.1,0"]).done();
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[0].contains("a surface may be inside"), "{printed}");
    let (count, of) = lines[1].split_once(" of ").unwrap();
    let whole = of.split(' ').next().unwrap();
    let (count, whole): (usize, usize) = (count.parse().unwrap(), whole.parse().unwrap());
    assert!(count < whole, "{printed}");
    assert_eq!(lines.len() - 3, count, "{printed}");
    let last = lines[lines.len() - 1].rsplit("  ").next().unwrap();
    let (low, high) = last.trim().split_once(" .. ").unwrap();
    let value = 0.905_538_5_f32 - 1.0;
    assert!(low.parse::<f32>().unwrap() <= value && value <= high.parse().unwrap(), "{printed}");
    place.run(&["tape", formula, "--at", "900,0,0"]).refused(&["outside of the tree"]);
}

#[test]
fn eval_returns_the_distances_of_the_formula() {
    let place = Workplace::new();
    let at = |scene: &str, arguments: &[&str]| {
        let printed = place.run(&[&["eval", scene], arguments].concat()).done();
        printed.lines().map(|line| line.parse().unwrap()).collect::<Vec<f32>>()
    };
    assert_eq!(at("sqrt(x*x+y*y+z*z)-1", &["--at", "0,2,0", "--at", "-3,0,4"]), [1.0, 4.0]);
    assert_eq!(at("-x^2", &["--at", "3,0,0"]), [-9.0]);
    let set = ["--at", "0,0,0", "--set", "band(3)=0.5", "--set", "volume.y=0.25", "--set", "t=2"];
    assert_eq!(at("band(3) + volume.y + t", &set), [2.75]);
    place.write("points.csv", "0,2,0\n\n 3, 0, 4\n");
    assert_eq!(at("length(p)", &["--points", "points.csv"]), [2.0, 5.0]);
    place.write("own.scene", "param size = 2 in 0.5 .. 3\nobject ball { shape = length(p) - size }\n");
    assert_eq!(at("own.scene", &["--at", "5,0,0"]), [3.0]);
    assert_eq!(at("own.scene", &["--at", "5,0,0", "--set", "size=1"]), [4.0]);
}

#[test]
fn the_shipped_scene_is_checked_and_its_cost_reported() {
    let place = Workplace::new();
    let printed = place.run(&["check", "speakers"]).done();
    for part in ["speakers.scene", "clauses", "constants", "registers", "volume.x", "kick, ", ", band, "] {
        assert!(printed.contains(part), "'{part}' is missing: {printed}");
    }
}

/// If a formula is not a distance, rays can stop in front of the surface. Therefore `check` reports such formulas.
#[test]
fn check_reports_a_shape_that_is_no_distance() {
    let place = Workplace::new();
    let advice = |formula: &str| place.run(&["check", formula]).done();
    let non_lipschitz = advice("3 * (length(p) - 1)");
    assert!(
        non_lipschitz.contains("not a distance") && non_lipschitz.contains("multiply the value by 0.3"),
        "{non_lipschitz}"
    );
    let polynomial = advice("x^2 + y^2 - z^2 - 1");
    assert!(polynomial.contains("not a distance"), "{polynomial}");
    let ball = advice("length(p) - 1");
    assert!(!ball.contains("not a distance"), "{ball}");
}

#[test]
fn check_warns_of_what_a_new_author_would_not_see() {
    let place = Workplace::new();
    place.write(
        "own.scene",
        "let lost = 1\nlight sun { direction = vec3(1, 2, 1) }\nobject floor { shape = y + 1 }\n\
         object balls { shape = sphere(repeat(p, vec3(2, 0, 2)), 0.3 + 0.65 * hash(round(p / 2))) }\n",
    );
    let checked = place.run(&["check", "own.scene"]).done();
    for part in [
        "warning: the value `lost` is never used",
        "own.scene:1:5",
        "warning: this sun shines from below",
        "own.scene:2:13",
        "warning: rays step over the surface of `balls`",
        "other_cells(p, size, reach)",
    ] {
        assert!(checked.contains(part), "'{part}' is missing: {checked}");
    }
    let lines = place.run(&["check", "own.scene", "--json"]).done();
    let kinds: Vec<&str> = lines.lines().filter(|line| line.contains(r#""severity":"warning""#)).collect();
    assert_eq!(kinds.len(), 3, "{lines}");
    place.write("sky.scene", "sky { color = vec3(0.2, 0.4, direction.y) }");
    let sky = place.run(&["check", "sky.scene"]).done();
    assert!(sky.contains("0 objects") && !sky.contains("warning"), "{sky}");
}

#[test]
fn every_mistake_is_shown_with_its_position_and_a_hint() {
    let place = Workplace::new();
    place.write("bad.scene", "object a {\r\n  shape = smoth_union(sphere(p, 1), p.y, 0.2) + foo\r\n}\r\n");
    let checked = place.run(&["check", "bad.scene", "speakers"]);
    assert_eq!(checked.code, 1, "{checked:?}");
    checked.assert_advises();
    for part in ["bad.scene:2:11", "smoth_union(sphere(p, 1)", "^^^^", "did you mean `smooth_union`?", "foo"]
    {
        assert!(checked.stdout.contains(part), "'{part}' is missing: {checked:?}");
    }
    assert!(checked.stdout.contains("speakers.scene: "), "the valid scene is checked as well: {checked:?}");
    place.run(&["eval", "bad.scene", "--at", "0,0,0"]).refused_with_details(&["bad.scene:2:11"]);
}

#[test]
fn scenes_after_an_unreadable_one_are_checked() {
    let place = Workplace::new();
    place.write("bad.scene", "lngth(p) - 1");
    let checked = place.run(&["check", "none.scene", "bad.scene", "gone.scene", "speakers"]);
    assert_eq!(checked.code, 1, "{checked:?}");
    checked.assert_advises();
    for part in ["none.scene cannot be read", "gone.scene cannot be read", "a scene has mistakes"] {
        assert!(checked.stderr.contains(part), "'{part}' is missing: {checked:?}");
    }
    for part in ["bad.scene:1:1", "speakers.scene: "] {
        assert!(checked.stdout.contains(part), "'{part}' is missing: {checked:?}");
    }
    let checked = place.run(&["check", "none.scene", "speakers"]);
    assert_eq!(checked.code, 1, "{checked:?}");
    assert!(checked.stdout.contains("speakers.scene: "), "{checked:?}");
}

#[test]
fn a_missing_texture_is_a_mistake_with_its_position() {
    let place = Workplace::new();
    place.write(
        "own.scene",
        "material m { color = texture(\"wod.png\", p.xy).rgb }\nobject o { shape = p.y material = m }",
    );
    let checked = place.run(&["check", "own.scene"]);
    assert_eq!(checked.code, 1, "{checked:?}");
    for part in ["own.scene:1:", "wod.png", "wood.png"] {
        assert!(checked.stdout.contains(part), "'{part}' is missing: {checked:?}");
    }
}

#[test]
fn invalid_input_is_refused_with_a_message_and_in_time() {
    let place = Workplace::new();
    place.write("nested.scene", "(".repeat(100_000) + "x" + &")".repeat(100_000));
    place.write("binary.scene", [0xff, 0x00, 0xfe, b'x']);
    place.write("long.scene", "x+".repeat(600_000) + "x");
    place.write("loop.scene", "include \"loop.scene\"\nobject o { shape = p.y }");
    place.write("recursion.scene", "fn f(p) { f(p) }\nobject o { shape = f(p) }");
    place.write("outside.scene", "include \"../../etc/passwd\"\nobject o { shape = p.y }");
    for file in ["nested", "loop", "recursion", "outside"] {
        let file = format!("{file}.scene");
        let checked = place.run(&["check", &file]);
        assert!(checked.code == 1 && checked.stdout.contains(&file), "{checked:?}");
    }
    place.run(&["check", "binary.scene"]).refused(&["binary.scene", "UTF-8"]);
    place.run(&["check", "long.scene"]).refused(&["long.scene", "larger than"]);
    place.run(&["check", "missing.scene"]).refused(&["missing.scene"]);
    place.run(&["check", "speekers"]).refused(&["speekers", "speakers"]);
    place.run(&["eval", "y", "--at", "0,0,0", "--set", "foo=1"]).refused(&["foo", "volume.x"]);
    place.run(&["eval", "y", "--at", "0,0"]).refused_arguments("--at", &["x,y,z"]);
    place.write("points.csv", "0,0,0\n1,2\n");
    let reported = place.run(&["eval", "y", "--points", "points.csv"]);
    assert!(reported.code == 1 && reported.stderr.contains("points.csv:2"), "{reported:?}");
}

#[test]
fn a_broken_first_scene_ends_the_program_with_its_mistakes() {
    let place = Workplace::new();
    place.write_tone("song.wav", 440.0, 0.1, [0.5, 0.5]);
    place.write("broken.scene", "object wall { shape = 5 - p.z }\nobject ball { shape = vec3(1, 0 0) }\n");
    for (scene, expected) in [
        ("broken.scene", "broken.scene:2:"),
        ("missing.scene", "missing.scene"),
        ("speekers", "speekers"),
        ("length(p) - ", "formula:1:13"),
    ] {
        let outcome = place.run(&["song.wav", "--silent", "--scene", scene]);
        assert!(outcome.code == 1 && outcome.stderr.contains(expected), "no '{expected}' in {outcome:?}");
    }
}

#[test]
fn a_shader_becomes_a_scene_and_a_scene_becomes_a_shader() {
    let place = Workplace::new();
    let glsl = "precision highp float;\nvec2 map(vec3 p) { vec2 r = vec2(length(p) - 1.0, 1.0);\n\
                if (p.y + 1.0 < r.x) r = vec2(p.y + 1.0, 2.0); return r; }\n\
                void mainImage(out vec4 c, in vec2 f) { c = vec4(f, 0.0, 1.0); }\n";
    place.write("ball.glsl", glsl);
    let played = place.run(&["ball.glsl", "none.ogg"]);
    assert!(played.code == 1 && played.stderr.contains("none.ogg does not exist"), "{played:?}");
    assert!(!played.stderr.contains("imported as"), "a refused start writes no scene: {played:?}");
    let import = |arguments: &[&str]| {
        let outcome = place.run(&[&["import", "--as", "shape"], arguments].concat());
        assert!(outcome.code == 0 && outcome.stderr.contains("mariana: left out: camera"), "{outcome:?}");
        assert!(outcome.stderr.contains("--as picture"), "{outcome:?}");
        outcome.stdout
    };
    let own = place.run(&["import", "ball.glsl", "-o", "own.scene"]);
    assert!(own.code == 0 && own.stderr.contains("draws the shader's own picture"), "{own:?}");
    assert!(own.stderr.contains("--as shape"), "{own:?}");
    assert!(place.run(&["check", "own.scene"]).done().contains("0 objects"));
    place.run(&["import", "ball.glsl", "--as", "both"]).refused_arguments("--as", &["both"]);
    let printed = import(&["ball.glsl"]);
    assert!(printed.contains("ball.scene"), "{printed}");
    place.run(&["import", "ball.glsl"]).refused(&["ball.scene", "exists"]);
    assert!(place.run(&["check", "ball.scene"]).done().contains("1 object"));
    assert_eq!(place.run(&["eval", "ball.scene", "--at", "0,3,0"]).done().trim(), "2");
    place.run(&["export", "--glsl", "ball.scene", "--main-image", "-o", "back.glsl"]).done();
    import(&["back.glsl", "-o", "back.scene"]);
    assert_eq!(place.run(&["eval", "back.scene", "--at", "0,3,0"]).done().trim(), "2");
    place.write("none.glsl", "float noise(vec2 p) { return p.x; }\n");
    let refused = place.run(&["import", "none.glsl"]);
    assert!(refused.code == 1 && refused.stderr.contains("none.glsl cannot become a scene"), "{refused:?}");
    assert!(refused.stderr.contains("call it `map`") && !place.names().contains(&"none.scene".into()));
    place.write("shader.txt", glsl);
    place.run(&["import", "shader.txt"]).refused(&["rename it"]);
}

#[test]
fn a_shader_that_draws_becomes_a_scene_in_two_dimensions() {
    let place = Workplace::new();
    place.write("flat.frag", "uniform vec2 u_resolution;\nvoid main() { gl_FragColor = vec4(gl_FragCoord.xy / u_resolution, 0.0, 1.0); }\n");
    let outcome = place.run(&["import", "flat.frag"]);
    assert!(outcome.code == 0 && outcome.stderr.is_empty(), "{outcome:?}");
    assert!(place.run(&["check", "flat.scene"]).done().contains("0 objects"));
    let still = |more: &[&str]| {
        place.run(&[&["still", "flat.scene", "--size", "64x36", "-o", "flat.png"], more].concat())
    };
    still(&[]).done();
    let picture = image::open(place.path("flat.png")).unwrap().to_rgb8();
    let [red, green, blue] = picture.get_pixel(48, 9).0;
    assert!(red.abs_diff(193) < 2 && green.abs_diff(188) < 2 && blue == 0, "{red} {green} {blue}");
    place.run(&["still", "flat.frag", "-o", "x.png"]).refused(&["flat.frag", "mariana import"]);
    let before = std::fs::read(place.path("flat.frag")).unwrap();
    place.run(&["import", "flat.frag", "-o", "flat.frag"]).refused(&["flat.frag", "my.scene"]);
    assert_eq!(std::fs::read(place.path("flat.frag")).unwrap(), before, "a scene replaced its shader");
    place.write(
        "more.frag",
        "#include \"lib/blue.glsl\"\nvoid main() { gl_FragColor = vec4(gl_FragCoord.xy / 99.0, blue(), 1.0); }\n",
    );
    let missing = place.run(&["import", "more.frag"]);
    assert!(missing.code == 1 && missing.stderr.contains("more.frag:1:"), "{missing:?}");
    assert!(missing.stderr.contains("\"lib/blue.glsl\" is not in the folder of this shader"), "{missing:?}");
    std::fs::create_dir_all(place.path("lib")).unwrap();
    std::fs::create_dir_all(place.path("other")).unwrap();
    place.write("lib/blue.glsl", "float blue() { return 0.5; }\n");
    for scene in ["more.scene", "other/more.scene"] {
        place.run(&["import", "more.frag", "-o", scene]).done();
        assert!(place.run(&["check", scene]).done().contains("0 objects"), "{scene}");
    }
    still(&["--ray", "64,0"]).refused(&["64,0", "64x36"]);
    still(&["--ray", "middle"]).refused_arguments("--ray", &["X,Y"]);
    place.run(&["still", "--scene", "speakers", "--size", "640x360", "-o", "plain.png"]).done();
    place
        .run(&["still", "--scene", "speakers", "--size", "640x360", "-o", "ray.png", "--ray", "150,215"])
        .done();
    let [plain, ray] = ["plain.png", "ray.png"].map(|name| image::open(place.path(name)).unwrap().to_rgb8());
    let differ = plain.pixels().zip(ray.pixels()).filter(|(a, b)| a != b).count();
    assert!(differ > 40_000, "only {differ} pixels belong to the diagram");
}

#[test]
fn media_and_swarms_were_not_counted() {
    let place = Workplace::new();
    let swarm = "swarm sparks { count = 7  glow = 1 }\n";
    place.write("fog.scene", format!("medium a {{ }}\nmedium b {{ }}\n{swarm}sphere(p, 1)"));
    let printed = place.run(&["check", "fog.scene", "length(p) - 1"]).done();
    assert!(
        printed.contains("1 object, 1 material, 1 light, 2 media, 1 swarm, 7 points; listens"),
        "{printed}"
    );
    assert!(printed.contains("1 object, 1 material, 1 light; listens"), "{printed}");
}

#[test]
fn an_exported_scene_lost_its_fog_and_glass_in_silence() {
    let place = Workplace::new();
    place.write(
        "all.scene",
        "medium a { }\nswarm b { }\nmaterial m { glass = 1 }\nobject c { shape = sphere(p, 1)  material = m }",
    );
    place.write("plain.scene", "sphere(p, 1)");
    let export = |scene: &str| place.run(&["export", "--glsl", scene]);
    let (all, plain) = (export("all.scene"), export("plain.scene"));
    for what in ["media", "swarms", "light through glass and translucent bodies"] {
        assert!(all.stderr.contains(&format!("left out: {what}")), "{all:?}");
        assert!(all.stdout.contains(&format!("// Left out: {what}.")), "{all:?}");
    }
    assert!(plain.stderr.is_empty() && !plain.stdout.contains("Left out"), "{plain:?}");
}

#[test]
fn a_camera_inside_of_an_object_drew_nothing_in_silence() {
    let place = Workplace::new();
    let inside = "camera { position = vec3(0.1, 0, 0)  target = vec3(0, 0, 1) }\n";
    place.write("in.scene", format!("{inside}object cave {{ shape = sphere(p, 1) }}"));
    place.write("out.scene", format!("{inside}object cave {{ shape = shell(sphere(p, 1), 0.1) }}"));
    place.write("below.scene", format!("{inside}object floor {{ shape = p.y - 1 }}"));
    let still = |scene: &str| place.run(&["still", "-o", "a.png", "--size", "16x9", "--scene", scene]);
    let (within, outside) = (still("in.scene"), still("out.scene"));
    assert_eq!(within.code, 0, "{within:?}");
    assert!(within.stderr.contains("inside of the object `cave`"), "{within:?}");
    assert!(outside.stderr.is_empty(), "{outside:?}");
    assert!(place.run(&["check", "in.scene"]).done().contains("the camera is inside of this object"));
    for scene in ["out.scene", "below.scene"] {
        assert!(!place.run(&["check", scene]).done().contains("camera"), "{scene}");
    }
}

#[test]
fn edited_shows_and_scenes_were_silently_replaced_by_text_outputs() {
    let place = Workplace::new();
    let scene = "sphere(p, 1)\n";
    for name in ["my.scene", "own.show", "own.glsl"] {
        place.write(name, scene);
    }
    place.write_tone("tone.wav", 440.0, 0.5, [0.5, 0.5]);
    place.run(&["show", "tone.wav", "-o", "own.show"]).refused(&["own.show", "exists"]);
    for output in ["my.scene", "own.show", "own.glsl"] {
        place.run(&["export", "--glsl", "my.scene", "-o", output]).refused(&[output, "exists"]);
    }
    place.run(&["analyze", "tone.wav", "--plot", "my.scene"]).refused(&["my.scene", ".svg"]);
    for name in ["my.scene", "own.show", "own.glsl"] {
        assert_eq!(place.read(name), scene.as_bytes(), "{name}");
    }
    // Its own GLSL is written again after each change of the scene.
    place.run(&["export", "--glsl", "my.scene", "-o", "out.glsl"]).done();
    place.run(&["export", "--glsl", "my.scene", "-o", "out.glsl"]).done();
}

/// The tree of cells for its rays took minutes.
#[test]
fn a_very_long_distance_is_checked_without_following_rays() {
    let heavy = "sphere(p, 1) + 0.001*sum(for i in 0..400: noise(p * i))";
    let text = Workplace::new().run(&["check", heavy]).done();
    assert!(
        text.contains("registers for the distance") && text.contains("the distance is too long"),
        "{text}"
    );
}
