//! The messages of phones: small JSON texts with the same meaning as OSC messages and keys.
//!
//! ```text
//! {"turn": "size", "to": 1.5}      sets a parameter of the current scene, in the parameter's unit
//! {"do": "next"}                   runs an action, with a number, a boolean or a name if it takes one:
//! {"do": "pause", "with": true}    {"do": "volume", "with": 0.8}    {"do": "scene", "with": "orb"}
//! ```

use mariana_control::action::{ActionRow, ActionValue, row_of};
use mariana_control::limits as control_limits;
use mariana_control::osc::{Asked, Refused};
use mariana_control::{Amount, ChangedBy, ParamChange};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
#[serde(untagged, deny_unknown_fields)]
enum Message {
    Turn { turn: String, to: f64 },
    Do { r#do: String, with: Option<Value> },
}

/// Returns the request in a message, given the table of actions.
///
/// # Errors
/// Fails if the text is malformed, the action is unknown, or a value is too large.
pub fn understand(text: &str, actions: &[ActionRow]) -> Result<Asked, Refused> {
    match serde_json::from_str(text).map_err(|_| Refused)? {
        Message::Turn { turn: name, to } => {
            let to = Amount::Value(to as f32);
            if name.len() > control_limits::NAME_BYTES_MAX || !to.is_number() {
                return Err(Refused);
            }
            Ok(Asked::Turn(ParamChange { name, to, seconds: 0.0, changed_by: ChangedBy::Phone }))
        }
        Message::Do { r#do: name, with } => {
            let row = row_of(actions, &name).ok_or(Refused)?;
            let given = match with {
                None => ActionValue::Nothing,
                Some(Value::Bool(on)) => ActionValue::Number(f32::from(u8::from(on))),
                Some(Value::Number(number)) => {
                    let number = number.as_f64().map(|number| number as f32);
                    ActionValue::Number(number.filter(|number| number.is_finite()).ok_or(Refused)?)
                }
                Some(Value::String(text)) if text.len() <= control_limits::NAME_BYTES_MAX => {
                    ActionValue::Text(text)
                }
                Some(_) => return Err(Refused),
            };
            Asked::of(row, given)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mariana_control::action::{Action, ValueType};

    const ACTIONS: &[ActionRow] = &[
        ActionRow { name: "next", takes: ValueType::Press, meaning: "the next scene" },
        ActionRow { name: "pause", takes: ValueType::Switch, meaning: "pause" },
        ActionRow { name: "scene", takes: ValueType::Choice, meaning: "a scene" },
        ActionRow { name: "volume", takes: ValueType::Level, meaning: "a volume" },
    ];

    fn parse_request(text: &str) -> Result<Asked, Refused> {
        understand(text, ACTIONS)
    }

    fn act(name: &'static str, given: ActionValue) -> Result<Asked, Refused> {
        Ok(Asked::Act(Action { name, given }))
    }

    #[test]
    fn sliders_and_actions_are_understood() {
        let change = ParamChange {
            name: "größe".to_owned(),
            to: Amount::Value(1.5),
            seconds: 0.0,
            changed_by: ChangedBy::Phone,
        };
        assert_eq!(parse_request(r#"{"turn":"größe","to":1.5}"#), Ok(Asked::Turn(change)));
        assert_eq!(parse_request(r#"{"do":"next"}"#), act("next", ActionValue::Nothing));
        assert_eq!(parse_request(r#"{"do":"next","with":0}"#), Ok(Asked::Nothing));
        assert_eq!(parse_request(r#"{"do":"pause","with":true}"#), act("pause", ActionValue::Number(1.0)));
        assert_eq!(parse_request(r#"{"do":"pause","with":null}"#), act("pause", ActionValue::Nothing));
        assert_eq!(parse_request(r#"{"do":"volume","with":7}"#), act("volume", ActionValue::Number(1.0)));
        assert_eq!(parse_request(r#"{"do":"volume","with":-1e9}"#), act("volume", ActionValue::Number(0.0)));
        assert_eq!(
            parse_request(r#"{"do":"scene","with":"orb"}"#),
            act("scene", ActionValue::Text("orb".to_owned()))
        );
    }

    #[test]
    fn malformed_messages_are_rejected() {
        for text in [
            "",
            "{",
            "null",
            "[]",
            "7",
            "\"next\"",
            "{}",
            r#"{"turn":"x"}"#,
            r#"{"turn":"x","to":NaN}"#,
            r#"{"turn":"x","to":Infinity}"#,
            r#"{"turn":"x","to":1e999}"#,
            r#"{"turn":"x","to":null}"#,
            r#"{"turn":"x","to":"1"}"#,
            r#"{"turn":"x","to":1,"path":"/etc/passwd"}"#,
            r#"{"turn":"x","to":1,"do":"next"}"#,
            r#"{"do":"next","with":[1]}"#,
            r#"{"do":7}"#,
            &"[".repeat(1_000),
        ] {
            assert_eq!(parse_request(text), Err(Refused), "{text:.60}");
        }
    }

    #[test]
    fn oversized_and_unknown_messages_are_rejected() {
        assert_eq!(parse_request(r#"{"turn":"x","to":1e300}"#), Err(Refused));
        assert_eq!(parse_request(r#"{"do":"volume","with":-1e300}"#), Err(Refused));
        let long = "x".repeat(control_limits::NAME_BYTES_MAX + 1);
        assert_eq!(parse_request(&format!(r#"{{"turn":"{long}","to":1}}"#)), Err(Refused));
        assert_eq!(parse_request(&format!(r#"{{"do":"scene","with":"{long}"}}"#)), Err(Refused));
        for text in
            [r#"{"do":"quit"}"#, r#"{"do":""}"#, r#"{"do":"volume"}"#, r#"{"do":"pause","with":"on"}"#]
        {
            assert_eq!(parse_request(text), Err(Refused), "{text}");
        }
    }
}
