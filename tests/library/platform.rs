//! That tests ran on the processor they were meant for: `make test-platforms` says which.

use phr::trace::Isa;

#[test]
fn instructions_are_those_expected() {
    let Ok(expected) = std::env::var("PHR_EXPECTED_ISA") else { return };
    assert_eq!(Isa::best().name(), expected);
}
