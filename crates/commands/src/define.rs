//! The macros of the table of commands.

/// Defines [`Command`] and its table from one row per command. The keys of the rows behind `[GROUP]` are in this group of
/// the help.
macro_rules! commands {
    ($( [$group:ident] $(
        $(#[$doc:meta])* $variant:ident $( ( $value:ty ) )? { $($field:ident: $of_row:expr),* $(,)? }
    )* )*) => {
        /// A request by the user.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Command {
            $($( $(#[$doc])* $variant $( ($value) )?, )*)*
        }

        /// One row per command, in the order of the help.
        pub static ROWS: &[Row] = &[
            $($( Row { $($field: $of_row,)* group: Group::$group, ..Row::PLAIN }, )*)*
        ];

        enum Place { $($( $variant, )*)* }

        impl Command {
            /// Returns the command's row of the table.
            pub(crate) fn row(&self) -> &'static Row {
                let place = match self { $($( Self::$variant { .. } => Place::$variant, )*)* };
                &ROWS[place as usize]
            }
        }
    };
}

macro_rules! keys {
    ($($key:expr),+ => $command:expr, $written:literal, $help:literal $(, $field:ident: $value:expr)*) => {
        Binding { keys: &[$(($key, $command)),+], written: $written, help: $help, $($field: $value,)* ..Binding::ONCE }
    };
}
