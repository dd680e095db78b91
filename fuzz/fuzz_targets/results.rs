//! Bytes for [`phr_fuzz::results`].

#![no_main]

libfuzzer_sys::fuzz_target!(init: phr_fuzz::one_thread(), |input: &[u8]| {
    phr_fuzz::results::check(input);
});
