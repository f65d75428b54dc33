//! Programs of the control: writing a planned path, and reading one back as the moves it makes.
//!
//! The program that ran is the truth about the path: it was rounded, cut into chords and perhaps edited
//! after it was planned. [`read()`] therefore follows a program block by block, as a Fanuc 15i/150i does,
//! and yields what the machine does, in machine coordinates ([`Program`]).
//!
//! **Nothing is skipped.** A word that is not listed here is an error with its line, its column and what
//! to do, because a word that was overlooked may have moved the machine.
//!
//! | words | meaning |
//! | --- | --- |
//! | G00 G01 G02 G03 | positioning, line, arc clockwise, arc counter-clockwise; arcs by I J K or by R, helical with the third axis |
//! | G04 | dwell: P whole milliseconds, X or U seconds |
//! | G09, G61, G64 | exact stop in this block, in every block, in none |
//! | G17 G18 G19 | plane of arcs: XY, ZX, YZ |
//! | G20 G21 | inch, millimetre (the feed too) |
//! | G53 | machine coordinates in this block, with G00 and G90 |
//! | G54 to G59 | work offsets, from [`Reading::work_offsets_mm`] |
//! | G90 G91 | absolute, incremental |
//! | G40 G49 G80 G94, G15 G50 G69 | accepted: they state what holds anyway |
//! | G05.1 Q0/Q1, G05 P0/P10000, G08 P0/P1 | look-ahead off and on, alone in a block: no effect on the path |
//! | M00 M01 | stop, optional stop |
//! | M02 M30 | end |
//! | M98 P L, M99 | call of a subprogram of the same file, return from it; four calls deep |
//! | M03 M04 M05 M08 M09, S, T | accepted: no effect on the path |
//! | N, O, `/`, `%`, `( )`, `;` | block number, program number, block delete, begin and end of the file, comment, end of block |
//!
//! **What holds before the program says anything:** G17, G21, G54, G64, G90, G94. The kind of motion does
//! not (a parameter of the control decides between G00 and G01), nor does a feed, nor a position: the
//! machine may stand anywhere. A coordinate becomes known when it is first commanded absolutely, and a
//! G00 from a place that is not known in X, Y and Z yields no step, because its duration is not known.
//!
//! **Siemens and Klartext** have the same moves in other words: [`Dialect`](crate::machine::Dialect) chooses the table that the words are
//! looked up in, and the reference lists what is followed (`docs/reference.md`, Siemens and HEIDENHAIN).
//!
//! **LinuxCNC.** With the dialect `linuxcnc` a number counts in millimetres or inches with or without a
//! point, a dwell is `G04 P` in seconds, `;` begins a comment, G64 and G61 may have P and Q, and G05,
//! G05.1, G08, G09, G15, G50 and G69 are not known.
//!
//! **Numbers.** `X10.` is 10 mm. `X10` is 10 least input increments, 0.010 mm (G20: 0.0010 inch), and so
//! are I, J, K and R; a dwell `X10` is 10 ms. A feed is mm/min (inch/min) with or without the point.
//!
//! **Not modelled:** tool length and cutter compensation, fixed cycles, rotary axes, reference returns,
//! coordinate rotation and scaling, macros. All of them are errors.

mod arc;
mod bounds;
pub mod check;
mod code;
mod command;
mod comment;
mod grammar;
mod header;
mod keyword;
mod klartext;
mod language;
mod lex;
mod lines;
mod listing;
mod look_ahead;
mod modal;
mod position;
pub mod program;
mod read;
mod read_back;
mod reading;
mod rewrite;
mod run;
mod source;
mod spelling;
#[cfg(test)]
mod tests;
mod word;
mod write;
mod writer;

pub use check::{Checked, Finding, Severity, Sphere, check};
pub use comment::with_warnings;
pub use program::{Action, Move, Path, Program, Step};
pub use read::{read, read_file, text_of};
pub use read_back::{ReadBack, read_back};
pub use reading::Reading;
pub use rewrite::{At, Driven, Rewriting};
pub use source::Source;
pub use spelling::{file_name, number_in};
pub use write::write;
