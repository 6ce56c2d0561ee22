#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("lists"), |data: &[u8]| (mariana_fuzz::target("lists").run)(data));
