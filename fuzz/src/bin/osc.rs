#![no_main]

use mariana_fuzz::{OSC, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&OSC), |data: &[u8]| (OSC.run)(data));
