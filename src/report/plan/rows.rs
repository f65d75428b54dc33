//! The tables of a plan as rows of words, the first row the head; terminal and HTML show the same.

use super::facts::{PlanReport, Spread, TestOutlook, TimeFacts};
use crate::report::analysis::cautions::DETERMINED;
use crate::report::analysis::place;
use crate::report::text::numbers::{count, decimals, fixed};
use crate::report::text::units::engineering;

/// A row of a table.
pub(super) type Row = Vec<String>;

fn head(cells: &[&str]) -> Row {
    cells.iter().map(|&cell| cell.to_owned()).collect()
}

/// `16:58`, or `1:02:10` from an hour on.
pub(super) fn clock(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        format!("{hours}:{minutes:02}:{rest:02}")
    } else {
        format!("{minutes}:{rest:02}")
    }
}

/// Time by kind, a row a mounting, one for all, and one for all repeats where there are several.
pub(super) fn time(test: &TestOutlook, repeats: u32) -> Vec<Row> {
    let row = |name: String, time: &TimeFacts| {
        let kinds = [
            time.arcs_s,
            time.transits_s,
            time.other_feed_s,
            time.dwell_s,
            time.rapid_s,
            time.machine_s,
            time.operator_s,
            time.total_s,
        ];
        let mut row = vec![name];
        row.extend(kinds.map(clock));
        row.push(time.stops.to_string());
        row
    };
    let mut rows = vec![head(&[
        "mounting",
        "arcs",
        "transits",
        "other feed",
        "dwells",
        "rapid",
        "machine",
        "operator",
        "total",
        "stops",
    ])];
    rows.extend(test.mountings.iter().map(|m| row(m.name.clone(), &m.time)));
    if test.mountings.len() > 1 {
        rows.push(row("all".into(), &test.time));
    }
    if repeats > 1 {
        rows.push(row(format!("{repeats} times"), &test.time_of_repeats));
    }
    rows
}

/// What a mounting is, a row each.
pub(super) fn mountings(test: &TestOutlook) -> Vec<Row> {
    let mut rows = vec![head(&[
        "mounting",
        "program",
        "balls coincide at, mm",
        "bar, mm",
        "arcs",
        "mm",
        "transits",
        "mm",
        "samples",
    ])];
    rows.extend(test.mountings.iter().map(|m| {
        vec![
            m.name.clone(),
            m.program.clone(),
            m.coincidence_mm.map(|mm| fixed(mm, 1)).join(", "),
            m.bar_length_mm.to_string(),
            m.arcs.to_string(),
            count(m.arcs_mm.round() as usize),
            m.transits.to_string(),
            count(m.transits_mm.round() as usize),
            count(m.samples),
        ]
    }));
    rows
}

/// Travel against the limits, a row a mounting; the least margin of each axis behind it.
pub(super) fn travel(test: &TestOutlook) -> Vec<Row> {
    let range = |[low, high]: [f64; 2]| format!("{} to {}", fixed(low, 1), fixed(high, 1));
    let mut rows = vec![head(&["mounting", "X", "left", "Y", "left", "Z", "left"])];
    if let Some(first) = test.mountings.first() {
        let mut limits = vec!["limits".to_owned()];
        limits.extend(first.travel.iter().flat_map(|t| [range(t.limits_mm), String::new()]));
        rows.push(limits);
    }
    rows.extend(test.mountings.iter().map(|mounting| {
        let mut row = vec![mounting.name.clone()];
        row.extend(mounting.travel.iter().flat_map(|t| [range(t.used_mm), fixed(t.margin_mm, 1)]));
        row
    }));
    rows
}

/// A standard deviation of one test and, with repeats, of the mean; or that it stands on one leg only.
fn spread(sigma: &Spread, observed: f64, repeats: u32) -> Vec<String> {
    if observed < DETERMINED {
        let share = format!("only {} % seen", fixed((observed * 1000.0).floor() / 10.0, 1));
        return if repeats > 1 { vec![share, "-".into()] } else { vec![share] };
    }
    // The mean is the smaller of the two: both show its digits.
    let places = sigma.of_mean.map_or(2, |value| decimals(value, 2).min(6));
    let shown = |value: Option<f64>| value.map_or("-".into(), |value| fixed(value, places));
    let both = [shown(sigma.of_one), shown(sigma.of_mean)];
    both.into_iter().take(if repeats > 1 { 2 } else { 1 }).collect()
}

