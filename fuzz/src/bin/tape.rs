#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("tape"), |data: &[u8]| (mariana_fuzz::target("tape").run)(data));
