//! What hands can do besides turning parameters: a table of the program's, by stable names.

/// What an action takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// Nothing: it happens when a button goes down.
    Press,
    /// On or off; without a value it changes over.
    Switch,
    /// A share, 0..1.
    Level,
    /// A number in units of its own, or nothing.
    Number,
    /// A name, or a number counted from 1.
    Choice,
}

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeedRow {
    /// Its name in OSC addresses and in files, of small letters and underlines; it never changes.
    pub name: &'static str,
    /// What it takes.
    pub takes: Takes,
    /// What it does, as the end of a sentence.
    pub meaning: &'static str,
}

/// What comes with an action.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Given {
    /// Nothing.
    #[default]
    Nothing,
    /// A number, which is finite.
    Number(f32),
    /// A name.
    Text(String),
}

/// An action that a hand wishes for.
#[derive(Debug, Clone, PartialEq)]
pub struct Deed {
    /// The name of its row.
    pub name: &'static str,
    /// What came with it.
    pub given: Given,
}

/// The row of this name.
pub fn row_of(table: &[DeedRow], name: &str) -> Option<DeedRow> {
    table.iter().find(|row| row.name == name).copied()
}

impl DeedRow {
    /// What it means that something came with it; none if it is to be left, because a button was let go or because it
    /// is not what the action takes.
    pub fn wanted(self, given: Given) -> Option<Deed> {
        let deed = |given| Some(Deed { name: self.name, given });
        match (self.takes, given) {
            (_, Given::Number(number)) if !number.is_finite() => None,
            (Takes::Press, Given::Number(number)) if number <= 0.0 => None,
            (Takes::Press, _) => deed(Given::Nothing),
            (Takes::Switch | Takes::Level | Takes::Number, Given::Text(_)) => None,
            (Takes::Level, Given::Number(number)) => deed(Given::Number(number.clamp(0.0, 1.0))),
            (Takes::Level | Takes::Choice, Given::Nothing) => None,
            (Takes::Switch | Takes::Number | Takes::Choice, given) => deed(given),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wanted(takes: Takes, given: Given) -> Option<Given> {
        DeedRow { name: "x", takes, meaning: "" }.wanted(given).map(|deed| deed.given)
    }

    #[test]
    fn actions_take_what_they_can_use_and_leave_the_rest() {
        use Given::{Nothing, Number, Text};
        let text = || Text("orb".to_owned());
        assert_eq!(wanted(Takes::Press, Nothing), Some(Nothing));
        assert_eq!(wanted(Takes::Press, Number(1.0)), Some(Nothing));
        assert_eq!(wanted(Takes::Press, Number(0.0)), None, "the button is let go");
        assert_eq!(wanted(Takes::Switch, Number(0.0)), Some(Number(0.0)));
        assert_eq!(wanted(Takes::Switch, Nothing), Some(Nothing));
        assert_eq!(wanted(Takes::Switch, text()), None);
        assert_eq!(wanted(Takes::Level, Number(7.0)), Some(Number(1.0)));
        assert_eq!(wanted(Takes::Level, Nothing), None);
        assert_eq!(wanted(Takes::Number, Number(128.0)), Some(Number(128.0)));
        assert_eq!(wanted(Takes::Choice, text()), Some(text()));
        for takes in [Takes::Press, Takes::Switch, Takes::Level, Takes::Number, Takes::Choice] {
            assert_eq!(wanted(takes, Number(f32::NAN)), None, "{takes:?}");
        }
    }
}
