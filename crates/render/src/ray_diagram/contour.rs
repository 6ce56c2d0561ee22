//! Lines of equal value in a grid of samples (marching squares, Lorensen and Cline 1987 in two dimensions).

use glam::{Vec2, vec2};

/// Returns the line segments on which the values equal `level`. The samples are at whole coordinates, row by row. Cells
/// with a value that is not finite have no line.
pub(super) fn contour(values: &[f32], columns: usize, level: f32) -> Vec<[Vec2; 2]> {
    let mut lines = Vec::new();
    for (row, two) in values.chunks_exact(columns.max(1)).collect::<Vec<_>>().windows(2).enumerate() {
        let [upper, lower] = two else { continue };
        for (column, (upper, lower)) in upper.windows(2).zip(lower.windows(2)).enumerate() {
            let ([a, b], [d, c]) = (upper, lower) else { continue };
            let corners = [a, b, c, d].map(|value| value - level);
            if corners.iter().all(|value| value.is_finite()) {
                let low = vec2(column as f32, row as f32);
                let crossings = crossings(corners);
                lines.extend(crossings.chunks_exact(2).map(|pair| [low + pair[0], low + pair[1]]));
            }
        }
    }
    lines
}

/// Returns the points at which the border of a cell crosses 0, clockwise.
fn crossings(corners: [f32; 4]) -> Vec<Vec2> {
    let places = [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0)];
    let mut found = Vec::new();
    for side in 0..4 {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        if (from > 0.0) != (to > 0.0) {
            found.push(places[side].lerp(places[(side + 1) % 4], from / (from - to)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contour_of_a_disc_is_a_circle() {
        let side = 21;
        let values: Vec<f32> = (0..side * side)
            .map(|index| vec2((index % side) as f32, (index / side) as f32).distance(Vec2::splat(10.0)) - 6.0)
            .collect();
        for level in [0.0, 2.0] {
            let lines = contour(&values, side, level);
            assert!(lines.len() > 20);
            for end in lines.iter().flatten() {
                assert!((end.distance(Vec2::splat(10.0)) - 6.0 - level).abs() < 0.1, "{end}");
            }
        }
        assert!(contour(&[1.0, f32::NAN, -1.0, -1.0], 2, 0.0).is_empty());
        assert!(contour(&[], 0, 0.0).is_empty());
    }
}
