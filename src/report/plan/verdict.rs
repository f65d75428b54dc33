//! What will the test take, and tell? The verdict, a sentence an entry.

use std::fmt::Write as _;

use super::facts::TestOutlook;
use crate::report::text::numbers::{fixed, many};

/// The verdict, a line a sentence: time, sight, volume.
pub(super) fn of(test: &TestOutlook, repeats: u32) -> Vec<String> {
    let minutes = |seconds: f64| format!("{} min", fixed(seconds / 60.0, 0));
    let mut time = format!(
        "It takes {}: {} for the machine and {} assumed for the operator.",
        minutes(test.time.total_s),
        minutes(test.time.machine_s),
        minutes(test.time.operator_s)
    );
    if repeats > 1 {
        let _ = write!(
            time,
            " {repeats} repeats take {}, {} for the machine.",
            minutes(test.time_of_repeats.total_s),
            minutes(test.time_of_repeats.machine_s)
        );
    }
    let sight = &test.sight;
    let terms = if sight.chosen {
        "chosen by what the test can distinguish".to_owned()
    } else {
        format!("of the named terms {}", sight.asked.join(" "))
    };
    let sight = format!(
        "It determines {} of 90 coefficients and {}, {terms}: rank {} of {} on ideal arcs, {} with the noise; condition number {}.",
        sight.coefficients,
        many(sight.set_up_errors, "set-up error"),
        sight.ideal_rank,
        sight.parameter_count,
        sight.rank,
        sight.condition.map_or("unknown".into(), |condition| fixed(condition, 0))
    );
    vec![time, sight, volume(test, repeats), unknown(test)]
}

fn volume(test: &TestOutlook, repeats: u32) -> String {
    let of = &test.volume_noise;
    let um = |value: Option<f64>| value.map_or("unknown".into(), |value| fixed(value, 2));
    let [x, y, z] = of.worst_at_mm.map(|mm| fixed(mm, 0));
    let mut text = format!(
        "Over the whole travel, with the tool of mounting {}, the noise leaves the volumetric error uncertain by {} um rms, {} um at the worst point X{x} Y{y} Z{z}.",
        test.mountings.first().map_or("", |mounting| mounting.name.as_str()),
        um(of.rms_um.of_one),
        um(of.worst_um.of_one)
    );
    if repeats > 1 {
        let _ = write!(
            text,
            " The mean of {repeats}: {} um rms, {} um at the worst.",
            um(of.rms_um.of_mean),
            um(of.worst_um.of_mean)
        );
    }
    text
}

fn unknown(test: &TestOutlook) -> String {
    let of = &test.volume_unseen;
    format!(
        "Not observed at all: {} um rms, {} um at the worst, if each of the 90 coefficients may displace the tool by {} um rms. Repeats do not reduce it.",
        of.rms_um.of_one.map_or("unknown".into(), |um| fixed(um, 1)),
        of.worst_um.of_one.map_or("unknown".into(), |um| fixed(um, 1)),
        fixed(test.unknown_um, 0)
    )
}
