//! The same measurements identified otherwise: with effects held beside the terms, or as other files have them.

use std::sync::Arc;

use rayon::prelude::*;

use super::campaign::Campaign;
use super::fit::{identify, identify_on, leaves_mm};
use super::input::Options;
use super::result::Identification;
use super::settle::HARDLY;
use crate::error::Result;
use crate::machine::Machine;
use crate::model::{HeldEffect, Model};
use crate::plan::Test;

impl Campaign {
    /// What fits of the same alignments would leave as another test and another machine have them, mm².
    ///
    /// # Errors
    /// When a repeat cannot be fitted so.
    pub fn would_leave_mm2(&self, test: &Test, machine: &Machine) -> Result<f64> {
        let options = Options::of(test);
        let each = self.repeats.par_iter().enumerate().map(|(index, repeat)| {
            let model = self.model(test, machine, index)?;
            let left_mm = leaves_mm(&model, repeat.again(), &options)?;
            Ok(left_mm.powi(2) * repeat.used as f64)
        });
        Ok(each.collect::<Result<Vec<f64>>>()?.iter().sum())
    }

    /// The same repeats identified with effects held beside the terms, one list a repeat: from the beginning, as what was missing
    /// may have led its times astray. Where that leaves more than without the effects, by more than two fits at rest do, it is what has
    /// gone astray; from where the repeat came to rest without them it may leave less.
    ///
    /// # Errors
    /// When a repeat cannot be identified so.
    pub fn with_held(
        &self,
        test: &Test,
        machine: &Machine,
        held: Vec<Vec<HeldEffect>>,
    ) -> Result<Self> {
        self.held_by(test, machine, held, &|model, repeat, options| {
            let afresh = identify(model, repeat.afresh(), options);
            let more_mm2 = |fit: &Identification| {
                repeat.used as f64 * (fit.rms_mm.powi(2) - repeat.rms_mm.powi(2))
            };
            let rests_mm2 = HARDLY * repeat.counts_mm.powi(2);
            if afresh.as_ref().is_ok_and(|fit| more_mm2(fit) < rests_mm2) {
                return afresh;
            }
            match (afresh, identify_on(model, repeat.again(), repeat, options)) {
                (Ok(afresh), Ok(on)) => Ok(if on.rms_mm < afresh.rms_mm { on } else { afresh }),
                (afresh, on) => afresh.or(on),
            }
        })
    }

    /// The same with effects in the place of those that it holds, which hardly differ from them: from where it came to rest.
    ///
    /// # Errors
    /// When a repeat cannot be identified so.
    pub fn with_held_anew(
        &self,
        test: &Test,
        machine: &Machine,
        held: Vec<Vec<HeldEffect>>,
    ) -> Result<Self> {
        self.held_by(test, machine, held, &|model, repeat, options| {
            identify_on(model, repeat.again(), repeat, options)
        })
    }

    fn held_by(
        &self,
        test: &Test,
        machine: &Machine,
        held: Vec<Vec<HeldEffect>>,
        identified: &(dyn Fn(&Model, &Identification, &Options) -> Result<Identification> + Sync),
    ) -> Result<Self> {
        let options = Options::of(test);
        let extended = Self {
            terms: self.terms.clone(),
            frame: self.frame.clone(),
            repeats: Vec::new(),
            held,
            left_out: self.left_out.clone(),
            measured: Arc::clone(&self.measured),
        };
        let each = self.repeats.par_iter().enumerate();
        let repeats = each.map(|(index, repeat)| {
            identified(&extended.model(test, machine, index)?, repeat, &options)
        });
        let repeats = repeats.collect::<Result<Vec<_>>>()?;
        Ok(Self { repeats, ..extended })
    }
}
