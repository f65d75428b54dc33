//! A history as JSON; the schema is documented field by field in `docs/monitor-schema.md`.

use std::path::Path;

use serde_json::{Value, json};

use super::words;
use crate::monitor::{History, LeftOut, Series};
use crate::report::comparison::facts::told;

/// The tests and every quantity over time, without the name of the format; `name` says how files are called.
pub fn history_json(history: &History, name: &dyn Fn(&Path) -> String) -> Value {
    let tests = history.tests.iter().map(|(day, past)| {
        let mut test = told(past, &name(&past.file));
        test["date"] = day.to_string().into();
        test
    });
    json!({
        "machine": history.machine,
        "tests": tests.collect::<Vec<_>>(),
        "verdict": words::verdict(history),
        "series": history.series.iter().map(series).collect::<Vec<_>>(),
        "left_out": history.left_out.iter().map(|of| left_out(of, name)).collect::<Vec<_>>(),
    })
}

fn left_out(of: &LeftOut, name: &dyn Fn(&Path) -> String) -> Value {
    json!({ "file": name(&of.file), "reason": of.reason })
}

fn series(of: &Series) -> Value {
    let points: Vec<Value> = of
        .points
        .iter()
        .map(|point| {
            json!({
                "test": point.test,
                "date": point.day.to_string(),
                "equal_to": point.kind,
                "value": point.value,
                "noise": point.noise,
                "all": point.all,
            })
        })
        .collect();
    let trend = of.trend.map(|trend| {
        json!({
            "per_year": trend.per_year,
            "noise_per_year": trend.noise,
            "sigma_per_year": trend.sigma,
            "scatter": trend.scatter,
            "verdict": words::judged(trend),
        })
    });
    json!({ "quantity": of.name, "unit": of.unit, "points": points, "trend": trend })
}
