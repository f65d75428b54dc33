//! The same machine again: what changed, and what drifts.

use std::path::Path;

use serde_json::Value;

use crate::work::{Work, data};

/// A machine with errors of its own; its test is one plane.
const MACHINE: [(&str, f64); 8] = [
    ("EXX1", 3.0e-5),
    ("EYY1", -2.0e-5),
    ("EYX1", 1.5e-5),
    ("EXXb", 1.2e-3),
    ("EYYb", -0.8e-3),
    ("EYXb", 0.3e-3),
    ("EXY2", 2.0e-8),
    ("EYX3", 1.0e-10),
];

/// The machine with some errors otherwise, tested on a day; results lie in a folder of that name.
fn tested(work: &Work, folder: &str, day: &str, seed: u64, otherwise: &[(&str, f64)]) {
    let mut scenario = String::from("coincidence = \"touched\"\n[coefficients]\n");
    for (name, value) in MACHINE {
        let changed =
            otherwise.iter().find(|(of, _)| *of == name).map_or(value, |(_, value)| *value);
        scenario += &format!("{name} = {changed:e}\n").replace("e0\n", ".0\n");
    }
    work.write("scenario.toml", scenario);
    let seed = seed.to_string();
    work.machine("name", "name").test(&format!(
        "[plan]\nstrategy = \"xy\"\nfeed_mm_min = 1000.0\n[record]\ndate = {day}\n"
    ));
    let simulate =
        ["simulate", "test.toml", "--scenario", "scenario.toml", "--repeats", "2", "--seed", &seed];
    work.ballbar(&simulate).done();
    work.plain(&["analyse", "results/test.toml", "-o", folder]).done();
    std::fs::remove_dir_all(work.path("results")).unwrap();
}

fn compared(work: &Work, before: &str, after: &str) -> Value {
    let outcome = work.plain(&["compare", before, after, "--json"]).done();
    serde_json::from_str(&outcome.stdout()).unwrap()
}

/// Properties of the machine that a comparison says have changed.
fn changed(comparison: &Value) -> Vec<&str> {
    let quantities = comparison["quantities"].as_array().unwrap().iter();
    let of_machine = |name: &&str| !name.contains("plane");
    quantities
        .filter(|of| of["verdict"] == "changed")
        .map(|of| of["quantity"].as_str().unwrap())
        .filter(of_machine)
        .collect()
}

fn quantity<'a>(comparison: &'a Value, name: &str) -> &'a Value {
    let mut quantities = comparison["quantities"].as_array().unwrap().iter();
    quantities.find(|of| of["quantity"] == name).unwrap()
}

#[test]
fn exactly_what_was_changed_is_told() {
    let work = Work::new();
    tested(&work, "before", "2026-03-02", 1, &[]);
    tested(&work, "same", "2026-03-09", 2, &[]);
    let same = compared(&work, "before", "same/analysis.json");
    assert_eq!(changed(&same), Vec::<&str>::new(), "{:#}", same["verdict"]);
    assert_eq!(same["equal"], true);
    for (folder, error, value, told, difference) in [
        ("backlash", "EXXb", 3.2e-3, "reversal X", 4.0),
        ("squareness", "EYX1", 3.5e-5, "squareness XY", 20.0),
        ("scale", "EXX1", 5.0e-5, "scale X", 20.0),
    ] {
        tested(&work, folder, "2026-04-07", 3, &[(error, value)]);
        let comparison = compared(&work, "before", folder);
        assert_eq!(changed(&comparison), [told], "{:#}", comparison["verdict"]);
        let of = quantity(&comparison, told);
        let (by, sigma) = (of["difference"].as_f64().unwrap(), of["sigma"].as_f64().unwrap());
        assert!((by.abs() - difference).abs() < 3.0 * sigma, "{of:#}");
        // By itself neither test knows it so well.
        assert!(sigma <= of["after_sigma"].as_f64().unwrap() * 1.5, "{of:#}");
    }

    // As a page with pictures, and in words.
    let page = work.plain(&["compare", "before", "backlash", "-o", "pages/change.html"]).done();
    assert!(page.stdout().contains("Reversal X changed by -4."), "{}", page.stdout());
    assert!(page.stderr().contains("wrote pages/change.html"), "{}", page.stderr());
    let html = std::fs::read_to_string(work.path("pages/change.html")).unwrap();
    assert!(html.contains("Reversal X changed by") && html.matches("<svg").count() >= 2);
    assert!(html.contains("../backlash/analysis.json"), "named from the folder of the page");
}

