//! The subcommand `scenes`.

use crate::export::print::print_line;
use crate::scenes::{SceneSource, first_comment, shipped_names};

pub(super) fn run() -> anyhow::Result<()> {
    let mut list = String::new();
    for name in shipped_names() {
        let text = SceneSource::Shipped(name.clone()).text()?.into_owned();
        list += &name;
        for line in first_comment(&text) {
            list += "\n  ";
            list += line;
        }
        list.push('\n');
    }
    Ok(print_line(list.trim_end())?)
}
