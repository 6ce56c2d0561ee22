//! Packs the tables for the shaders: spectrum, waveform, numbers of the song's parts, rows of the history, then the grid
//! over the media, then texts and pictures as shapes (`shaders/scene_inputs.glsl`), then the swarms. The sound comes
//! first, so that scenes find it at constant places.

use mariana_field::graph::{FrameInputs, Op, PartInput, SHAPE_COLUMNS, TableData};
use mariana_field::region::MediumGrid;
use mariana_field::world::World;
use mariana_music::{HISTORY_POINTS, SPECTRUM_POINTS, WAVEFORM_POINTS};

/// True if any expression of the world reads the tables.
pub fn are_read_by(world: &World) -> bool {
    let roots: Vec<_> = world.roots.all().collect();
    let used = world.graph.inputs_used(&roots);
    Op::CURVES.iter().chain(&Op::PARTS).any(|table| used.tables.contains(table))
}

const HISTORY_PIECES: usize = HISTORY_POINTS - 1;
/// The first texel of the history.
const HISTORY: usize = SPECTRUM_POINTS - 1 + WAVEFORM_POINTS - 1 + PartInput::COUNT;
/// Shaders always read this number of rows of the history.
const HISTORY_ROWS_MIN: usize = 4;

/// Returns the first texel of texts and pictures as shapes. These fill rows of
/// [`SHAPE_COLUMNS`](mariana_field::graph::SHAPE_COLUMNS) texels: one with the shapes' numbers, then the patches.
pub fn first_shape(inputs: &FrameInputs, medium: Option<&MediumGrid>) -> usize {
    texel_count(inputs) + medium.map_or(0, |grid| grid.densities.len() / 4)
}

/// Returns the first texel of the swarms.
pub fn first_of_swarm(inputs: &FrameInputs, medium: Option<&MediumGrid>) -> usize {
    let rows = inputs.shapes.rows();
    first_shape(inputs, medium) + if rows > 0 { (rows + 1) * SHAPE_COLUMNS } else { 0 }
}

/// Number of texels of the sound, after which the grid over the media begins, four cells in a texel.
pub fn texel_count(inputs: &FrameInputs) -> usize {
    HISTORY + history_rows(inputs).max(HISTORY_ROWS_MIN) * HISTORY_PIECES
}

/// Number of rows of the history in the list; 0 if its rows have an unexpected length.
fn history_rows(inputs: &FrameInputs) -> usize {
    let history = &inputs.history;
    if history.pieces_in_row() == HISTORY_PIECES { history.row_of_pieces_count() } else { 0 }
}

/// The texels of the sound: one polynomial per piece, and one number of the parts in the first component of each texel.
/// A table of an unexpected length is replaced by silence.
pub fn texels(inputs: &FrameInputs) -> Vec<[f32; 4]> {
    let mut texels = Vec::new();
    append(&mut texels, &inputs.spectrum, SPECTRUM_POINTS - 1);
    append(&mut texels, &inputs.waveform, WAVEFORM_POINTS - 1);
    let numbers = (0..PartInput::COUNT).map(|at| inputs.parts.get(at).copied().unwrap_or(0.0));
    texels.extend(numbers.map(|number| [number, 0.0, 0.0, 0.0]));
    let history = inputs.history.rows_of_pieces().take(history_rows(inputs));
    texels.extend(history.flatten().map(polynomial));
    texels.resize(texel_count(inputs), [0.0; 4]);
    texels
}

/// Appends the first row of a table, or zeros if the row has another number of pieces.
fn append(texels: &mut Vec<[f32; 4]>, table: &TableData, pieces: usize) {
    let end = texels.len() + pieces;
    let row = table.rows_of_pieces().next().filter(|row| row.len() == pieces);
    texels.extend(row.into_iter().flatten().map(polynomial));
    texels.resize(end, [0.0; 4]);
}

/// Converts the Bézier points of a cubic to coefficients, constant term first. Coefficients need fewer registers.
fn polynomial(&[a, b, c, d]: &[f32; 4]) -> [f32; 4] {
    [a, 3.0 * (b - a), 3.0 * (a - 2.0 * b + c), d - a + 3.0 * (b - c)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_packed_in_the_shaders_order() {
        let inputs = FrameInputs {
            spectrum: TableData::row(vec![0.25; SPECTRUM_POINTS]),
            waveform: TableData::row(vec![9.0; 3]),
            parts: vec![0.125, 0.75],
            history: TableData::scrolling(vec![0.5; 3 * HISTORY_POINTS], HISTORY_POINTS, 0.5, 1.0),
            ..FrameInputs::default()
        };
        let texels = texels(&inputs);
        let (spectrum, rest) = texels.split_at(SPECTRUM_POINTS - 1);
        let (waveform, rest) = rest.split_at(WAVEFORM_POINTS - 1);
        let (parts, history) = rest.split_at(PartInput::COUNT);
        assert_eq!([parts[0][0], parts[1][0], parts[2][0]], [0.125, 0.75, 0.0]);
        assert!(spectrum.iter().all(|piece| *piece == [0.25, 0.0, 0.0, 0.0]));
        assert!(
            waveform.iter().all(|points| *points == [0.0; 4]),
            "a table of three points is replaced by silence"
        );
        assert_eq!(history.len(), 6 * (HISTORY_POINTS - 1), "one row before, two after");
        assert!(history.iter().all(|piece| *piece == [0.5, 0.0, 0.0, 0.0]));
        let silence = super::texels(&FrameInputs::default());
        let curves = SPECTRUM_POINTS - 1 + WAVEFORM_POINTS - 1;
        assert_eq!(silence.len(), curves + PartInput::COUNT + 4 * (HISTORY_POINTS - 1));
    }

    #[test]
    fn the_polynomial_equals_the_bezier_curve() {
        let points = [0.1, 0.7, -0.4, 0.9];
        let [a, b, c, d] = polynomial(&points);
        for x in [0.0_f32, 0.25, 0.5, 1.0] {
            let s = 1.0 - x;
            let weights = [s * s * s, 3.0 * s * s * x, 3.0 * s * x * x, x * x * x];
            let curve: f32 = points.iter().zip(weights).map(|(point, weight)| point * weight).sum();
            assert!((((d * x + c) * x + b) * x + a - curve).abs() < 1e-6, "at {x}");
        }
    }

    #[test]
    fn only_worlds_that_use_tables_read_them() {
        use crate::frame::testing::world_of;
        for (text, read) in [
            ("length(p) - 1 - band(3)", false),
            ("length(p) - 1 - spectrum(y)", true),
            ("length(p) - 1 - spectrum(0.5)", false),
            ("length(p) - 1 - drums.band(3) - vocals.melody", false),
            ("length(p) - 1 - drums.band(x)", true),
            (
                "object a { shape = sphere(p, 1) material = m }\nmaterial m { color = vec3(history(x, y)) }",
                true,
            ),
        ] {
            assert_eq!(are_read_by(&world_of(text)), read, "{text}");
        }
    }
}
