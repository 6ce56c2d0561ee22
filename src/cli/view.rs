//! The flag `--view`.

use clap::Args;

use crate::view::{self, ViewChoice};

#[derive(Args)]
pub(super) struct ViewArguments {
    #[arg(long, value_name = "VIEW", help = view::help(), allow_hyphen_values = true)]
    pub(super) view: Option<ViewChoice>,
}
