#![no_main]

use mariana_fuzz::{REGIONS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&REGIONS), |data: &[u8]| (REGIONS.run)(data));
