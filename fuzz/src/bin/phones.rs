#![no_main]

use mariana_fuzz::{PHONES, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&PHONES), |data: &[u8]| (PHONES.run)(data));
