#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("settings"), |data: &[u8]| (mariana_fuzz::target("settings").run)(data));
