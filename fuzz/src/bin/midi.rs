#![no_main]

use mariana_fuzz::{MIDI, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&MIDI), |data: &[u8]| (MIDI.run)(data));
