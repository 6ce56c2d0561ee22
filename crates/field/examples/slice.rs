//! Prints the slice z = 0 of a formula as text: `cargo run -p mariana-field --example slice -- "sphere(p, 1)"`.

use mariana_field::Field;
use mariana_field::graph::FrameInputs;

const COLUMNS: usize = 64;
const ROWS: usize = 32;

fn main() {
    let text = std::env::args().nth(1).unwrap_or_else(|| "max(sphere(p, 1), -box(p, vec3(0.6)))".to_owned());
    let field = match Field::parse(&text) {
        Ok(field) => field,
        Err(mistake) => return eprintln!("{mistake}"),
    };
    for row in 0..ROWS {
        let y = 1.5 - 3.0 * row as f32 / (ROWS - 1) as f32;
        let along = (0..COLUMNS).map(|column| [3.0 * column as f32 / (COLUMNS - 1) as f32 - 1.5, y, 0.0]);
        let values = field.eval(&along.collect::<Vec<_>>(), &FrameInputs::default());
        let letter = |value: f32| match value {
            ..=0.0 => '#',
            ..0.1 => '+',
            ..0.4 => '.',
            _ => ' ',
        };
        println!("{}", values.into_iter().map(letter).collect::<String>());
    }
}
