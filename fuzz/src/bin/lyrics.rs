#![no_main]

use mariana_fuzz::{LYRICS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&LYRICS), |data: &[u8]| (LYRICS.run)(data));
