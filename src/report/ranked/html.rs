//! The ranked features in the report.

use askama::Template;

use super::facts::{FeatureResult, RankingFacts, RankingResult};
use super::terminal;
use crate::error::{Error, Kind, Result};
use crate::report::text::numbers::{fixed, signed, typeset};
use crate::report::text::words::fine;

#[derive(Template)]
#[template(path = "ranked.html")]
struct Section {
    tests: Vec<Ranked>,
    meaning: String,
}

struct Ranked {
    title: String,
    falls: String,
    volumetric: bool,
    rows: Vec<Row>,
    sentences: Vec<String>,
}

struct Row {
    told: bool,
    cells: [String; 9],
}

/// The worst circular test on page one.
pub(in crate::report) struct InShort {
    /// The test and its deviation.
    pub(in crate::report) title: String,
    /// What falls: `G(b)`.
    pub(in crate::report) deviation: &'static str,
    pub(in crate::report) rows: Vec<ShortRow>,
    /// So many features are in the section only.
    pub(in crate::report) more: usize,
}

/// A feature on page one.
pub(in crate::report) struct ShortRow {
    pub(in crate::report) feature: String,
    pub(in crate::report) value: String,
    /// The side, in words.
    pub(in crate::report) words: String,
    /// Of the value, by all that is not known; with terms that were named by the noise.
    pub(in crate::report) uncertain: String,
    pub(in crate::report) share: String,
    pub(in crate::report) fall: String,
    /// With those above it gone as well.
    pub(in crate::report) left: String,
    /// It stands out of what is not known of it.
    pub(in crate::report) told: bool,
}

/// The features of the test with the largest deviation, the first of them; `None` where no test has any.
pub(in crate::report) fn in_short(facts: &RankingFacts, most: usize) -> Option<InShort> {
    let shown = terminal::worst_repeats(facts);
    let worst = shown.into_iter().max_by(|a, b| a.deviation_um.total_cmp(&b.deviation_um))?;
    let row = |of: &FeatureResult| {
        let Row { told, cells: [feature, value, noise, all, share, _, words, _, left] } = row(of);
        let uncertain = if of.all.is_some() { all } else { noise };
        let fall = typeset(&signed(of.fall_um, 2));
        ShortRow { feature, value, words, uncertain, share, fall, left, told }
    };
    Some(InShort {
        title: format!("{}, {} {} µm", worst.test, worst.deviation, fixed(worst.deviation_um, 1)),
        deviation: worst.deviation,
        rows: worst.features.iter().take(most).map(row).collect(),
        more: worst.features.len().saturating_sub(most),
    })
}

/// The tables, as HTML without a page around them; empty where there are none.
pub(in crate::report) fn section(facts: &RankingFacts) -> Result<String> {
    let shown = terminal::worst_repeats(facts);
    if shown.is_empty() {
        return Ok(String::new());
    }
    let section = Section {
        tests: shown.into_iter().map(ranked).collect(),
        meaning: fine(terminal::MEANING),
    };
    section.render().map_err(|error| {
        Error::new(Kind::Output, format!("the ranked features cannot be rendered: {error}"))
    })
}

fn ranked(test: &RankingResult) -> Ranked {
    let deviation_um = fixed(test.deviation_um, 2);
    Ranked {
        title: format!("{}, {} {deviation_um} µm", test.test, test.deviation),
        falls: format!("{} falls by, µm", test.deviation),
        volumetric: test.volumetric_um.is_some(),
        rows: test.features.iter().map(row).collect(),
        sentences: terminal::sentences(test).iter().map(|sentence| fine(sentence)).collect(),
    }
}

fn row(of: &FeatureResult) -> Row {
    let [value, noise, all] = terminal::values(of).map(|cell| typeset(&cell));
    let uncertain = of.fall_all_um.map_or_else(String::new, |um| format!(" ± {}", fixed(um, 2)));
    let fall = format!("{}{uncertain}", typeset(&signed(of.fall_um, 2)));
    let volumetric = of.volumetric_fall_um.map_or("–".to_owned(), |um| typeset(&signed(um, 2)));
    let words = if of.told_apart_from_0 { of.in_words.as_str() } else { "not told apart from 0" };
    Row {
        told: of.told_apart_from_0,
        cells: [
            of.feature.clone(),
            format!("{value} {}", fine(&format!(" {}", of.unit)).trim()),
            noise,
            all,
            terminal::share(of),
            fall,
            words.to_owned(),
            volumetric,
            terminal::left(of).replace('-', "–"),
        ],
    }
}
