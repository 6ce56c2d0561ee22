//! The meaning of OSC messages by their addresses.

use regex_lite::Regex;
use rosc::{OscMessage, OscType};

use crate::action::{Action, ActionRow, ActionValue, ValueType, row_of};
use crate::{Amount, ChangedBy, InputQueue, ParamChange, limits};

/// The request in a message.
#[derive(Debug, Clone, PartialEq)]
pub enum Asked {
    /// Change a parameter.
    Turn(ParamChange),
    /// Run an action.
    Act(Action),
    /// Answer a query.
    Tell(Query),
    /// Do nothing: a button was released, or the action ignores this number.
    Nothing,
}

impl Asked {
    /// Returns the request to run an action with this value.
    ///
    /// # Errors
    /// [`Refused`] if the action does not take this kind of value.
    pub fn of(row: ActionRow, given: ActionValue) -> Result<Self, Refused> {
        let is_let_go = matches!(given, ActionValue::Number(_));
        match row.wanted(given) {
            Some(action) => Ok(Self::Act(action)),
            None if is_let_go => Ok(Self::Nothing),
            None => Err(Refused),
        }
    }

    /// Queues the request in a message, or counts its refusal. Returns the query that the message asks.
    pub fn queue(asked: Result<Self, Refused>, input: &InputQueue) -> Option<Query> {
        match asked {
            Ok(Self::Turn(change)) => input.turn(change),
            Ok(Self::Act(action)) => input.act(action),
            Ok(Self::Tell(query)) => return Some(query),
            Ok(Self::Nothing) => {}
            Err(Refused) => input.refuse(1),
        }
        None
    }
}

/// A query for the state of the show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Query {
    /// The scene, the tempo, all parameters and all switches.
    All,
    /// All parameters of the current scene.
    Params,
    /// One parameter.
    Param(String),
    /// The current scene.
    Scene,
    /// The titles of all scenes.
    Scenes,
    /// The tempo.
    Tempo,
    /// All actions with their help texts.
    Actions,
    /// The state of a switch.
    Switch(&'static str),
}

/// The refusal of a message that is malformed or unknown, or has a value that is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refused;

/// The documentation of an address that is not an action: the address, the arguments and the help text.
pub type FixedAddress = (&'static str, &'static str, &'static str);

/// Returns the addresses that are not actions, with their arguments and help texts.
pub fn fixed_addresses() -> &'static [FixedAddress] {
    &[
        ("/param/NAME", "value [seconds]", "sets a parameter of the current scene, in the parameter's unit"),
        ("/param/NAME", "", "asks for its value"),
        ("/share/NAME", "0..1 [seconds]", "sets it to a fraction of its range, like a fader"),
        ("/scene/NAME", "", "shows the scene with this title"),
        ("/scene", "", "asks for the current scene"),
        ("/tempo", "", "asks for the tempo"),
        ("/query", "", "asks for the scene, the tempo, the switches and all parameters"),
        ("/query/params", "", "asks for all parameters"),
        ("/query/scene", "", "asks for the current scene"),
        ("/query/scenes", "", "asks for the titles of all scenes"),
        ("/query/tempo", "", "asks for the tempo"),
        ("/query/actions", "", "asks for all actions with their descriptions"),
        ("/query/SWITCH", "", "asks for the state of a switch"),
    ]
}

