#![no_main]

use mariana_fuzz::{SYNTAX, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&SYNTAX), |data: &[u8]| (SYNTAX.run)(data));
