#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("syntax"), |data: &[u8]| (mariana_fuzz::target("syntax").run)(data));
