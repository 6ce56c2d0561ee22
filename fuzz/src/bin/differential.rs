#![no_main]

use mariana_fuzz::{DIFFERENTIAL, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&DIFFERENTIAL), |data: &[u8]| (DIFFERENTIAL.run)(data));