#[test]
fn only_what_is_comparable_is_compared() {
    let work = Work::new();
    tested(&work, "before", "2026-03-02", 1, &[]);
    let source = std::fs::read_to_string(work.path("before/analysis.json")).unwrap();
    let mut other: Value = serde_json::from_str(&source).unwrap();
    let write = |other: &Value| work.write("other.json", other.to_string());

    other["test"]["mountings"][0]["bar_length_mm"] = 100.0.into();
    write(&other);
    let comparison = compared(&work, "before", "other.json");
    assert!(
        comparison["differences"].to_string().contains("two lengths, 150 and 100 mm"),
        "{comparison:#}"
    );
    let not = comparison["not_compared"].to_string();
    assert!(not.contains("straightness X in Y") && !not.contains("squareness"), "{not}");
    assert_eq!(comparison["equal"], false);
    // Independent: the root of the sum of the squares.
    let of = quantity(&comparison, "squareness XY");
    let all = of["before_sigma"].as_f64().unwrap();
    assert!((of["sigma"].as_f64().unwrap() / all - 2.0_f64.sqrt()).abs() < 1e-9, "{of:#}");

    other["machine"]["name"] = "Another".into();
    write(&other);
    let two = work.plain(&["compare", "before", "other.json"]).done();
    assert!(two.stdout().contains("These are two machines"), "{}", two.stdout());
}

#[test]
fn what_is_no_analysis_is_refused() {
    let work = Work::new();
    std::fs::create_dir(work.path("empty")).unwrap();
    for (text, told) in [
        (
            "{\"format\": \"ballbar.analysis/3\", \"program_version\": \"9.1\"}",
            "has the format `ballbar.analysis/3` (ballbar 9.1), and this program reads",
        ),
        ("{\"format\": \"ballbar.plan/1\"}", "this is a `ballbar.plan/1`, and not an analysis"),
        ("{}", "does not say its `format`"),
        ("{\"format\": \"ballbar.analysis/2\",\n\n \"test\": nonsense}", "--> one.json:3"),
        ("{\"format\": \"ballbar.analysis/2\"}", "missing field `test`"),
        ("", "this is not an analysis"),
    ] {
        work.write("one.json", text);
        let refused = work.plain(&["compare", "one.json", "one.json"]);
        assert_eq!(refused.code(), 1, "{}", refused.stderr());
        assert!(
            refused.stderr().contains(told) && refused.stderr().contains("\nhint: "),
            "{}",
            refused.stderr()
        );
    }
    let none = work.plain(&["compare", "empty", "empty"]);
    assert!(
        none.stderr().contains("there is no analysis.json in this folder"),
        "{}",
        none.stderr()
    );
    let none = work.plain(&["history", "empty"]);
    assert_eq!(none.code(), 1);
    assert!(none.stderr().contains("there is no analysis below this folder"), "{}", none.stderr());
}

