#![no_main]

use mariana_fuzz::{LISTS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&LISTS), |data: &[u8]| (LISTS.run)(data));
