//! Rays for [`phr_fuzz::rays`].

#![no_main]

use phr::geometry::Ray;

libfuzzer_sys::fuzz_target!(init: phr_fuzz::one_thread(), |rays: Vec<([f32; 3], [f32; 3], f32, f32)>| {
    let ray = |(org, dir, tnear, tfar): ([f32; 3], [f32; 3], f32, f32)| {
        Ray { org: org.into(), dir: dir.into(), tnear, tfar }
    };
    phr_fuzz::rays::check(rays.into_iter().map(ray).collect());
});
