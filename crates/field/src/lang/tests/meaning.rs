use super::super::{LightKind, compile};
use super::{distance, frame, scene, value};
use crate::graph::{FrameInputs, Point};

#[test]
fn formulas_from_the_thesis_can_be_pasted() {
    assert_eq!(value("sqrt(x*x+y*y+z*z)-1", [0.0, 3.0, 4.0]), 4.0);
    let text = "min(y, sqrt((x-1)^2+(y-1)^2+(z-6)^2)-1)";
    assert_eq!(value(text, [1.0, 1.0, 6.0]), -1.0);
    assert_eq!(value(text, [-3.0, 0.5, 6.0]), 0.5);
    assert_eq!(value("max(sqrt(x*x+y*y)-1, 0.5-sqrt(x*x+y*y))", [0.25, 0.0, 9.0]), 0.25);
}

#[test]
fn expressions_mean_what_they_mean_in_glsl() {
    let at = [0.5, -2.0, 3.0];
    for (text, expected) in [
        ("-x^2", -0.25),
        ("2^3^2", 512.0),
        ("y^2", 4.0),
        ("y^-2", 0.25),
        ("pow(y, 3)", -8.0),
        ("y % 1.5", 1.0),
        ("mod(-0.5, 2)", 1.5),
        ("7 % -2", -1.0),
        ("p.zyx.x", 3.0),
        ("dot(p.xz, vec2(2, 10))", 31.0),
        ("(vec3(1, 2, 3) * 2 + vec3(1)).z", 7.0),
        ("vec4(p.xy, vec2(7, 8)).w", 8.0),
        ("vec2(p).y", -2.0),
        ("length(vec3(2, 3, 6))", 7.0),
        ("cross(vec3(1, 0, 0), vec3(0, 1, 0)).z", 1.0),
        ("mix(2, 4, 0.25)", 2.5),
        ("mix(vec2(0), vec2(4, 8), vec2(0.5, 0.25)).y", 2.0),
        ("clamp(vec3(5, -5, 0.5), 0, 1).x", 1.0),
        ("smoothstep(0, 2, 1)", 0.5),
        ("smoothstep(2, 0, 0.5)", 0.84375),
        ("step(1, vec2(0, 2)).y", 1.0),
        ("atan(1, -1)", 2.356_194_5),
        ("normalize(vec2(3, 4)).x", 0.6),
        ("reflect(vec2(1, -1), vec2(0, 1)).y", 1.0),
        ("if x < 1 && !(y > 0) then 10 else 20", 10.0),
        ("if x == 0.5 || false then vec2(1, 2).y else 3", 2.0),
        ("if z != 3 then 1 else 2", 2.0),
        ("sum(for i in 0..5: i)", 10.0),
        ("sum(for i in 0..3: for j in 0..i: 10 * i + j)", 51.0),
        ("product(1, for i in 1..5: i, 2)", 48.0),
        ("max(for i in 0..4: if i == 2 then 9 else i)", 9.0),
        ("{ let a = 2  let b = a * 3; a + b }", 8.0),
        ("{ let x = 1  { let x = 2  x } + x }", 3.0),
        (".5 + 1e-1 + 1.", 1.6),
        ("volume.y", 0.5),
        ("band(3)", 0.03),
        ("band(z)", 0.03),
        ("chroma(3)", 0.3),
        ("note(87) + note(z + 39)", 1.29),
        ("pan(31) + width(31) + width(z + 99)", 0.31),
        // Computed indices are clamped and rounded down.
        ("chroma(z) + chroma(z + 0.9)", 0.6),
        ("chroma(z - 50) + chroma(z + 50) + chroma(z + 1)", 1.1),
        ("energy + section", 0.75),
        ("t", 2.0),
        ("round(2.5)", 3.0),
        ("round(x, 0.25)", 0.25),
        ("tau - 2 * pi", 0.0),
        ("min(p, 0.25).x", 0.25),
        ("spectrum(0.5) + waveform(0.5) + history(0.5, 0) + bass + mid + treble + beat + tempo + phase", 0.0),
    ] {
        let got = value(text, at);
        assert!((got - expected).abs() < 1e-5, "{text} is {got}, not {expected}");
    }
}

