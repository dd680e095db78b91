//! `cargo bench --bench table1 [-- ARGUMENTS]`: the same as `phr bench [ARGUMENTS]`.

fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    // Cargo passes --bench; a test run (`cargo test --benches`) does not, and is no place for an hour's work.
    if !arguments.iter().any(|argument| argument == "--bench") {
        eprintln!("table1: run with `cargo bench --bench table1`");
        return std::process::ExitCode::SUCCESS;
    }
    let verb = ["phr", "bench"].map(String::from).into_iter();
    phr::cli::run(verb.chain(arguments.into_iter().filter(|argument| argument != "--bench")))
}
