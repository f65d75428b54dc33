//! NC programs: those that are written here, and those that are broken, held against interpreters by others.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod broken;
mod cases;
mod dialects;
mod outside;
mod planes;
mod rs274;
mod written;
