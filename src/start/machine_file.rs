//! A machine file with a comment on every key.

use super::commented::{Commented, number, numbers, quoted};
use super::wish::Wish;
use crate::machine::{Axis, Cylinder, Pivot};

/// The text of the machine file of a wish.
pub(super) fn machine_file(wish: &Wish) -> String {
    let mut file = Commented::new("Machine file");
    file.note(
        "The machine. What stands here is a beginning: compare it with your own machine. A line that begins with # is an \
         example of a key that may be left out. `ballbar reference KEY` says more of a key, `ballbar machines FILE` what of \
         this file was understood.",
    );
    file.key("name", &quoted(&wish.name));
    file.note(
        "The order in which things are mounted, from the workpiece w over the machine frame F to the tool t: a table on X \
         and Y with Z on the column is wXYFZSt.",
    );
    file.key("topology", &quoted(wish.topology.as_str()));
    for axis in Axis::ALL {
        axis_table(&mut file, wish, axis);
    }
    controller(&mut file, wish);
    clearance(&mut file, wish);
    plausible(&mut file);
    file.finish()
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn axis_table(file: &mut Commented, wish: &Wish, axis: Axis) {
    let slide = wish.base.slide(axis);
    file.table(&format!("[axes.{axis}]"), "[axes.X]");
    file.key("travel_mm", &numbers(&wish.travel_mm[axis.index()]));
    file.key("rapid_mm_min", &number(round(slide.rapid_mm_s * 60.0)));
    file.key("acceleration_mm_s2", &number(slide.acceleration_mm_s2));
    file.maybe("max_feed_mm_min", finite(slide.max_feed_mm_s * 60.0).map(round), "10000.0");
    file.maybe("feed_acceleration_mm_s2", finite(slide.feed_acceleration_mm_s2), "1000.0");
    let pivot = match slide.pivot {
        Pivot::Carriage => "carriage",
        Pivot::Base => "base",
    };
    file.key("pivot", &quoted(pivot));
    file.maybe("screw_pitch_mm", slide.screw_pitch_mm, "10.0");
    if axis == Axis::Z {
        let [low, high] = wish.travel_mm[axis.index()];
        file.off("retract_mm", &number((high - 1.0).max(low)));
    }
    file.off("location_mm", &numbers(slide.location_mm.as_slice()));
}

/// Rates are kept in seconds and written in minutes: to 0.001 mm/min they come back as they were.
fn round(value: f64) -> f64 {
    (value * 1e3).round() * 1e-3
}

fn controller(file: &mut Commented, wish: &Wish) {
    let of_base = wish.base.controller();
    let same = of_base.dialect == wish.dialect;
    file.table("[controller]", "[controller]");
    file.key("dialect", &quoted(wish.dialect.name()));
    file.key("decimals", &of_base.decimals.to_string());
    file.key("sequence_step", &of_base.sequence_step.to_string());
    file.key("comment_characters", &quoted(&of_base.comment_characters));
    let words = |words: &str| quoted(if same { words } else { "" });
    file.key("look_ahead_on", &words(&of_base.look_ahead_on));
    file.key("look_ahead_off", &words(&of_base.look_ahead_off));
    let options = wish.dialect.usual_options();
    if !options.is_empty() {
        let options: Vec<String> = options.iter().map(|&option| quoted(option)).collect();
        file.off("cancel_blocks", &format!("[{}]", options.join(", ")));
    }
    file.key("path_acceleration_mm_s2", &number(of_base.path_acceleration_mm_s2));
    file.key("corner_stop_deg", &number(round(of_base.corner_stop_rad.to_degrees())));
    let step_mm_min = finite(of_base.corner_speed_step_mm_s * 60.0).map(round);
    file.maybe("corner_speed_step_mm_min", step_mm_min, "300.0");
    let tolerance_um = finite(of_base.corner_tolerance_mm * 1e3).map(round);
    file.maybe("corner_tolerance_um", tolerance_um, "10.0");
    file.key("acceleration_change_ms", &number(round(of_base.acceleration_change_s * 1e3)));
    file.key("block_time_ms", &number(round(of_base.block_time_s * 1e3)));
    if wish.dialect.divides() {
        let memory_kb = of_base.memory_bytes.map(|bytes| bytes as f64 / 1024.0);
        file.maybe("memory_kb", memory_kb, "256.0");
    }
}

fn clearance(file: &mut Commented, wish: &Wish) {
    let bodies = wish.base.clearance();
    let mut body = |name: &str, of: &Cylinder, length_mm: f64, direction: Option<&str>| {
        file.table(&format!("[clearance.{name}]"), "[clearance.support]");
        file.key("diameter_mm", &number(2.0 * of.radius_mm));
        file.key("length_mm", &number(length_mm));
        if let Some(direction) = direction {
            file.key("direction", &quoted(direction));
        }
    };
    if let Some(tool) = &bodies.tool {
        // The holder reaches from the ball to the spindle nose, however long it is.
        body("tool", tool, wish.tool_mm, None);
    }
    if let Some(nose) = &bodies.spindle_nose {
        body("spindle_nose", nose, nose.length_mm, None);
    }
    if let Some(support) = &bodies.support {
        let letter = |k: usize| if support.axis[k] > 0.0 { '+' } else { '-' };
        let k = support.axis.iamax();
        let direction = format!("{}{}", letter(k), ["X", "Y", "Z"][k]);
        body("support", support, support.length_mm, Some(&direction));
    }
}

fn plausible(file: &mut Commented) {
    file.table_off("[plausible]", "[plausible]");
    for (key, example) in [
        ("slope_um_m", "200.0"),
        ("way_um", "5.0"),
        ("reversal_um", "20.0"),
        ("turn_urad", "50.0"),
        ("bend_urad", "20.0"),
        ("tip_urad", "10.0"),
        ("set_up_um", "100.0"),
    ] {
        file.off(key, example);
    }
}
