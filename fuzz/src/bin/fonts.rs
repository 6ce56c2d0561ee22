#![no_main]

use mariana_fuzz::{FONTS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&FONTS), |data: &[u8]| (FONTS.run)(data));
