//! Who measured what, when and with what, as it is shown.

use crate::plan::{Record, Warmth};
use crate::report::text::numbers::fixed;

/// Each thing that the test file says, with its name.
pub(super) fn lines(record: &Record) -> Vec<(&'static str, String)> {
    let warm = |of: &Warmth| {
        format!(
            "{} ± {} °C, expansion {} ± {} um/m/K",
            fixed(of.temperature_c, 1),
            fixed(of.temperature_sigma_k, 1),
            fixed(of.expansion_um_m_k, 1),
            fixed(of.expansion_sigma_um_m_k, 1)
        )
    };
    let words = [
        ("Customer", &record.customer),
        ("Date", &record.date),
        ("Operator", &record.operator),
        ("Serial number of the machine", &record.machine_serial),
        ("Serial number of the bar", &record.bar_serial),
        ("Bar calibrated", &record.bar_calibrated),
        ("Compensation", &record.compensation),
        ("Note", &record.note),
    ];
    let warmth =
        [("Temperature of the machine", &record.machine), ("Temperature of the bar", &record.bar)];
    let words = words.into_iter().filter_map(|(name, of)| Some((name, of.clone()?)));
    let warmth = warmth.into_iter().filter_map(|(name, of)| Some((name, warm(of.as_ref()?))));
    words.chain(warmth).collect()
}
