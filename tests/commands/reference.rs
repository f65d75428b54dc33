//! The reference documentation says what the table of causes says.

use ballbar::model::{CAUSES, Cause, Key, Measure};

/// The keys of a cause with their limits, as the reference has them.
fn keys(cause: &Cause) -> String {
    let of = |key: &Key| {
        let [low, high] = key.limits;
        let name = match key.measure {
            Measure::OfSeat => return "A".to_owned(),
            Measure::OfSeatPerLength => {
                format!("`{0}_um_m`, of an angular function `{0}_urad_mm`,", key.name)
            }
            Measure::Fixed(unit) if unit.suffix.is_empty() => format!("`{}`", key.name),
            Measure::Fixed(unit) => format!("`{}_{}`", key.name, unit.suffix),
        };
        let or = key.default.map_or(String::new(), |default| format!(", or {default}"));
        format!("{name} {low} to {high}{or}")
    };
    cause.keys.iter().map(of).collect::<Vec<_>>().join("; ")
}

#[test]
fn the_reference_lists_every_cause_as_the_table_has_it() {
    let reference = include_str!("../../docs/reference.md");
    let row = |cause: &Cause| {
        format!(
            "| `{}` | {} | {} | {} |",
            cause.id,
            cause.seat.words(),
            keys(cause),
            cause.equation
        )
        .replace("  ", " ")
    };
    let table: Vec<String> = CAUSES.iter().map(row).collect();
    let table = table.join("\n");
    assert!(reference.contains(&table), "the section Causes of docs/reference.md must be\n{table}");
}
