//! The program as users run it: the real binary, real files, what it prints and what it leaves behind.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

mod archive;
mod begin;
mod blind;
mod check;
mod circular;
mod compensate;
mod correct;
mod degrees;
mod design;
mod diagnose;
mod files;
mod folders;
mod given;
mod good;
mod growing;
mod hide;
mod instrument;
mod killed;
mod lag;
mod logs;
mod monitor;
mod motion;
mod mountings;
mod noise;
mod plan;
mod planes;
mod ranked;
mod reference;
mod refused;
mod safe;
mod settings;
mod talk;
mod together;
mod volume;
mod warming;
mod work;
