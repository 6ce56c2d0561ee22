//! MIDI input ports: the system's ports, or a replacement for tests.

use std::any::Any;

use midir::{Ignore, MidiInput};

/// The callback for a device's bytes. It runs on the port's thread.
pub type Hear = Box<dyn FnMut(&[u8]) + Send>;

/// Ports that can be listed and opened. Every call may block, so the hub calls them on its own thread.
pub trait Ports: Send {
    /// Returns the names of the connected devices, without duplicates.
    ///
    /// # Errors
    /// Fails with the reason why this machine has no MIDI, without a capital letter or a full stop.
    fn names(&mut self) -> Result<Vec<String>, String>;

    /// Opens a device until the result is dropped.
    ///
    /// # Errors
    /// Fails with the reason why the device cannot be opened.
    fn open(&mut self, name: &str, hear: Hear) -> Result<Box<dyn Any>, String>;
}

const CLIENT: &str = "Mariana";

/// The ports of the system: ALSA sequencer, CoreMIDI or WinMM.
#[derive(Default)]
pub struct SystemPorts;

impl SystemPorts {
    fn input() -> Result<MidiInput, String> {
        let mut input = MidiInput::new(CLIENT).map_err(|error| error.to_string())?;
        input.ignore(Ignore::SysexAndActiveSense);
        Ok(input)
    }
}

impl Ports for SystemPorts {
    fn names(&mut self) -> Result<Vec<String>, String> {
        // The kernel makes the sequencer for the first device. Without it, ALSA prints errors to the terminal.
        #[cfg(target_os = "linux")]
        if !std::path::Path::new("/dev/snd/seq").exists() {
            return Ok(Vec::new());
        }
        let input = Self::input()?;
        let names = input.ports().iter().filter_map(|port| input.port_name(port).ok()).collect();
        Ok(told_apart(names).into_iter().filter(|name| !name.starts_with(CLIENT)).collect())
    }

    fn open(&mut self, name: &str, mut hear: Hear) -> Result<Box<dyn Any>, String> {
        let input = Self::input()?;
        let ports = input.ports();
        let names = ports.iter().map(|port| input.port_name(port).unwrap_or_default()).collect();
        let place = told_apart(names).iter().position(|one| one == name);
        let port = place.and_then(|place| ports.get(place)).ok_or("it is no longer connected")?;
        let batch = input.connect(port, "in", move |_, bytes, ()| hear(bytes), ());
        batch.map(|connection| Box::new(connection) as Box<dyn Any>).map_err(|error| error.to_string())
    }
}

/// Removes the numbers that ALSA assigns anew each time, and adds numbers to duplicate names.
fn told_apart(names: Vec<String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in names {
        let plain = plain(&name);
        let count =
            found.iter().filter(|one| **one == plain || one.starts_with(&format!("{plain} ("))).count();
        found.push(if count == 0 { plain } else { format!("{plain} ({})", count + 1) });
    }
    found
}

/// Removes the address and the repeated device name, for example from `nanoKONTROL2:nanoKONTROL2 MIDI 1 24:0`.
fn plain(name: &str) -> String {
    let is_address = |word: &str| {
        let parts = word.split_once(':');
        parts.is_some_and(|(a, b)| [a, b].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit())))
    };
    let name = name.trim();
    let name = name.rsplit_once(' ').filter(|(_, word)| is_address(word)).map_or(name, |(rest, _)| rest);
    match name.split_once(':') {
        Some((client, port)) if port.starts_with(client) => port.trim().to_owned(),
        _ => name.trim().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_machine_without_a_midi_device_was_an_error() {
        if !std::path::Path::new("/dev/snd/seq").exists() {
            assert_eq!(SystemPorts.names(), Ok(Vec::new()));
        }
    }

    #[test]
    fn a_device_has_the_same_name_wherever_it_is_plugged_in() {
        let names =
            ["nanoKONTROL2:nanoKONTROL2 MIDI 1 24:0", "Pads:Pads 28:0", "Pads:Pads 32:0", "Bus 1", "A:B 1:0"];
        let names = told_apart(names.map(str::to_owned).to_vec());
        assert_eq!(names, ["nanoKONTROL2 MIDI 1", "Pads", "Pads (2)", "Bus 1", "A:B"]);
        assert_eq!(plain("nanoKONTROL2:nanoKONTROL2 MIDI 1 129:3"), "nanoKONTROL2 MIDI 1");
    }
}
