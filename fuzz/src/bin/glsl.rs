#![no_main]

use mariana_fuzz::{GLSL, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&GLSL), |data: &[u8]| (GLSL.run)(data));
