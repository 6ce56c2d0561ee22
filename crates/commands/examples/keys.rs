//! Prints the table of keys and the commands for controllers: `cargo run -p mariana-commands --example keys`.

fn main() {
    println!("{}", mariana_commands::markdown_table());
    for row in mariana_commands::for_controllers() {
        println!("/{}: {}", row.name, row.meaning);
    }
}
