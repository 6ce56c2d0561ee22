//! Meshes of scenes.

#![allow(clippy::unwrap_used)]

use crate::support::program::Workplace;

/// The number at an offset of a file.
fn number(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

#[test]
fn each_format_holds_the_mesh_of_a_moment() {
    let place = Workplace::new();
    let mesh = |scene: &str, file: &str| {
        let said = place.run(&["mesh", "--scene", scene, "--detail", "16", "--at", "3", "-o", file]).done();
        let triangles = said.split_whitespace().rev().nth(1).unwrap().parse::<usize>().unwrap();
        (triangles, place.read(file))
    };
    let (triangles, stl) = mesh("sphere(p, 1)", "ball.stl");
    assert!(triangles > 500 && (number(&stl, 80), stl.len()) == (triangles, 84 + 50 * triangles));
    let (same, glb) = mesh("sphere(p, 1)", "ball.glb");
    assert_eq!((same, &glb[..4], number(&glb, 8)), (triangles, &b"glTF"[..], glb.len()));
    let head: serde_json::Value = serde_json::from_slice(&glb[20..20 + number(&glb, 12)]).unwrap();
    assert_eq!(head["accessors"][3]["count"], 3 * triangles);
    let low = head["accessors"][0]["min"][1].as_f64().unwrap();
    assert!((low + 1.0).abs() < 0.05, "{low}");
    let (_, obj) = mesh("sphere(p, 1)", "ball.obj");
    let lines = |start: &str| {
        obj.split(|byte| *byte == b'\n').filter(|line| line.starts_with(start.as_bytes())).count()
    };
    assert_eq!((lines("f "), lines("v ")), (triangles, lines("vn ")));
    // The ball has another size at each moment.
    let (_, stl) = mesh("sphere(p, 1.5 + sin(t))", "grown.stl");
    let highest = stl[84..].chunks(50).map(|one| f32::from_le_bytes(one[20..24].try_into().unwrap()));
    assert!((highest.fold(0.0, f32::max) - 1.5 - 3f32.sin()).abs() < 0.05);
}

#[test]
fn what_has_no_mesh_is_refused() {
    let place = Workplace::new();
    let mesh = |arguments: &[&str]| place.run(&[&["mesh"], arguments].concat());
    mesh(&["--scene", "sphere(p, 1)", "-o", "ball.png"])
        .refused(&["ball.png cannot be written: meshes are glTF"]);
    mesh(&["--scene", "p.y", "-o", "a.stl"]).refused(&["one without an end: intersect it with a box"]);
    mesh(&["--scene", "sphere(p, 1)", "--set", "size=2", "-o", "a.stl"]).refused(&["size"]);
    mesh(&["--scene", "sphere(p, 1)", "--at", "9:00", "-o", "a.stl"]).refused(&["ends at"]);
    assert!(place.names().is_empty(), "{:?}", place.names());
}