/// Twelve months of a squareness that drifts, and beside them what cannot be used.
#[test]
fn a_year_of_tests_shows_what_drifts() {
    let work = Work::new();
    let per_month = 2.0e-6;
    for month in 1..=12_u32 {
        let square = 1.5e-5 + per_month * f64::from(month - 1);
        let day = format!("2026-{month:02}-15");
        tested(&work, &format!("tests/{day}"), &day, u64::from(month), &[("EYX1", square)]);
    }
    let copy = |to: &str, change: &dyn Fn(&mut Value)| {
        let text = std::fs::read_to_string(work.path("tests/2026-03-15/analysis.json")).unwrap();
        let mut analysis: Value = serde_json::from_str(&text).unwrap();
        change(&mut analysis);
        std::fs::create_dir_all(work.path(Path::new(to).parent().unwrap().to_str().unwrap()))
            .unwrap();
        work.write(to, analysis.to_string());
    };
    copy("tests/old/analysis.json", &|of| {
        of["format"] = "ballbar.analysis/0".into();
    });
    copy("tests/other/analysis.json", &|of| of["machine"]["name"] = "Another".into());
    copy("tests/undated/analysis.json", &|of| {
        of["test"]["readings_sha256"] = "0".into();
        of["test"].as_object_mut().unwrap().remove("date");
        of["test"]["record"] = Value::Null;
    });
    copy("tests/2026-03-15 again/my-analysis.json", &|_| ());
    work.write("tests/broken-analysis.json", "{\"format\": \"ballbar.analysis/2\",");
    work.write("tests/notes.json", "not looked at");

    let outcome = work.plain(&["history", "tests", "-o", "report", "--json"]).done();
    let history: Value = serde_json::from_str(&outcome.stdout()).unwrap();
    assert_eq!(history["tests"].as_array().unwrap().len(), 12);
    let series = history["series"].as_array().unwrap();
    let square = series.iter().find(|of| of["quantity"] == "squareness XY").unwrap();
    let trend = &square["trend"];
    let (slope, sigma) =
        (trend["per_year"].as_f64().unwrap(), trend["sigma_per_year"].as_f64().unwrap());
    // A month is not a twelfth of a year: fit what was put in to the same days.
    let day = |month: i8| {
        f64::from((jiff::civil::date(2026, month, 15) - jiff::civil::date(2026, 1, 15)).get_days())
    };
    let (mut product, mut spread) = (0.0, 0.0);
    let mean = (1..=12).map(day).sum::<f64>() / 12.0;
    for month in 1..=12 {
        product += (day(month) - mean) * 2.0 * f64::from(month - 1);
        spread += (day(month) - mean).powi(2);
    }
    let true_per_year = -product / spread * 365.25;
    assert!((slope - true_per_year).abs() < 3.0 * sigma, "{slope} {true_per_year} {sigma}");
    assert!(sigma < 0.25 * slope.abs(), "{slope} +- {sigma}");
    let drifting: Vec<&str> = series
        .iter()
        .filter(|of| of["trend"]["verdict"] == "drifts")
        .map(|of| of["quantity"].as_str().unwrap())
        .filter(|name| !name.contains("plane"))
        .collect();
    assert_eq!(drifting, ["squareness XY"]);

    let left_out = history["left_out"].as_array().unwrap();
    let reason = |file: &str| {
        let of = left_out.iter().find(|of| of["file"].as_str().unwrap().ends_with(file));
        of.unwrap_or_else(|| panic!("{file}: {left_out:#?}"))["reason"].as_str().unwrap().to_owned()
    };
    assert_eq!(left_out.len(), 5, "{left_out:#?}");
    for (file, told) in [
        ("tests/old/analysis.json", "has the format `ballbar.analysis/0`"),
        ("tests/other/analysis.json", "of another machine: `Another`"),
        ("tests/undated/analysis.json", "nothing says its day"),
        ("tests/broken-analysis.json", "this is not an analysis"),
    ] {
        assert!(reason(file).contains(told), "{file}: {}", reason(file));
        assert!(outcome.stderr().contains(file), "told on the way: {}", outcome.stderr());
    }
    assert!(
        left_out.iter().any(|of| of["reason"].as_str().unwrap().contains("the same readings as"))
    );

    let html = std::fs::read_to_string(work.path("report/history.html")).unwrap();
    assert!(html.contains("Squareness XY drifts by") && html.matches("<svg").count() > 10);
    let written = std::fs::read_to_string(work.path("report/history.json")).unwrap();
    assert_eq!(written, outcome.stdout());
    let other = work.plain(&["history", "tests", "--machine", "Another", "-o", "other"]).done();
    assert!(other.stdout().contains("A drift needs three"), "{}", other.stdout());
}

/// Every key that is written stands in the schema.
#[test]
fn every_field_is_documented() {
    let work = Work::new();
    let test = data("planar").join("test.toml");
    work.plain(&["analyse", test.to_str().unwrap(), "-o", "2026-01-01"]).done();
    std::fs::create_dir(work.path("pages")).unwrap();
    let schema = include_str!("../../docs/monitor-schema.md");
    let documented: Vec<&str> =
        schema.split('`').skip(1).step_by(2).flat_map(|code| code.split(['.', '['])).collect();
    let compared = compared(&work, "2026-01-01", "2026-01-01");
    let history = work.plain(&["history", ".", "-o", "pages", "--json"]).done();
    let history: Value = serde_json::from_str(&history.stdout()).unwrap();
    let mut open = vec![&compared, &history];
    let mut seen = 0;
    while let Some(value) = open.pop() {
        match value {
            Value::Object(fields) => {
                for (name, value) in fields {
                    let known = name == "format" || documented.contains(&name.as_str());
                    assert!(known, "`{name}` is not in the schema");
                    seen += 1;
                    open.push(value);
                }
            }
            Value::Array(values) => open.extend(values),
            _ => {}
        }
    }
    assert!(seen > 100, "{seen}");
}
