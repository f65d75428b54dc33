//! The command line program; everything it does is in the room `cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ballbar::cli::main()
}
