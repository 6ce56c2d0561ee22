//! The actions that controllers can trigger: a table of stable names that the program provides.

/// The kind of value of an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueType {
    /// No value: the action runs when a button is pressed.
    Press,
    /// On or off. Without a value, the switch toggles.
    Switch,
    /// A number from 0 to 1.
    Level,
    /// A number in the action's unit, or no value.
    Number,
    /// A name, or a number counted from 1.
    Choice,
    /// A number from 1; the field is the number of pads that are offered for it.
    Index(u8),
}

/// An action in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ActionRow {
    /// The name in OSC addresses and files: lower-case letters and underscores. The name never changes.
    pub name: &'static str,
    /// The kind of value.
    pub takes: ValueType,
    /// The help text, without a capital letter or a full stop.
    pub meaning: &'static str,
}

/// The value sent with an action.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ActionValue {
    /// No value.
    #[default]
    Nothing,
    /// A finite number.
    Number(f32),
    /// A name.
    Text(String),
}

/// An action requested by a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Action {
    /// The name in the table.
    pub name: &'static str,
    /// The value.
    pub given: ActionValue,
}

/// Returns the row with this name.
pub fn row_of(table: &[ActionRow], name: &str) -> Option<ActionRow> {
    table.iter().find(|row| row.name == name).copied()
}

impl ActionRow {
    /// Returns the action for this value, or `None` if a button is released or the value has the wrong kind.
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
            (ValueType::Level | ValueType::Choice | ValueType::Index(_), ActionValue::Nothing) => None,
            (ValueType::Switch | ValueType::Number | ValueType::Choice | ValueType::Index(_), given) => {
                action(given)
            }
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
    fn actions_accept_only_fitting_values() {
        use ActionValue::{Nothing, Number, Text};
        let text = || Text("orb".to_owned());
        assert_eq!(wanted(ValueType::Press, Nothing), Some(Nothing));
        assert_eq!(wanted(ValueType::Press, Number(1.0)), Some(Nothing));
        assert_eq!(wanted(ValueType::Press, Number(0.0)), None, "a released button does nothing");
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
