//! Tests of the locations of nodes.

use crate::graph::NodeId;
use crate::lang::{Scene, compile, no_includes};

fn scene(text: &str) -> Scene {
    compile("test", text, &mut no_includes).scene.unwrap()
}

fn lines(text: &str, object: usize, path: &[NodeId], scene: &Scene) -> Vec<usize> {
    let material = scene.objects[object].material;
    let places = scene.origins.places(object, material, path);
    let line = |byte: usize| 1 + text[..byte].matches('\n').count();
    let mut lines: Vec<usize> = places.into_iter().map(|(_, byte)| line(byte)).collect();
    lines.dedup();
    lines
}

const TWO: &str = "\
let far = 3
fn ball(q) =
  sphere(q, 1)
material red { color = vec3(1, 0, 0) }
object both {
  material = red
  let aside = p - vec3(far, 0, 0)
  shape = union(
    ball(p),
    box(aside,
      vec3(0.5)))
}
object floor { shape = y + 1 }";

#[test]
fn a_part_of_a_union_comes_from_its_own_lines() {
    let scene = scene(TWO);
    let root = scene.objects[0].shape;
    let crate::graph::Node::Binary(crate::graph::Op::Min, a, b) = scene.graph.node(root) else {
        panic!("the shape is no union");
    };
    let (ball, cube) = if scene.origins.written_at(a).unwrap().1.start < TWO.find("object").unwrap() {
        (a, b)
    } else {
        (b, a)
    };
    // The function, the call, the head of the object, and its material.
    assert_eq!(lines(TWO, 0, &[root, ball], &scene), [3, 4, 5, 6, 8, 9]);
    // The value of a name, and the numbers in its lines.
    assert_eq!(lines(TWO, 0, &[root, cube], &scene), [1, 4, 5, 6, 7, 8, 10, 11]);
    assert_eq!(lines(TWO, 1, &[scene.objects[1].shape], &scene), [13]);
    let (file, range) = scene.origins.written_at(ball).unwrap();
    assert_eq!((file, &TWO[range]), (0, "sphere(q, 1)"));
}

#[test]
fn included_text_is_in_its_own_file() {
    let mut texts = |path: &str| match path {
        "part.scene" => Ok("# a part\nfn ball(q) = sphere(q, 1)\n".to_owned()),
        _ => Err("there is none".to_owned()),
    };
    let main = "include \"part.scene\"\nobject one { shape = ball(p) }";
    let scene = compile("main", main, &mut texts).scene.unwrap();
    let (file, range) = scene.origins.written_at(scene.objects[0].shape).unwrap();
    assert_eq!(
        (file, range),
        (1, "# a part\nfn ball(q) = ".len().."# a part\nfn ball(q) = sphere(q, 1)".len())
    );
    let places = scene.origins.places(0, scene.objects[0].material, &[scene.objects[0].shape]);
    let files: std::collections::BTreeSet<usize> = places.iter().map(|place| place.0).collect();
    assert_eq!(files.into_iter().collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn objects_that_melt_come_from_the_text_of_both() {
    let text = "object a { shape = sphere(p, 1) }\nobject b { shape = box(p, 0.9)\n  melt = 0.2 }";
    let scene = scene(text);
    assert_eq!(lines(text, 0, &[scene.objects[0].shape], &scene), [1, 2, 3]);
}

#[test]
fn a_scene_may_exceed_the_list_of_notes() {
    let text =
        "object o { shape = min(for i in 0..1000: sphere(p - vec3(i, sum(for k in 0..300: k * x), 0), 1)) }";
    let compiled = compile("test", text, &mut no_includes);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{:?}", compiled.diagnostics));
    assert!(scene.origins.notes.len() >= super::NOTES_MAX);
    assert!(!scene.origins.places(0, 0, &[scene.objects[0].shape]).is_empty());
}
