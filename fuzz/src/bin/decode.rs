#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("decode"), |data: &[u8]| (mariana_fuzz::target("decode").run)(data));