/// Squareness, scale and reversal: what, the coefficient, sigma of one test, of the mean, the unit.
pub(super) fn machine_errors(test: &TestOutlook, repeats: u32) -> Vec<Row> {
    let mut rows = vec![head(&["error", "coefficient", "sigma"])];
    if repeats > 1 {
        rows[0].push(format!("of the mean of {repeats}"));
    }
    rows[0].push("unit".into());
    let errors = &test.machine_errors;
    let mut push = |what: &str, name: &str, sigma: &Spread, observed: f64, unit: &str| {
        let mut row = vec![what.to_owned(), name.to_owned()];
        row.extend(spread(sigma, observed, repeats));
        row.push(unit.to_owned());
        rows.push(row);
    };
    for s in &errors.squareness {
        let what = format!("squareness {}", s.axes);
        let name = format!("{}, {}", s.name, s.symbol);
        push(&what, &name, &s.sigma_um_m, s.observed, "um/m");
        push("", "", &s.sigma_arcsec, s.observed, "arcsec");
    }
    for s in &errors.scale {
        let axis = s.name.chars().nth(1).unwrap_or(' ');
        push(&format!("scale of {axis}"), &s.name, &s.sigma_um_m, s.observed, "um/m");
    }
    for r in &errors.reversal {
        push(&format!("{}, step", r.kind), &r.name, &r.step_sigma_um, r.observed, "um");
    }
    for h in &errors.angular_hysteresis {
        push("angular hysteresis, step", &h.name, &h.step_sigma_urad, h.observed, "urad");
    }
    rows
}

/// What people ask, with both uncertainties.
pub(super) fn at_the_place(test: &TestOutlook, repeats: u32) -> Vec<Row> {
    let mut rows = vec![head(&["", "noise"])];
    if repeats > 1 {
        rows[0].push(format!("of the mean of {repeats}"));
    }
    rows[0].extend(["all".into(), "unit".into()]);
    for foreseen in &test.at_the_place {
        let noise = foreseen.noise.of_mean.unwrap_or(0.0);
        let shown = |number: Option<f64>| match number {
            // What a test does not see at all has no noise.
            Some(sigma) => {
                fixed(sigma, place::decimals(noise.max(0.01 * foreseen.all.unwrap_or(0.0))))
            }
            None => "-".into(),
        };
        let mut row = vec![foreseen.quantity.clone(), shown(foreseen.noise.of_one)];
        if repeats > 1 {
            row.push(shown(foreseen.noise.of_mean));
        }
        row.extend([shown(foreseen.all), foreseen.unit.to_owned()]);
        rows.push(row);
    }
    rows
}

/// All parameters in engineering units; `fine` for the signs of the trade.
pub(super) fn parameters(test: &TestOutlook, repeats: u32, fine: bool) -> Vec<Row> {
    let mut rows = vec![head(&["name", "sigma"])];
    if repeats > 1 {
        rows[0].push(format!("mean of {repeats}"));
    }
    rows[0].push("unit".into());
    rows.extend(test.parameters.iter().map(|parameter| {
        let unit = engineering(parameter.unit);
        let scaled = |sigma: Option<f64>| sigma.map(|s| s * unit.factor);
        let sigma = Spread {
            of_one: scaled(parameter.sigma.of_one),
            of_mean: scaled(parameter.sigma.of_mean),
        };
        let mut row = vec![parameter.name.clone()];
        row.extend(spread(&sigma, parameter.observed, repeats));
        row.push(if fine { unit.fine } else { unit.plain }.to_owned());
        row
    }));
    rows
}

/// One column a test.
pub(super) fn side_by_side(plan: &PlanReport) -> Vec<Row> {
    let all = &plan.side_by_side;
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("-".into(), |value| fixed(value, decimals))
    };
    // Of the mean where there are repeats: that is what the user will have in the end.
    let mean = |sigma: &Spread| sigma.of_mean;
    let mut rows: Vec<Row> = Vec::new();
    let mut push = |what: &str, cells: Vec<String>| {
        rows.push([what.to_owned()].into_iter().chain(cells).collect());
    };
    push("test", all.iter().map(|test| test.test.clone()).collect());
    push("strategy", all.iter().map(|test| test.strategy.to_owned()).collect());
    push("mountings", all.iter().map(|test| test.mountings.to_string()).collect());
    push("total time", all.iter().map(|test| clock(test.total_s)).collect());
    push("of it the machine", all.iter().map(|test| clock(test.machine_s)).collect());
    push("samples", all.iter().map(|test| count(test.samples)).collect());
    push("coefficients of 90", all.iter().map(|test| test.coefficients.to_string()).collect());
    push("condition", all.iter().map(|test| number(test.condition, 0)).collect());
    for axes in ["Y to Z", "Y to X", "Z to X"] {
        let of = |test: &super::facts::Comparison| {
            let found = test.squareness.iter().find(|s| s.axes == axes);
            number(found.and_then(|s| mean(&s.sigma_um_m)), 2)
        };
        if all.iter().any(|test| test.squareness.iter().any(|s| s.axes == axes)) {
            push(&format!("squareness {axes}, um/m"), all.iter().map(of).collect());
        }
    }
    let backlash = all.iter().map(|test| number(mean(&test.worst_backlash_um), 3));
    push("worst backlash, step, um", backlash.collect());
    let rms = all.iter().map(|test| number(mean(&test.volume_rms_um), 2));
    push("volume, rms, um", rms.collect());
    let worst = all.iter().map(|test| number(mean(&test.volume_worst_um), 2));
    push("volume, worst, um", worst.collect());
    push("left unknown, rms, um", all.iter().map(|test| number(test.unseen_rms_um, 1)).collect());
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_minutes_and_seconds() {
        assert_eq!(clock(59.6), "1:00");
        assert_eq!(clock(1018.2), "16:58");
        assert_eq!(clock(3730.0), "1:02:10");
    }
}
