//! Flags whose value is one of several names.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::config::Choice;

pub(super) fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let names = T::ALL.iter().map(|(_, name, meaning)| match *meaning {
        "" => PossibleValue::new(*name),
        meaning => PossibleValue::new(*name).help(meaning),
    });
    let unknown = "unknown name";
    PossibleValuesParser::new(names.collect::<Vec<_>>()).try_map(move |name| T::named(&name).ok_or(unknown))
}
