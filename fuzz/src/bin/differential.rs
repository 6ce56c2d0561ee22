#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("differential"), |data: &[u8]| (mariana_fuzz::target("differential").run)(data));
