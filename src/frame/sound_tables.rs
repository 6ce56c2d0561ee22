//! The sound's tables as the shaders read them: spectrum, waveform, rows of the history
//! (`shaders/scene_inputs.glsl`).

use mariana_field::graph::{FrameInputs, Op, TableData};
use mariana_field::world::World;
use mariana_music::{HISTORY_POINTS, SPECTRUM_POINTS, WAVEFORM_POINTS};

/// Whether any expression of a world reads the tables.
pub fn are_read_by(world: &World) -> bool {
    let roots: Vec<_> = world.roots.all().collect();
    // A world's graph has been checked.
    let used = world.graph.inputs_used(&roots).unwrap_or_default();
    Op::CURVES.iter().any(|table| used.tables.contains(table))
}

/// The texels, one float each. A table of another shape than the shaders expect is replaced by silence.
pub fn texels(inputs: &FrameInputs) -> Vec<f32> {
    let mut values = Vec::new();
    append(&mut values, &inputs.spectrum, SPECTRUM_POINTS);
    append(&mut values, &inputs.waveform, WAVEFORM_POINTS);
    let history = inputs.history.values();
    values.extend(history.chunks_exact(HISTORY_POINTS).flatten());
    // Shaders read the row after the last one, though without weight, and two where there is none.
    values.extend([0.0; 2 * HISTORY_POINTS]);
    values
}

fn append(values: &mut Vec<f32>, table: &TableData, points: usize) {
    let end = values.len() + points;
    if table.values().len() == points {
        values.extend(table.values());
    }
    values.resize(end, 0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_stands_where_the_shaders_look() {
        let inputs = FrameInputs {
            spectrum: TableData::row(vec![0.25; SPECTRUM_POINTS]),
            waveform: TableData::row(vec![9.0; 3]),
            history: TableData::scrolling(vec![0.5; 3 * HISTORY_POINTS], HISTORY_POINTS, 0.5, 1.0),
            ..FrameInputs::default()
        };
        let values = texels(&inputs);
        let (spectrum, rest) = values.split_at(SPECTRUM_POINTS);
        let (waveform, history) = rest.split_at(WAVEFORM_POINTS);
        assert!(spectrum.iter().all(|value| *value == 0.25));
        assert!(waveform.iter().all(|value| *value == 0.0), "a table of three points is none");
        let (rows, behind) = history.split_at(3 * HISTORY_POINTS);
        assert!(rows.iter().all(|value| *value == 0.5) && behind.iter().all(|value| *value == 0.0));
        assert_eq!(behind.len(), 2 * HISTORY_POINTS);
    }

    #[test]
    fn worlds_without_tables_read_none() {
        use crate::frame::testing::world_of;
        for (text, read) in [
            ("length(p) - 1 - band(3)", false),
            ("length(p) - 1 - spectrum(y)", true),
            // Computed once per frame.
            ("length(p) - 1 - spectrum(0.5)", false),
            (
                "object a { shape = sphere(p, 1) material = m }\nmaterial m { color = vec3(history(x, y)) }",
                true,
            ),
        ] {
            assert_eq!(are_read_by(&world_of(text)), read, "{text}");
        }
    }
}
