//! `analysis.json`, as `compare` and `history` read it.

use std::path::Path;
use std::sync::LazyLock;

use ballbar::monitor::{Comparison, History, Past};
use ballbar::report;

use super::{Target, accepted};

const SEED: &str = include_str!("../seeds/past.json");

/// The seed itself, and on two other days.
static OTHERS: LazyLock<Vec<Past>> = LazyLock::new(|| {
    let on = |day: &str, readings: &str| {
        let text = SEED.replace("2026-03-02", day).replace("\"readings_sha256\": \"", readings);
        Past::parse(text.as_bytes(), Path::new(day))
    };
    let days = [
        ("2026-03-02", "\"readings_sha256\": \""),
        ("2026-04-07", "\"x\": \""),
        ("2026-05-04", "\"y\": \""),
    ];
    let read: Vec<Past> =
        days.iter().filter_map(|(day, readings)| on(day, readings).ok()).collect();
    assert_eq!(read.len(), days.len(), "the seed is an analysis");
    read
});

pub const TARGET: Target = Target {
    name: "past",
    seeds: || vec![SEED.as_bytes().to_vec()],
    words: &[
        "ballbar.analysis/1",
        "ballbar.analysis/9",
        "format",
        "test",
        "date",
        "record",
        "mountings",
        "at_the_place",
        "quantity",
        "noise",
        "all",
        "plausible",
        "deviation",
        "circular",
        "tests",
        "ways",
        "diagnosis",
        "findings",
        "numbers",
        "sigma",
        "null",
        "true",
        "[",
        "]",
        "{",
        "}",
        "1e400",
        "-1e9",
        "1e-320",
        "0001-01-01",
        "9999-12-31",
        "2026-02-30",
    ],
    made: &[
        || b"[".repeat(1_000_000),
        || b"{\"a\":".repeat(200_000),
        || {
            let one = "{\"quantity\":\"scale X\",\"unit\":\"um\",\"value\":1}";
            format!("{{\"format\":\"ballbar.analysis/2\",\"test\":{{\"name\":\"t\"}},\"machine\":{{\"name\":\"m\",\"topology\":\"t\",\"pivots\":{{\"x\":\"\",\"y\":\"\",\"z\":\"\"}}}},\"at_the_place\":[{}]}}", vec![one; 9999].join(",")).into_bytes()
        },
    ],
    read,
};

fn read(input: &[u8]) -> bool {
    let past = Past::parse(input, Path::new("2026-03-09/analysis.json"));
    let read = accepted(&past);
    // A serial number may be called so.
    let named = input.windows(3).any(|word| word == b"NaN");
    let numbers = |page: String| named || !page.contains("NaN");
    if let Ok(past) = &past {
        let name = |past: &Past| past.file.display().to_string();
        for other in OTHERS.iter().take(1) {
            for both in [[other, past], [past, other]] {
                let comparison = Comparison::of(both[0], both[1]);
                assert!(
                    !report::comparison_text(&comparison, both).is_empty(),
                    "it says something"
                );
                let page = report::comparison_page(&comparison, both, &name);
                assert!(page.is_ok_and(numbers), "a page of numbers");
                let json = report::comparison_json(&comparison, both, &name);
                assert!(json["quantities"].is_array(), "a list");
            }
        }
    }
    let others = OTHERS.iter().map(|other| (other.file.clone(), Ok(other.clone())));
    let all = others.chain(std::iter::once(("2026-03-09/analysis.json".into(), past)));
    let (history, _) = History::of(all.collect(), None);
    if let Some(history) = history {
        let name = |file: &Path| file.display().to_string();
        let page = report::history_page(&history, &name);
        assert!(page.is_ok_and(numbers), "a page of numbers");
        assert!(!report::history_text(&history).is_empty(), "it says something");
        assert!(report::history_json(&history, &name)["series"].is_array(), "a list");
    }
    read
}
