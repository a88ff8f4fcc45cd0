//! The `pneumorph` program: parses the command line and runs one command.

fn main() -> std::process::ExitCode {
    std::process::ExitCode::SUCCESS
}
