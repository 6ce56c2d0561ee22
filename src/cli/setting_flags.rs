//! Flags for settings, generated from the table of settings. A flag holds for one run and overrides the saved setting.

use clap::Args;

use super::parse::{choice, parse_corners, parse_crop, parse_fade, parse_percent};
use crate::config::{Choices, QualityChoice, Setting, with_settings};
use crate::placement::{Corners, Crop, Flip};

/// Defines a flag for each table row with brackets.
macro_rules! define_flags {
    ($( $table:ident { $(
        $(#[$of_field:meta])* $field:ident: $type:ty = $default:expr, $variant:ident
            $({ $name:literal, $purpose:literal, $group:ident })? $([ $($key:ident = $value:expr),+; $help:literal ])?;
    )* } )*) => {
        #[derive(Args)]
        pub(super) struct SettingFlags {
            $($($(
                #[arg(long, help = $help, $($key = $value),+)]
                $field: Option<$type>,
            )?)*)*
        }

        impl SettingFlags {
            pub(super) fn over(&self, remembered: &Choices) -> Choices {
                let mut choices = remembered.clone();
                $($($(
                    // Makes the macro skip rows without a flag.
                    let _ = $help;
                    if let Some(value) = self.$field {
                        choices.set(&Setting::$variant(value));
                    }
                )?)*)*
                choices
            }
        }
    };
}

with_settings!(define_flags);
