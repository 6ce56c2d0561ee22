//! Prints the rows of the settings panel: `cargo run -p mariana-settings --example settings`.

use mariana_settings::Choices;

fn main() {
    let choices = Choices::default();
    for row in choices.rows(&choices).into_iter().chain(choices.stage.rows(&choices.stage)) {
        println!("{}: {}", row.name, row.purpose);
    }
}
