#![no_main]

libfuzzer_sys::fuzz_target!(init: mariana_fuzz::prepare("scene"), |data: &[u8]| (mariana_fuzz::target("scene").run)(data));
