//! Prints the table of keys and the commands for controllers: `cargo run -p mariana-commands --example keys`.

fn main() {
    for binding in mariana_commands::bindings() {
        println!("{}: {}", binding.written, binding.help);
    }
    for row in mariana_commands::for_controllers() {
        println!("/{}: {}", row.name, row.meaning);
    }
}
