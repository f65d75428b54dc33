//! A designed test as a test file.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;
use toml::{Table, Value};

use super::proposed::ProposedSetUp;
use crate::error::{Error, Kind, Result};
use crate::plan::{Arc, Test};

/// Decimals of a component of a direction: 0.1 nm on a bar of 100 mm.
const DIRECTION_DECIMALS: i32 = 9;
/// Work offsets that a control has: G54 to G59.
const WORK_OFFSETS: usize = 6;

/// The test file of a proposal: that of the request with the mountings and arcs that were chosen.
pub(super) fn test_file(
    request: &Test,
    set_ups: &[ProposedSetUp],
    terms: &[String],
) -> Result<String> {
    let faulty = |what: String| Error::new(Kind::Output, what);
    let source = crate::toml_text::read(request.file())?;
    let mut table: Table = toml::from_str(&source).map_err(|error| faulty(error.to_string()))?;
    let machine = request.machine()?.file().to_path_buf();
    let machine = std::path::absolute(&machine).unwrap_or(machine);
    table.insert("name".into(), format!("{}, designed", request.name()).into());
    table.insert("machine".into(), machine.display().to_string().into());
    table.remove("run");
    table.remove("design");
    let offset = |index: usize| format!("G{}", 54 + index);
    let mountings = set_ups.iter().enumerate().map(|(index, proposed)| {
        let set_up = &proposed.set_up;
        let mut mounting = Table::new();
        mounting.insert("name".into(), set_up.name.clone().into());
        mounting.insert("coincidence_mm".into(), vector(&set_up.mounting.coincidence_mm, 6));
        mounting.insert("tool_ball_mm".into(), vector(&set_up.mounting.tool_ball_mm, 6));
        if (set_up.bar_mm - request.ball_bar().length_mm).abs() > 1e-9 {
            mounting.insert("bar_length_mm".into(), set_up.bar_mm.into());
        }
        if set_ups.len() <= WORK_OFFSETS {
            mounting.insert("work_offset".into(), offset(index).into());
        }
        Value::from(mounting)
    });
    table.insert("mounting".into(), mountings.collect::<Vec<_>>().into());
    let arcs = set_ups
        .iter()
        .flat_map(|proposed| proposed.arcs.iter().map(|arc| arc_table(arc, &proposed.set_up.name)));
    let arcs: Vec<Value> = arcs.collect();
    if let Some(Value::Table(plan)) = table.get_mut("plan") {
        for key in ["strategy", "sweep_deg", "start_deg", "overshoot_deg"] {
            plan.remove(key);
        }
        plan.insert("arc".into(), arcs.into());
    }
    let mut identify = match table.remove("identify") {
        Some(Value::Table(identify)) => identify,
        _ => Table::new(),
    };
    identify.insert("terms".into(), terms.to_vec().into());
    table.insert("identify".into(), identify.into());
    toml::to_string(&table).map_err(|error| faulty(error.to_string()))
}

fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale + 0.0
}

fn vector(v: &Vector3<f64>, decimals: i32) -> Value {
    v.iter().map(|&x| Value::from(rounded(x, decimals))).collect::<Vec<_>>().into()
}

/// A parallel or a meridian where it is one: people read those.
fn arc_table(arc: &Arc, mounting: &str) -> Value {
    let mut table = Table::new();
    let mut angle = |key: &str, rad: f64| {
        table.insert(key.into(), rounded(rad.to_degrees(), 6).into());
    };
    let upright = arc.normal.z.abs() > 1.0 - 1e-12;
    let lying = arc.normal.z.abs() < 1e-12 && arc.normal.dot(&arc.start).abs() < 1e-12;
    let start = &arc.start;
    let kind = if upright {
        angle("polar_deg", start.z.clamp(-1.0, 1.0).acos());
        angle("azimuth_deg", start.y.atan2(start.x));
        angle("sweep_deg", arc.sweep_rad * arc.normal.z.signum());
        "parallel"
    } else if lying {
        // About this normal a meridian rises from its azimuth; see `Arc::meridian`.
        let azimuth = arc.normal.y.atan2(arc.normal.x) + FRAC_PI_2;
        let along = start.x * azimuth.cos() + start.y * azimuth.sin();
        angle("azimuth_deg", azimuth);
        angle("start_deg", start.z.atan2(along));
        angle("sweep_deg", arc.sweep_rad);
        "meridian"
    } else {
        angle("sweep_deg", arc.sweep_rad);
        table.insert("start".into(), vector(start, DIRECTION_DECIMALS));
        table.insert("normal".into(), vector(&arc.normal, DIRECTION_DECIMALS));
        "circle"
    };
    table.insert("kind".into(), kind.into());
    table.insert("name".into(), arc.name.clone().into());
    table.insert("mountings".into(), vec![mounting.to_owned()].into());
    table.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::candidate_arcs;

    /// Written and read as a test file, every candidate arc is where it was, begun at either end.
    #[test]
    fn arcs_come_back_from_the_file() {
        let head = "name = 'T'\nmachine = 'm.toml'\n[ball_bar]\nlength_mm = 150.0\n[[mounting]]\nname = 'A'\n\
                    coincidence_mm = [0.0, 0.0, 0.0]\ntool_ball_mm = [0.0, 0.0, -200.0]\n";
        let forward = candidate_arcs(15.0_f64.to_radians());
        let arcs: Vec<Arc> = forward
            .iter()
            .cloned()
            .chain(forward.iter().map(|a| a.reversed(&format!("{} R", a.name))))
            .collect();
        let mut table: Table = toml::from_str(head).unwrap();
        let mut plan = Table::new();
        plan.insert("feed_mm_min".into(), 500.0.into());
        plan.insert(
            "arc".into(),
            arcs.iter().map(|a| arc_table(a, "A")).collect::<Vec<_>>().into(),
        );
        table.insert("plan".into(), plan.into());
        let text = toml::to_string(&table).unwrap();
        let back = Test::parse(&text, "t.toml".as_ref()).unwrap().plan().unwrap().arcs(0);
        assert_eq!(back.len(), arcs.len());
        for (arc, back) in arcs.iter().zip(&back) {
            for share in [0.0, 0.3, 1.0] {
                let off = (arc.at(share).into_inner() - back.at(share).into_inner()).norm();
                assert!(off < 1e-7, "{}: {off}", arc.name);
            }
        }
    }
}