/// Returns the request in a message, given the table of actions.
///
/// # Errors
/// [`Refused`] if the address is unknown, or a value is not a number.
pub fn understand(message: &OscMessage, actions: &[ActionRow]) -> Result<Asked, Refused> {
    let address = message.addr.strip_prefix('/').ok_or(Refused)?;
    if address.len() > limits::NAME_BYTES_MAX {
        return Err(Refused);
    }
    let mut parts = address.splitn(2, '/');
    let (room, name) = (parts.next().unwrap_or_default(), parts.next().filter(|name| !name.is_empty()));
    let given = |place| message.args.get(place).map(given).transpose();
    let number = |place| given(place)?.map(number_in).transpose();
    match (room, name) {
        ("param" | "share", Some(name)) => match number(0)? {
            None => Ok(Asked::Tell(Query::Param(name.to_owned()))),
            Some(ActionValue::Number(to)) => {
                let seconds = match number(1)? {
                    Some(ActionValue::Number(seconds)) => seconds,
                    Some(ActionValue::Text(_)) => return Err(Refused),
                    Some(ActionValue::Nothing) | None => 0.0,
                };
                let to = if room == "param" { Amount::Value(to) } else { Amount::Fraction(to) };
                Ok(Asked::Turn(ParamChange {
                    name: name.to_owned(),
                    to,
                    seconds,
                    changed_by: ChangedBy::Osc,
                }))
            }
            Some(_) => Err(Refused),
        },
        ("query", None) => Ok(Asked::Tell(Query::All)),
        ("query", Some("params")) => Ok(Asked::Tell(Query::Params)),
        ("query", Some("scene")) | ("scene", None) if message.args.is_empty() => {
            Ok(Asked::Tell(Query::Scene))
        }
        ("query", Some("scenes")) => Ok(Asked::Tell(Query::Scenes)),
        ("query", Some("tempo")) | ("tempo", None) if message.args.is_empty() => {
            Ok(Asked::Tell(Query::Tempo))
        }
        ("query", Some("actions")) => Ok(Asked::Tell(Query::Actions)),
        ("query", Some(name)) => {
            let row = row_of(actions, name).filter(|row| row.takes == ValueType::Switch);
            row.map(|row| Asked::Tell(Query::Switch(row.name))).ok_or(Refused)
        }
        ("scene", Some(name)) => {
            let row = row_of(actions, "scene").ok_or(Refused)?;
            // Pads send a nonzero value when pressed, and 0 when released.
            if matches!(number(0)?, Some(ActionValue::Number(number)) if number <= 0.0) {
                return Ok(Asked::Nothing);
            }
            row.wanted(ActionValue::Text(name.to_owned())).map(Asked::Act).ok_or(Refused)
        }
        (name, None) => {
            let row = row_of(actions, name).ok_or(Refused)?;
            // A text is the name of a choice, and otherwise a number.
            let given = if row.takes == ValueType::Choice { given(0)? } else { number(0)? };
            Asked::of(row, given.unwrap_or_default())
        }
        _ => Err(Refused),
    }
}

fn number(number: f32) -> Result<ActionValue, Refused> {
    if number.is_finite() { Ok(ActionValue::Number(number)) } else { Err(Refused) }
}

/// Returns the number in a text such as " 0.5 ". Any other text stays a text.
fn number_in(given: ActionValue) -> Result<ActionValue, Refused> {
    match &given {
        ActionValue::Text(text) => text.trim().parse().map_or(Ok(given.clone()), number),
        ActionValue::Number(_) | ActionValue::Nothing => Ok(given),
    }
}

fn given(argument: &OscType) -> Result<ActionValue, Refused> {
    match argument {
        OscType::Int(value) => number(*value as f32),
        OscType::Float(value) => number(*value),
        OscType::Long(value) => number(*value as f32),
        OscType::Double(value) => number(*value as f32),
        OscType::Bool(value) => number(f32::from(u8::from(*value))),
        OscType::Nil => Ok(ActionValue::Nothing),
        OscType::String(text) if text.len() <= limits::NAME_BYTES_MAX => Ok(ActionValue::Text(text.clone())),
        _ => Err(Refused),
    }
}

/// An address pattern of OSC 1.0: `?` matches one character, `*` any number, `[a-z]` one of a set, `[!a]` one outside a
/// set, `{one,two}` one of several words. No pattern character matches a slash. Matching never backtracks.
#[derive(Debug, Clone)]
pub struct Pattern {
    expression: Regex,
    /// An address with other slashes than the pattern's own ones does not match.
    slashes: usize,
}

