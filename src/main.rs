//! The `pneumorph` program.

fn main() -> std::process::ExitCode {
    pneumorph::cli::run()
}
