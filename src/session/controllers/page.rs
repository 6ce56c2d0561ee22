//! The tables of docs/osc.md, generated from the program's addresses.

use crate::commands;
use crate::session::controllers::network::sent_addresses;
use mariana_control::action::ValueType;
use mariana_control::osc::fixed_addresses;

/// The addresses of parameters, scenes and queries as Markdown rows.
pub fn address_table() -> String {
    let mut text = String::from("| address | arguments | what it does |\n|---|---|---|\n");
    for (address, arguments, meaning) in fixed_addresses() {
        text.push_str(&format!("| `{address}` | {arguments} | {meaning} |\n"));
    }
    text
}

/// The actions as Markdown rows.
pub fn action_table() -> String {
    let mut text = String::from("| address | arguments | what it does |\n|---|---|---|\n");
    for row in commands::for_controllers() {
        let arguments = match row.takes {
            ValueType::Press => "",
            ValueType::Switch => "1 on, 0 off; toggles without an argument",
            ValueType::Level => "0..1",
            ValueType::Number => "a number",
            ValueType::Choice => "a name, or a number from 1",
            ValueType::Index(_) => "a number from 1",
        };
        text.push_str(&format!("| `/{}` | {arguments} | {} |\n", row.name, row.meaning));
    }
    text
}

/// The addresses of sent messages, in one line.
pub fn sent_line() -> String {
    sent_addresses().map(|address| format!("`{address}`")).collect::<Vec<_>>().join(", ")
}
