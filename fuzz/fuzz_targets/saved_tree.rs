//! Changes for [`phr_fuzz::saved_tree`].

#![no_main]

libfuzzer_sys::fuzz_target!(init: phr_fuzz::one_thread(), |input: (Option<u16>, Vec<(u16, u8)>)| {
    phr_fuzz::saved_tree::check(input.0, &input.1);
});