#[test]
fn a_scenes_own_names_hide_the_numbers_of_the_song() {
    for text in [
        "param energy = 3 in 0 .. 4\nenergy + key",
        "let energy = 3\nenergy + key",
        "let kick = 3\nkick + snare",
        "fn f(energy) = energy\nf(3) + key",
        "{ let energy = 3  energy + key }",
        "fn chroma(i) = i\nchroma(3) + key",
    ] {
        assert_eq!(value(text, [0.0; 3]), 3.0, "{text}");
    }
    let scene = |text: &str| compile("s", text, &mut super::no_includes).scene.unwrap();
    assert!(!scene("let energy = 3\nlength(p) - energy").graph.reads_song());
    for text in ["length(p) - energy", "length(p) - chroma(3)", "length(p) - chroma(x)", "length(p) - phase"]
    {
        assert!(scene(text).graph.reads_song() && scene(text).graph.moves_by_itself(), "{text}");
    }
}

#[test]
fn functions_lets_and_params_have_scopes() {
    let text = "param size = 2 in 1 .. 3
        let twice = 2 * size
        fn size_of(size) = size + twice          # a parameter hides the scene's name
        fn box(p, k) { let p = p * k  p.x }      # takes precedence over the library's
        let sphere = box(p, 10)                  # values and functions have separate namespaces
        sphere + size_of(1) + length(p.yz)";
    assert_eq!(value(text, [1.0, 3.0, 4.0]), 10.0 + 5.0 + 5.0);
    // The library still calls its own `box`.
    assert_eq!(value("fn box(p, s) = 77\nround_box(p, 1, 0)", [3.0, 0.0, 0.0]), 2.0);
    // A function cannot use the local names of its caller.
    assert!(compile("s", "fn f() = a\n{ let a = 1  f() }", &mut super::no_includes).scene.is_none());
}

#[test]
fn a_scene_has_objects_materials_lights_camera_and_sky() {
    let text = "material red { color = vec3(1, 0, 0)  roughness = abs(n.y) * 0.5  emission = 0.25 }
        object ball { shape = sphere(p, 1)  material = red }
        object floor { shape = y + 1 }
        light sun { direction = vec3(0, -1, t)  color = 3 }
        camera { position = vec3(t, 0, 0)  fov = 60 }
        sky { color = direction * 0.5 }
        param a = 0.5
        param b = -1 in -2 .. -0.5";
    let scene = scene(text);
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["ball", "floor"]);
    assert_eq!(scene.materials[scene.objects[0].material].name, "red");
    assert_eq!(scene.materials[scene.objects[1].material].name, "default");
    assert_eq!(distance(&scene, [0.0, -0.75, 3.0]), 0.25);
    let point = Point { position: [0.0; 3], normal: [0.0, -1.0, 0.5] };
    let at = |roots: &[_]| scene.graph.evaluate(roots, &point, &frame(&scene));
    let red = &scene.materials[0];
    assert_eq!(at(&red.color), [1.0, 0.0, 0.0]);
    assert_eq!(at(&[red.roughness, red.reflect]), [0.5, 0.0]);
    assert_eq!(at(&red.emission), [0.25; 3]);
    assert_eq!(scene.lights[0].kind, LightKind::Sun);
    assert_eq!(at(&scene.lights[0].direction), [0.0, -1.0, 2.0]);
    assert_eq!(at(&scene.camera.position), [2.0, 0.0, 0.0]);
    assert_eq!(at(&[scene.camera.fov]), [60.0]);
    assert_eq!(at(&scene.sky.color), [0.0, -0.5, 0.25]);
    let ranges: Vec<(f32, f32, f32)> =
        scene.params.iter().map(|one| (one.min, one.default, one.max)).collect();
    assert_eq!(ranges, [(0.0, 0.5, 1.0), (-2.0, -1.0, -0.5)]);
}