/// True if an address contains pattern characters.
pub fn is_pattern(address: &str) -> bool {
    address.contains(['?', '*', '[', '{'])
}

impl Pattern {
    /// Parses a pattern. Returns `None` if the pattern is too long or malformed: an unclosed bracket or brace, an empty
    /// set, a range that goes down, or two hyphens in a row in a set.
    pub fn read(text: &str) -> Option<Self> {
        if text.len() > limits::NAME_BYTES_MAX {
            return None;
        }
        let mut expression = "(?s)^".to_owned();
        let (mut rest, mut slashes) = (text, 0);
        while let Some(sign) = rest.chars().next() {
            rest = rest.get(sign.len_utf8()..)?;
            match sign {
                '?' => expression.push('.'),
                '*' => expression.push_str(".*"),
                '[' => {
                    let (set, behind) = rest.split_once(']')?;
                    let (not, set) = set.strip_prefix('!').map_or(("", set), |set| ("^", set));
                    // A hyphen makes a range, or is a literal character at an end.
                    let set = regex_lite::escape(set).replace(r"\-", "-");
                    expression.push_str(&format!("[{not}{set}]"));
                    rest = behind;
                }
                '{' => {
                    let (words, behind) = rest.split_once('}')?;
                    let words: Vec<String> = words.split(',').map(regex_lite::escape).collect();
                    expression.push_str(&format!("(?:{})", words.join("|")));
                    rest = behind;
                }
                sign => {
                    slashes += usize::from(sign == '/');
                    expression.push_str(&regex_lite::escape(sign.encode_utf8(&mut [0; 4])));
                }
            }
        }
        Some(Self { expression: Regex::new(&(expression + "$")).ok()?, slashes })
    }

