//! Slices of a map.

use super::Mapped;
use crate::compensate::Node;
use crate::report::draw::svg::{Anchor, Drawing};
use crate::report::text::numbers::fixed;

const SIDE: f64 = 250.0;
const LEFT: f64 = 46.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 34.0;
/// Colours of one sign.
const STEPS: f64 = 5.0;

/// What a slice shows.
pub(super) struct Shown {
    pub(super) title: &'static str,
    /// um.
    pub(super) of: fn(&Node) -> f64,
}

/// What is shown, one row of slices each.
pub(super) const SHOWN: [Shown; 5] = [
    Shown { title: "Length of the vector", of: |node| node.size.value_mm * 1e3 },
    Shown { title: "Along X", of: |node| node.error[0].value_mm * 1e3 },
    Shown { title: "Along Y", of: |node| node.error[1].value_mm * 1e3 },
    Shown { title: "Along Z", of: |node| node.error[2].value_mm * 1e3 },
    Shown { title: "What is not known of the vector (all)", of: |node| node.unknown.all * 1e3 },
];

/// The slices of one quantity through the middle of the volume, one a plane that has an area, and what a full colour is, um.
pub(super) fn slices(of: &Mapped, shown: &Shown) -> (Vec<String>, f64) {
    let near = || of.map.nodes.iter().filter(|node| node.near).map(|node| (shown.of)(node).abs());
    let every = of.map.nodes.iter().map(|node| (shown.of)(node).abs());
    let full = if near().next().is_some() {
        near().fold(0.0, f64::max)
    } else {
        every.fold(0.0, f64::max)
    };
    let full = full.max(1e-6);
    let counts = of.map.counts;
    let planes = [[0, 1, 2], [0, 2, 1], [1, 2, 0]];
    let planes = planes.iter().filter(|[a, b, _]| counts[*a] > 1 && counts[*b] > 1);
    (planes.map(|axes| slice(of, shown, *axes, full)).collect(), full)
}

fn slice(of: &Mapped, shown: &Shown, [across, up, normal]: [usize; 3], full: f64) -> String {
    let (counts, letters) = (of.map.counts, ["X", "Y", "Z"]);
    let [low_mm, high_mm] = of.map.volume.ends_mm;
    let way_mm = high_mm - low_mm;
    let longest_mm = way_mm[across].max(way_mm[up]);
    let (width, height) = (SIDE * way_mm[across] / longest_mm, SIDE * way_mm[up] / longest_mm);
    let cell = (width / counts[across] as f64, height / counts[up] as f64);
    let mut drawing = Drawing::new(LEFT + SIDE + 10.0, TOP + height + BOTTOM);
    for j in 0..counts[up] {
        for i in 0..counts[across] {
            let mut index = [0; 3];
            (index[across], index[up], index[normal]) = (i, j, counts[normal] / 2);
            let at = index[0] + counts[0] * (index[1] + counts[1] * index[2]);
            let Some(node) = of.map.nodes.get(at) else { continue };
            let corner = (LEFT + i as f64 * cell.0, TOP + height - (j + 1) as f64 * cell.1);
            drawing.rectangle(corner, cell.0, cell.1, &class((shown.of)(node) / full));
            if !node.near {
                drawing.line((corner.0, corner.1 + cell.1), (corner.0 + cell.0, corner.1), "hatch");
            }
        }
    }
    let place = of.map.nodes.get(counts[..normal].iter().product::<usize>() * (counts[normal] / 2));
    let place_mm = place.map_or(low_mm[normal], |node| node.position_mm[normal]);
    let title =
        format!("{}{} at {} {}", letters[across], letters[up], letters[normal], fixed(place_mm, 0));
    drawing.text((LEFT, TOP - 8.0), Anchor::Start, "title", &title);
    let floor = TOP + height;
    for (value, x, anchor) in [(low_mm, LEFT, Anchor::Start), (high_mm, LEFT + width, Anchor::End)]
    {
        drawing.text((x, floor + 14.0), anchor, "tick", &fixed(value[across], 0));
    }
    drawing.text(
        (LEFT + 0.5 * width, floor + 28.0),
        Anchor::Middle,
        "axis",
        &format!("{}, mm", letters[across]),
    );
    for (value, y) in [(low_mm, floor), (high_mm, TOP + 9.0)] {
        drawing.text((LEFT - 5.0, y), Anchor::End, "tick", &fixed(value[up], 0));
    }
    drawing.upwards((12.0, TOP + 0.5 * height), "axis", &format!("{}, mm", letters[up]));
    drawing.finish(&format!("{} in the slice {title}", shown.title))
}

/// The colour of a share of what is full: five steps of either sign.
fn class(share: f64) -> String {
    if share.abs() > 1.0 {
        return if share > 0.0 { "cell beyond-plus".into() } else { "cell beyond-minus".into() };
    }
    let step = (share.abs() * STEPS).ceil().clamp(0.0, STEPS);
    let sign = if share < 0.0 { "minus" } else { "plus" };
    format!("cell {sign}{}", fixed(step, 0))
}
