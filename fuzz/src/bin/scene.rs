#![no_main]

use mariana_fuzz::{SCENE, prepare};

libfuzzer_sys::fuzz_target!(init: prepare(&SCENE), |data: &[u8]| (SCENE.run)(data));
