#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("regions"), |data: &[u8]| (mariana_fuzz::target("regions").run)(data));
