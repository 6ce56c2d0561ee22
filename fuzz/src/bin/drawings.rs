#![no_main]

use mariana_fuzz::{DRAWINGS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&DRAWINGS), |data: &[u8]| (DRAWINGS.run)(data));
