//! The reference documentation says what the table of causes says.

use ballbar::model::{CAUSES, Cause, Key, Measure};

use crate::work::Work;

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

#[test]
fn a_key_a_cause_a_coefficient_and_a_heading_are_explained() {
    let work = Work::new();
    let told = |key: &str| work.ballbar(&["reference", key]).done().stdout();
    let length = told("length_mm");
    for part in ["(Test file, [ball_bar])", "(Machine file, [clearance.support])", "5 to 3000"] {
        assert!(length.contains(part), "{part}\n{length}");
    }
    assert!(!told("ball_bar.length_mm").contains("clearance"));
    assert!(told("stick-slip").contains("Stribeck"));
    assert!(told("EXY1").contains("straightness error of Y in X, its slope, part of a squareness"));
    assert!(told("EYYb").contains("half of the backlash"));
    assert!(told("EZt").contains("tool ball"));
    assert!(told("rapid-in-reach").contains("within the reach of the bar"));
    assert!(told("causes").contains("| `cyclic` |"));
    let unknown = work.ballbar(&["reference", "length_inch"]).refused(1);
    assert!(unknown.contains("these sound alike") && unknown.contains("`length_mm`"), "{unknown}");
    let json: serde_json::Value =
        serde_json::from_str(&work.ballbar(&["reference", "budget_min", "--json"]).done().stdout())
            .unwrap();
    assert_eq!(json["entries"][0]["cells"]["unit"], "min");
    let whole = work.ballbar(&["reference"]).done().stdout();
    assert_eq!(whole, include_str!("../../docs/reference.md"));
}

/// Somebody with the binary alone has no `docs` and no `machines`.
#[test]
fn no_text_of_the_program_sends_its_reader_to_a_file_of_the_project() {
    let mut open = vec![crate::work::project().join("src")];
    let mut seen = 0;
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.lines().take_while(|line| *line != "#[cfg(test)]");
            for line in code.filter(|line| !line.trim_start().starts_with("//")) {
                seen += 1;
                let sent = line.contains("docs/") && !line.contains("include_str!");
                assert!(!sent, "{}: {line}", path.display());
            }
        }
    }
    assert!(seen > 10_000, "{seen} lines");
}
