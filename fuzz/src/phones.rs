//! Network input of the page for phones: request heads and messages.

use mariana_control::osc::Asked;
use mariana_remote::http::Head;
use mariana_remote::limits::LIMITS;
use mariana_remote::message::understand;

use super::bytes::Bytes;
use super::control::{ACTIONS, check_act, check_turn};

pub(crate) fn phones(data: &[u8]) {
    let mut bytes = Bytes(data);
    match bytes.below(2) {
        0 => head(bytes.0),
        _ => message(&String::from_utf8_lossy(bytes.0)),
    }
}

fn head(bytes: &[u8]) {
    let Ok(Some(head)) = Head::parse(bytes, LIMITS.head.fields_max) else { return };
    assert!((1..=bytes.len()).contains(&head.length), "{head:?}");
    // Bytes after the head must have no effect. A head without its last byte must be incomplete.
    let whole = Head::parse(&bytes[..head.length], LIMITS.head.fields_max);
    assert_eq!(whole, Ok(Some(head.clone())));
    assert_eq!(Head::parse(&bytes[..head.length - 1], LIMITS.head.fields_max), Ok(None));
    for text in [&*head.method, &*head.path] {
        assert!(!text.is_empty() && !text.contains(['\r', '\n', ' ']), "{text:?}");
    }
    for name in ["host", "origin", "sec-websocket-key"] {
        let value = head.field(name);
        assert!(value.is_none() || head.has(name));
        // The answer repeats the host in a line, so the host must not contain a line break.
        assert!(value.is_none_or(|value| !value.contains(['\r', '\n'])), "{value:?}");
    }
}

fn message(text: &str) {
    match understand(text, ACTIONS) {
        Ok(Asked::Turn(change)) => check_turn(&change),
        Ok(Asked::Act(action)) => check_act(&action),
        Ok(Asked::Tell(_) | Asked::Nothing) | Err(_) => {}
    }
}
