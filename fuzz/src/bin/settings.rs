#![no_main]

use mariana_fuzz::{SETTINGS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&SETTINGS), |data: &[u8]| (SETTINGS.run)(data));
