//! Where MIDI comes in: the system's ports, or a stand-in for them.

use std::any::Any;

use midir::{Ignore, MidiInput};

/// What is called with the bytes of a device, on a thread of the port's own.
pub type Hear = Box<dyn FnMut(&[u8]) + Send>;

/// Ports that can be listed and heard. Every call may block; the hub calls them on its own thread.
pub trait Ports: Send {
    /// The names of the devices that are there now, without repetition.
    ///
    /// # Errors
    /// There is no MIDI on this machine, and why: the end of a sentence.
    fn names(&mut self) -> Result<Vec<String>, String>;

    /// Hears a device until what is returned is dropped.
    ///
    /// # Errors
    /// Why it cannot be heard.
    fn open(&mut self, name: &str, hear: Hear) -> Result<Box<dyn Any>, String>;
}

/// What the system calls the program.
const CLIENT: &str = "Mariana";

/// The system's ports: ALSA's sequencer, CoreMIDI, WinMM.
#[derive(Default)]
pub struct SystemPorts;

impl SystemPorts {
    fn input() -> Result<MidiInput, String> {
        // ALSA complains on the terminal where there is no sequencer.
        #[cfg(target_os = "linux")]
        if !std::path::Path::new("/dev/snd/seq").exists() {
            return Err("this machine has no sequencer (/dev/snd/seq)".to_owned());
        }
        let mut input = MidiInput::new(CLIENT).map_err(|error| error.to_string())?;
        input.ignore(Ignore::SysexAndActiveSense);
        Ok(input)
    }
}

impl Ports for SystemPorts {
    fn names(&mut self) -> Result<Vec<String>, String> {
        let input = Self::input()?;
        let names = input.ports().iter().filter_map(|port| input.port_name(port).ok()).collect();
        Ok(told_apart(names).into_iter().filter(|name| !name.starts_with(CLIENT)).collect())
    }

    fn open(&mut self, name: &str, mut hear: Hear) -> Result<Box<dyn Any>, String> {
        let input = Self::input()?;
        let ports = input.ports();
        let names = ports.iter().map(|port| input.port_name(port).unwrap_or_default()).collect();
        let place = told_apart(names).iter().position(|one| one == name);
        let port = place.and_then(|place| ports.get(place)).ok_or("it has gone")?;
        let batch = input.connect(port, "in", move |_, bytes, ()| hear(bytes), ());
        batch.map(|connection| Box::new(connection) as Box<dyn Any>).map_err(|error| error.to_string())
    }
}

/// Names without the numbers that ALSA gives devices anew each time; those that are the same then are counted.
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

/// `nanoKONTROL2:nanoKONTROL2 MIDI 1 24:0` without the numbers at its end and without saying the device twice.
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

    #[test]
    fn a_device_has_the_same_name_wherever_it_is_plugged_in() {
        let names =
            ["nanoKONTROL2:nanoKONTROL2 MIDI 1 24:0", "Pads:Pads 28:0", "Pads:Pads 32:0", "Bus 1", "A:B 1:0"];
        let names = told_apart(names.map(str::to_owned).to_vec());
        assert_eq!(names, ["nanoKONTROL2 MIDI 1", "Pads", "Pads (2)", "Bus 1", "A:B"]);
        assert_eq!(plain("nanoKONTROL2:nanoKONTROL2 MIDI 1 129:3"), "nanoKONTROL2 MIDI 1");
    }
}