    /// True if the pattern matches the whole address.
    pub fn matches(&self, address: &str) -> bool {
        address.matches('/').count() == self.slashes && self.expression.is_match(address)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACTIONS: &[ActionRow] = &[
        ActionRow { name: "next", takes: ValueType::Press, meaning: "the next scene" },
        ActionRow { name: "pause", takes: ValueType::Switch, meaning: "pause" },
        ActionRow { name: "scene", takes: ValueType::Choice, meaning: "a scene" },
        ActionRow { name: "tempo", takes: ValueType::Number, meaning: "a tempo" },
    ];

    fn parse_query(addr: &str, args: &[OscType]) -> Result<Asked, Refused> {
        understand(&OscMessage { addr: addr.to_owned(), args: args.to_vec() }, ACTIONS)
    }

    fn turn(to: Amount, seconds: f32) -> Result<Asked, Refused> {
        Ok(Asked::Turn(ParamChange { name: "size".to_owned(), to, seconds, changed_by: ChangedBy::Osc }))
    }

    fn act(name: &'static str, given: ActionValue) -> Result<Asked, Refused> {
        Ok(Asked::Act(Action { name, given }))
    }

    #[test]
    fn parameters_take_values_and_fractions_of_any_number_type() {
        use OscType::{Bool, Double, Float, Int, Long};
        for one in [Float(1.0), Double(1.0), Int(1), Long(1), Bool(true)] {
            assert_eq!(parse_query("/param/size", std::slice::from_ref(&one)), turn(Amount::Value(1.0), 0.0));
            assert_eq!(parse_query("/share/size", &[one, Float(0.5)]), turn(Amount::Fraction(1.0), 0.5));
        }
        assert_eq!(parse_query("/param/size", &[]), Ok(Asked::Tell(Query::Param("size".to_owned()))));
        for rubbish in [Float(f32::NAN), Float(f32::INFINITY), Double(1e300)] {
            assert_eq!(parse_query("/param/size", std::slice::from_ref(&rubbish)), Err(Refused));
            assert_eq!(parse_query("/param/size", &[Float(1.0), rubbish]), Err(Refused));
        }
    }

    #[test]
    fn texts_are_numbers_where_numbers_are_expected() {
        let text = |text: &str| OscType::String(text.to_owned());
        for half in ["0.5", " 0.5 ", ".5", "5e-1", "+0.50\n"] {
            assert_eq!(parse_query("/param/size", &[text(half)]), turn(Amount::Value(0.5), 0.0), "{half}");
            assert_eq!(
                parse_query("/share/size", &[text("1"), text(half)]),
                turn(Amount::Fraction(1.0), 0.5)
            );
            assert_eq!(parse_query("/tempo", &[text(half)]), act("tempo", ActionValue::Number(0.5)));
        }
        for other in ["abc", "", " ", "0,5", "0.5 s", "0x1"] {
            assert_eq!(parse_query("/param/size", &[text(other)]), Err(Refused), "{other}");
            assert_eq!(parse_query("/param/size", &[OscType::Int(1), text(other)]), Err(Refused), "{other}");
            assert_eq!(parse_query("/tempo", &[text(other)]), Err(Refused), "{other}");
        }
        for rubbish in ["NaN", "inf", "-infinity", "1e300"] {
            assert_eq!(parse_query("/param/size", &[text(rubbish)]), Err(Refused), "{rubbish}");
            assert_eq!(parse_query("/share/size", &[OscType::Int(1), text(rubbish)]), Err(Refused));
            assert_eq!(parse_query("/tempo", &[text(rubbish)]), Err(Refused), "{rubbish}");
        }
        assert_eq!(parse_query("/pause", &[text("0")]), act("pause", ActionValue::Number(0.0)));
        assert_eq!(parse_query("/next", &[text("0")]), Ok(Asked::Nothing));
        assert_eq!(parse_query("/scene/orb", &[text("0")]), Ok(Asked::Nothing));
        // A scene may have a number as its name.
        assert_eq!(parse_query("/scene", &[text("3")]), act("scene", ActionValue::Text("3".to_owned())));
    }

    #[test]
    fn actions_are_addresses_and_released_buttons_do_nothing() {
        assert_eq!(parse_query("/next", &[]), act("next", ActionValue::Nothing));
        assert_eq!(parse_query("/next", &[OscType::Float(1.0)]), act("next", ActionValue::Nothing));
        assert_eq!(parse_query("/next", &[OscType::Float(0.0)]), Ok(Asked::Nothing));
        assert_eq!(parse_query("/pause", &[OscType::Int(0)]), act("pause", ActionValue::Number(0.0)));
        assert_eq!(parse_query("/tempo", &[OscType::Float(128.0)]), act("tempo", ActionValue::Number(128.0)));
        assert_eq!(parse_query("/scene/orb", &[]), act("scene", ActionValue::Text("orb".to_owned())));
        assert_eq!(parse_query("/scene/orb", &[OscType::Float(0.0)]), Ok(Asked::Nothing));
        assert_eq!(parse_query("/scene", &[OscType::Int(3)]), act("scene", ActionValue::Number(3.0)));
        let name = OscType::String("orb".to_owned());
        assert_eq!(parse_query("/scene", &[name]), act("scene", ActionValue::Text("orb".to_owned())));
    }

    #[test]
    fn questions_are_addresses_without_arguments() {
        assert_eq!(parse_query("/scene", &[]), Ok(Asked::Tell(Query::Scene)));
        assert_eq!(parse_query("/tempo", &[]), Ok(Asked::Tell(Query::Tempo)));
        assert_eq!(parse_query("/query", &[]), Ok(Asked::Tell(Query::All)));
        assert_eq!(parse_query("/query/pause", &[]), Ok(Asked::Tell(Query::Switch("pause"))));
        for (address, ..) in fixed_addresses() {
            let address = address.replace("SWITCH", "pause");
            assert!(parse_query(&address, &[]).is_ok(), "{address}");
        }
    }

    #[test]
    fn unknown_messages_are_refused() {
        let long = format!("/param/{}", "x".repeat(limits::NAME_BYTES_MAX));
        for address in
            ["", "next", "/", "//", "/nothing", "/next/next", "/query/next", "/param", "/param/", &long]
        {
            assert_eq!(parse_query(address, &[]), Err(Refused), "{address}");
        }
        let long = OscType::String("x".repeat(limits::NAME_BYTES_MAX + 1));
        assert_eq!(parse_query("/scene", &[long]), Err(Refused));
        assert_eq!(parse_query("/pause", &[OscType::String("on".to_owned())]), Err(Refused));
    }
}

#[cfg(test)]
mod pattern_tests {
    use proptest::prelude::*;

