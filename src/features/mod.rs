//! What is wrong in the plane of a circular test, and what repairing it would gain.
//!
//! A feature is a function of what was estimated ([`ask`](crate::identify::ask)) or a finding of the diagnosis; nothing is estimated here.
//! With the axes A and B of the plane, `c ± r` the range of the test, `b` the sense of an axis, `v` its velocity and `u` the direction of
//! the bar, it displaces the tool against the workpiece by `e`, and the bar reads `u · e`:
//!
//! | feature | value | e |
//! | --- | --- | --- |
//! | squareness | `s`: above 0, less than 90° between +A and +B | `s/2 (h_B - c_B)` along A, `s/2 (h_A - c_A)` along B |
//! | scale mismatch | `2 R m`, `m` scale of A less scale of B | `m/2 (h_A - c_A)` along A, `-m/2 (h_B - c_B)` along B |
//! | backlash of A | `-s`, `s` the step of A from negative to positive motion: above 0 lost motion, outward on the circle | `s/2 b_A` along A |
//! | lateral play of A in B | `s`, the same step along B | `s/2 b_A` along B |
//! | straightness of A in B, positioning of A | range of `f`, what A errs by along B, along A, about a straight line | `f(h_A)` along B, along A |
//! | angle of A | range of the rotation about the normal of the plane | what it does beside the middle line of A |
//! | servo mismatch | `d`: A follows later than B by | `-d/2 v_A` along A, `d/2 v_B` along B |
//! | a finding | its amplitude | that of its cause |
//!
//! **The fall** is G(b) of the readings, of one way G, less that of the readings with `u · e` taken off, by the room
//! [`circular`](crate::circular), both without the readings at a reversal whose time is not known well enough to say which way the axis
//! went. Falls do not add up: a range is not a sum. Its uncertainty is that of the value.
//!
//! **The order of repair** begins with what is told apart from 0: always next is that without which least is left of G(b), those before it gone.
//!
//! **The share** is what Ballbar 20 prints, as far as its reports show: `m_i / sum m` over its own features, `m` the larger magnitude of its values
//! in um, of squareness `s R`, of servo mismatch `d v` with the speed `v` along the path, of a cyclic error from peak to peak. It says how large a value is beside
//! others, not what it does to the circle.

mod angles;
mod backlash;
mod feature;
mod found;
mod geometry;
mod order;
mod rank;
mod readings;
mod scene;
mod servo;
mod volume;

pub use feature::{Feature, Kind, Left};
pub use rank::{Ranking, of};
