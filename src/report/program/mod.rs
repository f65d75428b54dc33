//! A program as a page: its path on the sphere, and its speed over time.

mod figures;
pub(super) mod html;
mod legs;
