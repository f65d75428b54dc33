//! Ball-bar testing of three-axis machine tools: programs, alignment of raw logs, identification.
//!
//! A telescoping ball-bar measures the distance between a ball on the table and a ball in the spindle
//! while the machine drives arcs over a sphere. This crate plans the arcs, writes them as NC programs,
//! lays the instrument's log over the program that ran although nobody synchronised the clocks, and
//! identifies the 18 errors of the three slides, each a cubic with hysteresis, and the set-up errors.
//!
//! # The rooms
//!
//! The modules stand in the order of the flow; each uses those before it only. Under all of them lie
//! [`error`] and what reads text files.
//!
//! | room | holds |
//! | --- | --- |
//! | [`solve`] | factorisation, rank, covariance: the linear algebra |
//! | [`machine`] | the machine file, topology, exact chain, inverse kinematics |
//! | [`model`] | coefficient names, error functions, terms, the projected Jacobian |
//! | [`plan`] | arcs, strategies, mountings, the test file, the path |
//! | [`nc`] | programs written, read back and checked |
//! | [`log`] | readers of ball-bar logs |
//! | [`motion`] | a program becomes a timed trajectory |
//! | [`align`] | engagement, time map, samples with poses |
//! | [`simulate`] | a virtual machine and instrument |
//! | [`identify`] | the fit, what is observable, repeats |
//! | [`circular`] | circular tests as ISO 230-4 has them: what a path over an arc is by itself |
//! | [`residual`] | what a fit leaves: samples, noise, what an effect explains beside others |
//! | [`diagnose`] | what the model gets wrong, the cause, the gain |
//! | [`features`] | what is wrong in the plane of a circular test, and by how much its deviation falls without it |
//! | [`paper`] | the paper's tables computed again |
//! | [`monitor`] | analyses read back: two compared, a machine over time |
//! | [`compensate`] | what the errors do to a workpiece: the map of the volume, a program made right beforehand |
//! | [`design`] | what a test will see before it is run, and which test sees most |
//! | [`virtual_test`] | a whole test on a virtual machine: programs, logs, truth |
//! | [`start`] | a machine file and a test file to begin with |
//! | [`trial`] | effects hidden at random, diagnosed and judged |
//! | [`report`] | terminal, HTML, JSON, CSV |
//! | [`cli`] | the command line |
//!
//! # Units and signs
//!
//! Inside: mm, s, rad, mm/s; every name of a number ends with its unit. Files and screens say theirs in
//! the name of the field. Axis positions are machine coordinates, in the sense in which the program
//! moves the tool relative to the workpiece; a deviation is positive outward.
//!
//! # An identification
//!
//! ```
//! use ballbar::identify::{Campaign, Failure};
//! use ballbar::plan::Test;
//!
//! let test = Test::read("tests/data/hu40t/test.toml".as_ref())?;
//! let machine = test.machine()?;
//! let repeats = Campaign::of(&test, &machine, Failure::Refuse, &|| ())?.repeats;
//! let backlash = repeats[0].estimate("EYYb").expect("it is among the terms");
//! assert!((backlash.value - -3.114e-3).abs() < 4.0 * backlash.sigma, "mm");
//! # Ok::<(), ballbar::Error>(())
//! ```
//!
//! # What is not modelled
//!
//! Rotary axes and elasticity: they are left in the residual, and no sigma counts them. Temperature, servo
//! lag, cyclic errors of screws and the other [`CAUSES`](model::CAUSES) are in no identification unless they are
//! named as terms; [`diagnose`] looks for them in what an identification leaves.

pub mod align;
pub mod circular;
pub mod cli;
pub mod compensate;
pub mod design;
pub mod diagnose;
pub mod error;
pub mod features;
mod file_name;
pub mod identify;
mod input;
pub mod log;
pub mod machine;
pub mod model;
pub mod monitor;
pub mod motion;
pub mod nc;
pub mod paper;
pub mod plan;
pub mod report;
pub mod residual;
pub mod simulate;
pub mod solve;
pub mod start;
mod toml_text;
pub mod trial;
pub mod virtual_test;
mod written;

pub use error::{Error, Result};
