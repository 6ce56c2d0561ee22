//! What hands can do besides turning parameters: a table of the program's, by stable names.

/// What an action takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueType {
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
pub struct ActionRow {
    /// Its name in OSC addresses and in files, of small letters and underlines; it never changes.
    pub name: &'static str,
    /// What it takes.
    pub takes: ValueType,
    /// What it does, as the end of a sentence.
    pub meaning: &'static str,
}

/// What comes with an action.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ActionValue {
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
pub struct Action {
    /// The name of its row.
    pub name: &'static str,
    /// What came with it.
    pub given: ActionValue,
}

/// The row of this name.
pub fn row_of(table: &[ActionRow], name: &str) -> Option<ActionRow> {
    table.iter().find(|row| row.name == name).copied()
}

impl ActionRow {
    /// What it means that something came with it; none if it is to be left, because a button was let go or because it
    /// is not what the action takes.
    pub fn wanted(self, given: ActionValue) -> Option<Action> {
        let action = |given| Some(Action { name: self.name, given });
        match (self.takes, given) {
            (_, ActionValue::Number(number)) if !number.is_finite() => None,
            (ValueType::Press, ActionValue::Number(number)) if number <= 0.0 => None,
            (ValueType::Press, _) => action(ActionValue::Nothing),
            (ValueType::Switch | ValueType::Level | ValueType::Number, ActionValue::Text(_)) => None,
            (ValueType::Level, ActionValue::Number(number)) => {
                action(ActionValue::Number(number.clamp(0.0, 1.0)))
            }
            (ValueType::Level | ValueType::Choice, ActionValue::Nothing) => None,
            (ValueType::Switch | ValueType::Number | ValueType::Choice, given) => action(given),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wanted(takes: ValueType, given: ActionValue) -> Option<ActionValue> {
        ActionRow { name: "x", takes, meaning: "" }.wanted(given).map(|action| action.given)
    }

    #[test]
    fn actions_take_what_they_can_use_and_leave_the_rest() {
        use ActionValue::{Nothing, Number, Text};
        let text = || Text("orb".to_owned());
        assert_eq!(wanted(ValueType::Press, Nothing), Some(Nothing));
        assert_eq!(wanted(ValueType::Press, Number(1.0)), Some(Nothing));
        assert_eq!(wanted(ValueType::Press, Number(0.0)), None, "the button is let go");
        assert_eq!(wanted(ValueType::Switch, Number(0.0)), Some(Number(0.0)));
        assert_eq!(wanted(ValueType::Switch, Nothing), Some(Nothing));
        assert_eq!(wanted(ValueType::Switch, text()), None);
        assert_eq!(wanted(ValueType::Level, Number(7.0)), Some(Number(1.0)));
        assert_eq!(wanted(ValueType::Level, Nothing), None);
        assert_eq!(wanted(ValueType::Number, Number(128.0)), Some(Number(128.0)));
        assert_eq!(wanted(ValueType::Choice, text()), Some(text()));
        for takes in
            [ValueType::Press, ValueType::Switch, ValueType::Level, ValueType::Number, ValueType::Choice]
        {
            assert_eq!(wanted(takes, Number(f32::NAN)), None, "{takes:?}");
        }
    }
}