#[test]
fn includes_are_resolved_once_and_may_use_the_including_scene() {
    let mut asked = Vec::new();
    let mut resolve = |name: &str| {
        asked.push(name.to_owned());
        match name {
            "sub/a.scene" => Ok("include \"b.scene\"\nfn a(p) = b(p) * unit".to_owned()),
            "b.scene" => Ok("fn b(p) = p.x".to_owned()),
            _ => Err("no such file".to_owned()),
        }
    };
    let text = "include \"./sub/a.scene\" include \"b.scene\"\nlet unit = 3\na(p)";
    let compiled = compile("main.scene", text, &mut resolve);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{:?}", compiled.diagnostics));
    assert_eq!(distance(&scene, [2.0, 0.0, 0.0]), 6.0);
    assert_eq!(scene.includes, ["sub/a.scene", "b.scene"]);
    assert_eq!(asked, ["sub/a.scene", "b.scene"]);
    assert_eq!(compiled.includes_asked, asked);
    let names: Vec<&str> = compiled.sources.files().iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["main.scene", "sub/a.scene", "b.scene"]);
}

#[test]
fn textures_are_numbered_by_file() {
    let text = "material m { color = triplanar(\"a.png\", p, n) + texture(\"./b.png\", p.xz).rgb * texture(\"a.png\", p.xy).a }
        object o { shape = p.y  material = m }";
    let scene = scene(text);
    let names: Vec<&str> = scene.textures.iter().map(|texture| texture.name.as_str()).collect();
    assert_eq!(names, ["a.png", "b.png"]);
    let used = scene.graph.inputs_used(&scene.materials[0].color);
    assert_eq!(used.textures.into_iter().collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn the_speakers_are_the_thesis_scene() {
    let text = include_str!("../../../../../tests/oracle/speakers.scene");
    let scene = scene(text);
    assert_eq!(scene.objects.len(), 3);
    // Points on the side and the top of a cabinet, the floor, the middle of the bridge, and the side of the second
    // cabinet.
    let loud = 1.0 - (-5.0_f32 * 0.375).exp();
    let radius = 0.2 + 0.22 * loud + 0.09 * loud * 4.0_f32.cos();
    for (at, expected) in [
        ([8.2, 3.2, 10.0], 1.0),
        ([5.0, 7.4, 10.0], 1.0),
        ([0.0, 1.0, 3.0], 1.0),
        ([0.0, 4.55 + radius + 0.5, 10.0], 0.93 * 0.5),
        ([-8.2, 5.0, 10.0], 1.0),
    ] {
        let got = distance(&scene, at);
        assert!((got - expected).abs() < 1e-4, "{at:?}: {got}, not {expected}");
    }
    // The height of bar 20 follows its band.
    let top = 0.04 + 3.4 * 0.20;
    let got = distance(&scene, [4.5 * 0.16, top + 0.02, 8.7]);
    assert!((got - 0.02).abs() < 1e-4, "{got}");
    assert_eq!(
        scene.textures.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(),
        ["wood.png", "mallard.png"]
    );
}

#[test]
fn eye_is_an_input_of_materials_and_sky_and_may_also_name_a_function() {
    let text = "fn eye() = vec3(0, 0, -9)
        material mist { haze = length(p - eye)  color = 0.1 * eye() }
        object ball { shape = sphere(p, 1)  material = mist }
        sky { color = eye.y }
        camera { position = eye() }";
    let scene = scene(text);
    let inputs = FrameInputs { eye: [3.0, 4.0, 0.0], ..super::frame(&scene) };
    let roots = [scene.materials[0].haze, scene.sky.color[0], scene.camera.position[2]];
    let values = scene.graph.evaluate(&roots, &Point::at(0.0, 0.0, 0.0), &inputs);
    assert_eq!(values, [5.0, 4.0, -9.0]);
}
