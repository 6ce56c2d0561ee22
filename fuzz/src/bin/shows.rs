#![no_main]

use mariana_fuzz::{SHOWS, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&SHOWS), |data: &[u8]| (SHOWS.run)(data));
