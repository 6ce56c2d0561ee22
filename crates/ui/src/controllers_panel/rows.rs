//! Makes the rows of the panel from the state of the controllers.

use super::{ControllerRow, ControllersState};
use mariana_commands as commands;
use mariana_control::action::ValueType;
use mariana_control::midi::{Mapping, Target};
use mariana_remote::RemoteState;

pub(super) fn rows_of(facts: &ControllersState<'_>) -> Vec<ControllerRow> {
    let words = |text: String| ControllerRow::Words { text, is_bad: false };
    let osc = facts.osc.as_deref().unwrap_or("off; start Mariana with --osc 9000");
    // Put the connection code first, so that it can be scanned as soon as the panel opens.
    let mut rows = Vec::from_iter(pairing_address(facts));
    rows.push(words(format!("OSC: {osc}")));
    rows.extend(phone_words(facts));
    rows.extend(midi_words(facts));
    rows.extend(count_words(facts).map(words));
    if facts.midi.as_ref().is_some_and(|midi| midi.trouble.is_none()) {
        rows.push(ControllerRow::Clock(facts.clock));
    }
    let mut is_shown = vec![false; facts.mappings.len()];
    let mut add = |rows: &mut Vec<ControllerRow>, target: Target, name: String, about: &str, stands| {
        let learns = facts.learning == Some(&target);
        let about = (if learns { "move a knob, or press a key or a pad" } else { about }).to_owned();
        rows.push(ControllerRow::Target { target: target.clone(), name, about, learns });
        let mapped = facts.mappings.iter().zip(&mut is_shown).filter(|(one, _)| one.target == target);
        rows.extend(mapped.map(|(mapping, is_shown)| {
            *is_shown = true;
            ControllerRow::Knob { mapping: mapping.clone(), words: knob_words(mapping, facts), stands }
        }));
    };
    if !facts.sliders.is_empty() {
        rows.push(words(format!("Parameters of {}", facts.scene)));
    }
    for slider in facts.sliders {
        let target = Target::Param { scene: facts.scene.clone(), name: slider.name.clone() };
        let about = format!("{} · {}", slider.value_text(), slider.changed_by.name());
        add(&mut rows, target, slider.name.clone(), &about, Some(slider.param().fraction_of(slider.value)));
    }
    rows.push(words("Actions".to_owned()));
    for row in commands::for_controllers() {
        let action = |value: Option<String>| Target::Action { name: row.name.to_owned(), value };
        if row.takes == ValueType::Choice {
            let here = action(Some(facts.scene.clone()));
            let name = format!("{} {}", row.name, facts.scene);
            add(&mut rows, here, name, "show this scene with a pad", None);
            add(&mut rows, action(None), "scenes".to_owned(), "choose a scene by program change", None);
        } else if let ValueType::Index(most) = row.takes {
            for number in (1..=most).map(|number| number.to_string()) {
                let name = format!("{} {number}", row.name.replace('_', " "));
                add(&mut rows, action(Some(number)), name, row.meaning, None);
            }
        } else {
            add(&mut rows, action(None), row.name.replace('_', " "), row.meaning, None);
        }
    }
    let others: Vec<&Mapping> =
        facts.mappings.iter().zip(&is_shown).filter(|(_, shown)| !**shown).map(|(one, _)| one).collect();
    if !others.is_empty() {
        rows.push(words("In other scenes".to_owned()));
    }
    rows.extend(others.into_iter().map(|mapping| ControllerRow::Knob {
        mapping: mapping.clone(),
        words: format!("{} · {}", words_of(&mapping.target), knob_words(mapping, facts)),
        stands: None,
    }));
    rows
}

fn pairing_address(facts: &ControllersState<'_>) -> Option<ControllerRow> {
    let phone = facts.phone.as_ref()?;
    let RemoteState::Open(pairing_address) = &phone.state else { return None };
    let about = match (phone.phones, pairing_address.is_local) {
        (0, true) => "Only this computer can connect: it is not on a network.".to_owned(),
        (0, false) => "The phone must be on the same network.".to_owned(),
        (1, _) => "One phone is connected.".to_owned(),
        (count, _) => format!("{count} phones are connected."),
    };
    Some(ControllerRow::Phone { pairing_address: pairing_address.clone(), about })
}

fn phone_words(facts: &ControllersState<'_>) -> Option<ControllerRow> {
    let (text, is_bad) = match facts.phone.as_ref().map(|phone| &phone.state) {
        None => ("Phone: off; start Mariana with --remote 8080".to_owned(), false),
        Some(RemoteState::Opening) => ("Phone: opening the port".to_owned(), false),
        Some(RemoteState::Refused(why)) => (format!("Phone: {why}"), true),
        Some(RemoteState::Open(_)) => return None,
    };
    Some(ControllerRow::Words { text, is_bad })
}

fn count_words(facts: &ControllersState<'_>) -> Option<String> {
    match facts.counts {
        (0, 0) => None,
        (messages, 0) => Some(format!("{messages} messages received")),
        (messages, ignored) => Some(format!("{messages} messages received, {ignored} of them ignored")),
    }
}

fn midi_words(facts: &ControllersState<'_>) -> Vec<ControllerRow> {
    let words = |text: String, is_bad| ControllerRow::Words { text, is_bad };
    let Some(midi) = &facts.midi else { return vec![words("MIDI: off (--midi off)".to_owned(), false)] };
    if let Some(trouble) = &midi.trouble {
        return vec![words(format!("MIDI: {trouble}"), true)];
    }
    let devices = match &midi.devices[..] {
        [] if !midi.is_known => "looking for devices".to_owned(),
        [] => "no device found; plug one in".to_owned(),
        devices => devices.join(", "),
    };
    let mut rows = vec![words(format!("MIDI: {devices}"), false)];
    rows.extend(
        midi.refused.iter().map(|(name, why)| words(format!("cannot listen to {name}: {why}"), true)),
    );
    if let (Some(device), Some(tempo)) = (&midi.clock_of, facts.clock_tempo) {
        rows.push(words(format!("Clock of {device}: {tempo:.1} beats per minute"), false));
    }
    rows
}

fn knob_words(mapping: &Mapping, facts: &ControllersState<'_>) -> String {
    let devices = facts.midi.as_ref().map(|midi| &midi.devices[..]).unwrap_or_default();
    let gone = if devices.contains(&mapping.device) { "" } else { " (not connected)" };
    format!("{} of {}{gone}", mapping.source, mapping.device)
}

/// The display name of a target.
pub fn words_of(target: &Target) -> String {
    match target {
        Target::Param { scene, name } => format!("{name} in {scene}"),
        Target::Action { name, value: None } => name.replace('_', " "),
        Target::Action { name, value: Some(value) } => format!("{} {value}", name.replace('_', " ")),
    }
}
