//! From identified runs to [`RankingFacts`].

use super::facts::{FeatureResult, RankingFacts, RankingResult};
use super::words;
use crate::circular::Driven;
use crate::diagnose::Finding;
use crate::error::Result;
use crate::features::{self, Feature, Ranking};
use crate::identify::Campaign;
use crate::machine::{Axis, Machine};
use crate::plan::Test;
use crate::report::circular;
use crate::report::diagnosis::facts::DiagnosisFacts;
use crate::report::text::numbers::finite;

const UM: f64 = 1e3;

impl RankingFacts {
    /// Gathers the features of a campaign, whose repeats have these numbers and circular tests; `findings` and `diagnosis` are
    /// what it was extended by, and what is told of that.
    pub(in crate::report) fn new(
        of: (&Test, &Machine, &Campaign),
        repeats: &[(u32, Result<Driven>)],
        findings: &[Finding],
        diagnosis: Option<&DiagnosisFacts>,
    ) -> Self {
        let mut facts = Self::default();
        let far_off: Vec<Axis> = of.2.turning_far_off().into_iter().map(|(axis, _)| axis).collect();
        for (index, (repeat, driven)) in repeats.iter().enumerate() {
            // What could not be fitted is told with the circular tests.
            let Ok(driven) = driven else { continue };
            match features::of(of, findings, index, &driven.tests) {
                Ok(of_repeat) => {
                    let told =
                        |ranking: &Ranking| result(of.0, *repeat, ranking, diagnosis, &far_off);
                    facts.tests.extend(of_repeat.iter().map(told));
                }
                Err(error) => facts.untold.push(format!("Repeat {repeat}: {}.", error.what)),
            }
        }
        facts
    }
}

fn result(
    test: &Test,
    repeat: u32,
    of: &Ranking,
    diagnosis: Option<&DiagnosisFacts>,
    far_off: &[Axis],
) -> RankingResult {
    let findings = diagnosis.map_or(&[][..], |diagnosis| &diagnosis.findings);
    let not_found = diagnosis.map(|_| words::not_found(&of.features, findings, far_off));
    RankingResult {
        repeat,
        test: circular::words::test_name(&circular::gather::result(test, repeat, of.test)),
        deviation: if of.test.bidirectional.is_some() { "G(b)" } else { "G" },
        deviation_um: of.test.deviation().map_or(0.0, |of| of.value_mm * UM),
        volumetric_um: of.volumetric_mm.map(|mm| mm * UM),
        features: of
            .features
            .iter()
            .map(|feature| FeatureResult {
                feature: words::name(feature, findings),
                in_words: words::sign(feature, findings),
                what_to_do: words::what_to_do(feature, findings),
                ..numbers(feature)
            })
            .collect(),
        untold_fall_um: of.untold_fall_mm * UM + 0.0,
        left_um: of.left_mm * UM,
        commanded_um: of.commanded_mm * UM,
        unexplained_um: of.unexplained_mm * UM,
        not_found: not_found.unwrap_or_default(),
        smallest_um: diagnosis.and_then(|diagnosis| finite(diagnosis.of_all.smallest_mm * UM)),
    }
}

fn numbers(of: &Feature) -> FeatureResult {
    let um = |mm: Option<f64>| mm.and_then(|mm| finite(mm * UM));
    FeatureResult {
        feature: String::new(),
        in_words: String::new(),
        what_to_do: "",
        unit: of.unit,
        value: of.value + 0.0,
        positive_end: of.at_ends.map(|[positive, _]| positive + 0.0),
        negative_end: of.at_ends.map(|[_, negative]| negative + 0.0),
        noise: of.noise.and_then(finite),
        all: of.all.and_then(finite),
        told_apart_from_0: of.is_told(),
        size_um: um(of.size_mm),
        share_percent: of.share.and_then(|share| finite(share * 100.0)),
        fall_um: of.fall_mm * UM + 0.0,
        fall_noise_um: um(of.fall_noise_mm),
        fall_all_um: um(of.fall_all_mm),
        volumetric_fall_um: um(of.volumetric_fall_mm),
        left_um: um(of.then.map(|left| left.deviation_mm)),
        volumetric_left_um: um(of.then.and_then(|left| left.volumetric_mm)),
    }
}
