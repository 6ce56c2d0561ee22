#![no_main]

use mariana_fuzz::{TAPE, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&TAPE), |data: &[u8]| (TAPE.run)(data));