    use super::*;

    fn matches(pattern: &str, address: &str) -> bool {
        Pattern::read(pattern).unwrap().matches(address)
    }

    #[test]
    fn each_pattern_character_matches_as_specified() {
        for (pattern, fits, fits_not) in [
            ("/a?c", ["/abc", "/axc"], ["/ac", "/a/c"]),
            ("/param/*", ["/param/size", "/param/"], ["/param/a/b", "/params/x"]),
            ("/*/*", ["/a/b", "/param/size"], ["/a", "/a/b/c"]),
            ("/[a-c]x", ["/ax", "/cx"], ["/dx", "/x"]),
            ("/[a-c-]x", ["/bx", "/-x"], ["/dx", "//x"]),
            ("/[+-:]x", ["/+x", "/5x"], ["//x", "/;x"]),
            ("/{.,}x?", ["/.xy", "/xy"], ["/axy", "/x"]),
            ("/[!a-c]x", ["/dx", "/-x"], ["/ax", "//x"]),
            ("/{next,previous}", ["/next", "/previous"], ["/nex", "/next,previous"]),
            ("/{a,ab}c*d", ["/abcd", "/acxxd"], ["/abd", "/abbcd"]),
            ("/b**nd", ["/band", "/bnd"], ["/bandx", "/b/nd"]),
            ("/größ?", ["/größe", "/größß"], ["/größ", "/grösse"]),
        ] {
            assert!(is_pattern(pattern));
            assert!(fits.iter().all(|address| matches(pattern, address)), "{pattern}");
            assert!(!fits_not.iter().any(|address| matches(pattern, address)), "{pattern}");
        }
    }

    #[test]
    fn malformed_and_oversized_patterns_are_rejected() {
        for broken in ["/[a", "/{a,b", "/a[", "/[]", "/[c-a]", &"*?".repeat(limits::NAME_BYTES_MAX / 2 + 1)] {
            assert!(Pattern::read(broken).is_none(), "{broken}");
        }
        assert!(Pattern::read(&"*?".repeat(limits::NAME_BYTES_MAX / 2)).is_some());
    }

    /// A pattern with exponential cost in a backtracking matcher.
    #[test]
    fn matching_never_backtracks() {
        let pattern = Pattern::read(&"*a".repeat(limits::NAME_BYTES_MAX / 2)).unwrap();
        assert!(!pattern.matches(&"a".repeat(limits::NAME_BYTES_MAX / 2 - 1)));
        assert!(pattern.matches(&"a".repeat(limits::NAME_BYTES_MAX)));
    }

    proptest! {
        #[test]
        fn an_address_without_pattern_characters_matches_itself(address in "[a-z/]{0,12}", other in "[a-z/]{0,12}") {
            prop_assert_eq!(matches(&address, &other), address == other);
        }

        #[test]
        fn any_pattern_matches_without_panic(pattern in "[a-c/?*\\[\\]{},!-]{0,24}", address in "[a-c/]{0,12}") {
            if let Some(pattern) = Pattern::read(&pattern) {
                let _ = pattern.matches(&address);
            }
        }
    }
}
