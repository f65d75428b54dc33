//! The uncertainty over the working volume as maps: slices at several Z.

use crate::report::draw::svg::{Anchor, Drawing};
use crate::report::draw::ticks::round_up;
use crate::report::plan::facts::VolumeFacts;
use crate::report::text::numbers::{decimals, fixed, typeset};

/// Side of a cell, pixels.
const CELL: f64 = 27.0;
const LEFT: f64 = 46.0;
const TOP: f64 = 24.0;
/// Shades of the scale.
const SHADES: usize = 8;
/// Slices that are shown.
const SLICES: usize = 4;

/// A scale of round steps, um, each with a shade.
struct Scale {
    low_um: f64,
    step_um: f64,
    steps: usize,
}

impl Scale {
    fn new(volume: &VolumeFacts) -> Self {
        let values = || volume.sigma_um.iter().copied();
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        // Beginning and end on a step take one more at the most.
        let step_um = round_up(((most - least) / (SHADES - 1) as f64).max(1e-3));
        let low_um = (least / step_um).floor() * step_um;
        let steps = ((most - low_um) / step_um).ceil().clamp(1.0, SHADES as f64) as usize;
        Self { low_um, step_um, steps }
    }

    fn step(&self, um: f64) -> usize {
        (((um - self.low_um) / self.step_um) as usize).min(self.steps - 1)
    }

    /// The shade of a step: few steps are spread over all shades.
    fn shade(&self, step: usize) -> usize {
        step * (SHADES - 1) / self.steps.saturating_sub(1).max(1)
    }

    fn high_um(&self) -> f64 {
        self.low_um + self.step_um * self.steps as f64
    }
}

/// The scale and the slices, each a drawing.
pub(in crate::report::plan) fn maps(volume: &VolumeFacts, what: &str) -> Vec<String> {
    let scale = Scale::new(volume);
    let heights = &volume.grid_mm[2];
    let worst = heights.iter().position(|z| same(*z, volume.worst_at_mm[2])).unwrap_or(0);
    let last = heights.len().saturating_sub(1);
    let mut chosen: Vec<usize> = (0..SLICES).map(|k| k * last / (SLICES - 1)).collect();
    // The slice with the worst point stands for its neighbour.
    if let Some(near) = chosen.iter_mut().min_by_key(|k| k.abs_diff(worst)) {
        *near = worst;
    }
    chosen.dedup();
    let mut drawings: Vec<String> =
        chosen.into_iter().map(|z| slice(volume, z, &scale, what)).collect();
    drawings.push(legend(&scale, what));
    drawings
}

fn same(a_mm: f64, b_mm: f64) -> bool {
    (a_mm - b_mm).abs() < 1e-6
}

fn slice(volume: &VolumeFacts, z: usize, scale: &Scale, what: &str) -> String {
    let [xs, ys, zs] = &volume.grid_mm;
    let (width, height) = (CELL * xs.len() as f64, CELL * ys.len() as f64);
    let mut drawing = Drawing::new(LEFT + width + 6.0, TOP + height + 38.0);
    let title = format!("Z {} mm", typeset(&fixed(zs[z], 0)));
    drawing.text((LEFT, 15.0), Anchor::Start, "title", &title);
    // Three digits fit in a cell.
    let places = decimals(scale.high_um(), 3).min(2);
    for (i, x) in xs.iter().enumerate() {
        for (k, y) in ys.iter().enumerate() {
            let um = volume.sigma_um[(i * ys.len() + k) * zs.len() + z];
            let corner = (LEFT + CELL * i as f64, TOP + height - CELL * (k + 1) as f64);
            let shade = scale.shade(scale.step(um));
            drawing.rectangle(corner, CELL, CELL, &format!("cell h{shade}"));
            let class = if shade * 2 >= SHADES { "cell-text light" } else { "cell-text" };
            let at = (corner.0 + 0.5 * CELL, corner.1 + 0.5 * CELL + 3.5);
            drawing.text(at, Anchor::Middle, class, &fixed(um, places));
            let [wx, wy, wz] = volume.worst_at_mm;
            if same(*x, wx) && same(*y, wy) && same(zs[z], wz) {
                let inner = (corner.0 + 1.5, corner.1 + 1.5);
                drawing.rectangle(inner, CELL - 3.0, CELL - 3.0, "worst");
            }
        }
    }
    for (i, x) in xs.iter().enumerate().step_by(2) {
        let at = (LEFT + CELL * (i as f64 + 0.5), TOP + height + 14.0);
        drawing.text(at, Anchor::Middle, "tick", &typeset(&fixed(*x, 0)));
    }
    drawing.text((LEFT + 0.5 * width, TOP + height + 30.0), Anchor::Middle, "axis", "X, mm");
    for (k, y) in ys.iter().enumerate().step_by(2) {
        let at = (LEFT - 5.0, TOP + height - CELL * (k as f64 + 0.5) + 3.5);
        drawing.text(at, Anchor::End, "tick", &typeset(&fixed(*y, 0)));
    }
    drawing.upwards((11.0, TOP + 0.5 * height), "axis", "Y, mm");
    drawing.finish(&format!("{what} at {title}"))
}

fn legend(scale: &Scale, what: &str) -> String {
    let (cell, top) = (54.0, 8.0);
    let mut drawing = Drawing::new(40.0 + cell * scale.steps as f64 + 50.0, 44.0);
    let x_at = |step: usize| 20.0 + cell * step as f64;
    for step in 0..scale.steps {
        let class = format!("cell h{}", scale.shade(step));
        drawing.rectangle((x_at(step), top), cell, 14.0, &class);
    }
    let places = decimals(scale.step_um, 1);
    for step in 0..=scale.steps {
        let label = fixed(scale.low_um + scale.step_um * step as f64, places);
        drawing.text((x_at(step), top + 29.0), Anchor::Middle, "tick", &label);
    }
    drawing.text((x_at(scale.steps) + 8.0, top + 11.0), Anchor::Start, "tick", "µm");
    drawing.finish(&format!("Scale of {what}"))
}
