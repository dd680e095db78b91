//! Configurations and triangles for [`phr_fuzz::configuration`].

#![no_main]

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;

#[derive(Arbitrary, Debug)]
struct Input {
    builder: u8,
    changes: String,
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u8; 3]>,
}

fuzz_target!(init: phr_fuzz::one_thread(), |input: Input| {
    let Input { builder, changes, vertices, triangles } = input;
    phr_fuzz::configuration::check(builder, &changes, vertices, &triangles);
});
