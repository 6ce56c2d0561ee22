#![no_main]

use mariana_fuzz::{DECODE, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&DECODE), |data: &[u8]| (DECODE.run)(data));
