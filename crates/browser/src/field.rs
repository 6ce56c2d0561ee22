//! Parses, evaluates and prunes formulas.

use crate::expect;
use mariana_field::Field;
use mariana_field::graph::FrameInputs;

const FORMULA: &str =
    "min(sphere(p, 1) + 0.1 * sin(8 * p.x), max(p.y + 1.2, -box(p - vec3(2, 0, 0), vec3(0.6))))";

pub(crate) fn check() -> Result<(), u32> {
    let silence = FrameInputs::default();
    expect(Field::parse("sphere(p, ").is_err(), line!())?;
    let ball = Field::parse("sphere(p, 1)").map_err(|_| line!())?;
    expect(ball.eval(&[[3.0, 4.0, 0.0]], &silence) == [4.0], line!())?;

    let field = Field::parse(FORMULA).map_err(|_| line!())?;
    expect(field.glsl().is_ok_and(|text| text.contains("sin")), line!())?;
    let points: Vec<[f32; 3]> = (0..1000_u16)
        .map(f32::from)
        .map(|i| [(i * 0.37).sin(), (i * 0.71).sin(), (i * 1.3).cos()].map(|x| 3.0 * x))
        .collect();
    let values = field.eval(&points, &silence);
    let bounds = field.bounds([-3.0; 3], [3.0; 3], &silence);
    expect(values.iter().all(|value| (bounds.lo..=bounds.hi).contains(value)), line!())?;

    let tree = field.tree(&silence);
    let mut shortened = 0;
    for (point, value) in points.iter().zip(&values) {
        let Some(cell) = tree.cell_at(*point) else { continue };
        // A bound is 0 where the surface may be, and the value there may be less.
        expect(value.max(0.0) >= cell.bound, line!())?;
        let here = tree.run(cell.tape, *point, 0.0, &silence)[0];
        expect(here.to_bits() == value.to_bits(), line!())?;
        shortened += u32::from(tree.clauses_of(cell.tape) < field.tape().clauses().len() as u64);
    }
    expect(shortened > 100, line!())
}
