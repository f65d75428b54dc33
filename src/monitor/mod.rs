//! A machine over time: analyses read back, two compared, all of a folder in order.
//!
//! Everything here is computed of what `analysis.json` says; no log and no program is read again. With `x1`, `x2` an answer
//! before and after, `n` its standard deviation by the noise, `a` that by all and `p` that of what was plausible beforehand:
//!
//! | tests | `sigma²` of `x2 - x1` |
//! | --- | --- |
//! | independent: another machine, place, bar or test | `a1² + a2²` |
//! | equal: what one cannot tell from other faults the other cannot either | `n1² + n2² + k² (a² - n²)` |
//!
//! `k` is how much of what is plausible has changed: the largest `|x2 - x1| / p` of those that stand out of `n1² + n2²` and of which the
//! test tells most (`a² < p² / 2`). Where nothing has changed it is zero; where a fault has changed by a tenth of what is
//! plausible, others may have by as much. What stands out of the noise, but not of this, has *changed with it*: the test
//! cannot tell which.
//!
//! Noise of a mean over repeats is at least their scatter. In one plane a ball that stands `z` beside it makes a circle smaller by `z² / 2 R`,
//! and no reading tells: scales and mean radii count with that of 0.1 mm, another one every time the bar is set up. Ranges
//! (straightness, positioning, angles) move with the set-up by more than the noise, and count as of independent tests.
//! A change is one when so large a difference came about by chance in one of a
//! hundred comparisons with nothing changed, whichever of all the compared quantities it were in.

mod bounds;
mod chance;
mod changes;
mod circumstances;
mod folder;
mod history;
mod past;
mod quantity;
mod raw;
mod series;
mod thresholds;

pub use changes::{Change, Comparison, FindingChange, Found, Judged};
pub use folder::{find, resolved};
pub use history::{History, LeftOut};
pub use past::{FORMATS, FoundThen, MountingThen, NumberThen, Past};
pub use quantity::{Kind, Quantity};
pub use series::{Point, Series, Trend};
