#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| ajar_fuzz::examine(ajar_fuzz::Target::Picture, input));
