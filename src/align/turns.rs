//! When slides turn round, as they are driven.

use super::following::Following;
use super::samples::Alignment;

impl Alignment {
    /// When slides turn round, s, in order and apart: each while from the program's turn to that of the slide, which is another
    /// one of slides that follow late, and of a corner that the control rounds out.
    pub fn turns_s(&self, following: &Following) -> Vec<[f64; 2]> {
        let mut all = following.turns_s(&self.trajectory);
        all.extend(self.reversals.rounded_s(self.time_map.rounded));
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut apart: Vec<[f64; 2]> = Vec::with_capacity(all.len());
        for [from_s, to_s] in all {
            match apart.last_mut().filter(|last| from_s <= last[1]) {
                Some(last) => last[1] = last[1].max(to_s),
                None => apart.push([from_s, to_s]),
            }
        }
        apart
    }
}
