//! The `phr` command.

fn main() -> std::process::ExitCode {
    phr::cli::main()
}
