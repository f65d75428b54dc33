//! What the model said before anything was found, beside what it says with what was found.

use super::facts::{Analysis, Before, RepeatResult};
use super::machine_errors::MachineErrors;
use super::means::MeanResult;
use super::place::PlaceResult;
use super::run_facts::RunResult;
use crate::circular::{self, Driven};
use crate::compensate::{ErrorModel, Stored};
use crate::diagnose::{Diagnosis, ExtendedModel, Finding};
use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::Machine;
use crate::plan::Test;
use crate::report::circular::facts::CircularFacts;
use crate::report::diagnosis::facts::DiagnosisFacts;
use crate::report::ranked::facts::RankingFacts;

impl Analysis {
    /// Gathers what is told of a campaign and its diagnosis. Where something was found, the numbers are those of the
    /// extended model, and the earlier ones stand in `before`.
    pub fn diagnosed(
        test: &Test,
        machine: &Machine,
        campaign: &Campaign,
        diagnosis: &Diagnosis,
    ) -> Self {
        let stated = Self::gathered(test, machine, campaign);
        let facts = DiagnosisFacts::new(machine, &campaign.repeats, diagnosis);
        let (analysis, of) = match &diagnosis.extended {
            Some(by) => (stated.extended(by), (&by.test, &by.machine, &by.campaign)),
            None => (stated, (test, machine, campaign)),
        };
        let error_model = ErrorModel::of(test, machine, campaign, Some(diagnosis));
        let error_model = error_model.as_ref().map(Stored::of);
        Self { diagnosis: Some(facts), error_model, ..analysis }
            .with_circles(of, &diagnosis.findings)
    }

    /// The same with circular tests and the features of planes, of the campaign that it was gathered of.
    pub(super) fn with_circles(
        self,
        of: (&Test, &Machine, &Campaign),
        findings: &[Finding],
    ) -> Self {
        let numbered = self.repeats.iter().map(|repeat| repeat.repeat).zip(&of.2.repeats);
        let driven: Vec<(u32, Result<Driven>)> =
            numbered.map(|(number, repeat)| (number, circular::of(repeat))).collect();
        let circular = CircularFacts::new(of.0, &driven, &self.at_the_place);
        let ranking = RankingFacts::new(of, &driven, findings, self.diagnosis.as_ref());
        Self { circular, ranking, ..self }
    }

    /// The same test as the extended model has it.
    fn extended(self, by: &ExtendedModel) -> Self {
        let now = Self::gathered(&by.test, &by.machine, &by.campaign);
        let before = Before {
            repeats: self.repeats,
            over_repeats: self.over_repeats,
            at_the_place: self.at_the_place,
            machine_errors: self.machine_errors,
            cautions: self.cautions,
        };
        // Test and machine are told as their files state them.
        Self { test: self.test, machine: self.machine, before: Some(Box::new(before)), ..now }
    }

    /// A parameter over the repeats, without what was found.
    pub(super) fn mean_before(&self, name: &str) -> Option<&MeanResult> {
        self.before.as_ref()?.over_repeats.iter().find(|mean| mean.name == name)
    }

    /// What was asked, without what was found.
    pub(super) fn place_before(&self, quantity: &str) -> Option<&PlaceResult> {
        self.before.as_ref()?.at_the_place.iter().find(|result| result.quantity == quantity)
    }

    /// What single coefficients say, without what was found.
    pub(super) fn errors_before(&self) -> Option<&MachineErrors> {
        self.before.as_ref().map(|before| &before.machine_errors)
    }

    /// All runs with the same as it was without what was found.
    pub(super) fn runs_with_before(
        &self,
    ) -> impl Iterator<Item = (&RunResult, Option<&RunResult>)> {
        let before = self.before.iter().flat_map(|before| &before.repeats);
        let before = before.flat_map(|repeat| &repeat.runs).map(Some);
        self.runs().zip(before.chain(std::iter::repeat(None)))
    }

    /// Residual over all runs, root mean square, um; with what was found and without.
    pub(super) fn residual_rms_um(&self) -> (f64, Option<f64>) {
        (rms_um(&self.repeats), self.before.as_ref().map(|before| rms_um(&before.repeats)))
    }
}

fn rms_um(repeats: &[RepeatResult]) -> f64 {
    let used: usize = repeats.iter().map(|repeat| repeat.samples.used).sum();
    let square =
        |repeat: &RepeatResult| repeat.residual_rms_um.powi(2) * repeat.samples.used as f64;
    let squares: f64 = repeats.iter().map(square).sum::<f64>();
    (squares / used.max(1) as f64).sqrt()
}
