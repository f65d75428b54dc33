//! What an identification says of a machine, for others to compute with.

use std::sync::Arc;

use crate::diagnose::{Diagnosis, Finding, Owner};
use crate::error::Result;
use crate::identify::{self, CHANGED, Campaign, Identification, SeenErrors};
use crate::machine::{Machine, Mounting};
use crate::model::{Form, HeldEffect, LOCAL, LocalFrame, Model, Parameter, Seat, Variable};
use crate::plan::Test;
use crate::solve::Matrix;

/// An effect that the model holds beside its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// The effect with its amplitudes.
    pub effect: HeldEffect,
    /// Standard deviation of its size, as a share of it.
    pub uncertain: f64,
}

impl Held {
    /// Whether it displaces a slide of a machine that stands still, or creeps: what hangs on speed, on time or on the way
    /// since a reversal does not, nor do balls and bar, which stay on the machine no longer than the test.
    fn at_rest(&self) -> bool {
        let still = |over: Option<Variable>| match over {
            Some(Variable::Position(_)) | None => true,
            Some(_) => false,
        };
        let (seat, over) = match &self.effect.form {
            Form::Cause(shape) => (shape.seat, shape.dependence().map(|of| of.variable)),
            Form::Empirical(curve) => (curve.seat, Some(curve.variable)),
        };
        let slide = matches!(seat, Seat::Function(..) | Seat::Slide(_) | Seat::Coefficient(_));
        slide && still(over)
    }
}

/// The errors of a machine where it was measured, with what is known of them.
#[derive(Debug, Clone)]
pub struct ErrorModel {
    /// The machine, its pivots as they were found.
    pub machine: Machine,
    /// Names of the mountings of the test, and where the balls were, as they were found; at least one.
    pub mountings: Vec<(String, Mounting)>,
    /// Length of the bar in each, mm.
    pub bar_lengths_mm: Vec<f64>,
    /// The place of the test.
    pub frame: Arc<LocalFrame>,
    /// The terms, those of the place among them.
    pub terms: Vec<String>,
    /// The parameters of the terms.
    pub parameters: Vec<Parameter>,
    /// Their values, mean over the repeats, in their units.
    pub values: Vec<f64>,
    /// Covariance of that mean by the noise.
    pub noise: Matrix,
    /// Covariance by what the test cannot tell from other plausible faults, which all repeats have in common.
    pub open: Matrix,
    /// The part of it by how the control may have driven.
    pub driven: Matrix,
    /// Effects beside the parameters: those that all runs had.
    pub held: Vec<Held>,
    /// By how many times their noise repeats of one test differ at the most, where that is more than [`CHANGED`]: the values are
    /// the mean of machines that were not the same.
    pub changed: Option<f64>,
}

impl ErrorModel {
    /// What a campaign says; `None` where it does not describe the machine where it was measured.
    pub fn of(
        test: &Test,
        machine: &Machine,
        campaign: &Campaign,
        diagnosis: Option<&Diagnosis>,
    ) -> Option<Self> {
        let findings = diagnosis.map_or(&[][..], |diagnosis| &diagnosis.findings);
        match diagnosis.and_then(|diagnosis| diagnosis.extended.as_ref()) {
            Some(now) => Self::gathered(&now.test, &now.machine, &now.campaign, findings),
            None => Self::gathered(test, machine, campaign, findings),
        }
    }

    fn gathered(
        test: &Test,
        machine: &Machine,
        campaign: &Campaign,
        findings: &[Finding],
    ) -> Option<Self> {
        let local = campaign.terms.iter().any(|term| term == LOCAL);
        let (Some(frame), Some(first), true) = (&campaign.frame, campaign.repeats.first(), local)
        else {
            return None;
        };
        let parameters = first.estimates.iter().map(|of| of.parameter.clone()).collect();
        let count = first.estimates.len();
        let seen = campaign.repeats.iter().map(Identification::seen_errors).collect();
        let of = Means { repeats: &campaign.repeats, seen, count };
        let of_file = test.estimation().curves.iter().map(|(curve, amplitudes)| Held {
            effect: HeldEffect {
                form: Form::Empirical(curve.clone()),
                amplitudes: amplitudes.clone(),
                run: None,
                earlier_s: 0.0,
            },
            uncertain: 0.0,
        });
        let own = of.own();
        let between = of.between();
        let changed = between.as_ref().and_then(|between| of.changed(&own, between));
        let scatter = between.filter(|_| changed.is_some());
        Some(Self {
            machine: machine.clone(),
            mountings: test.mountings().iter().map(|m| (m.name.clone(), m.mounting)).collect(),
            bar_lengths_mm: test.mountings().iter().map(|m| m.bar_length_mm).collect(),
            frame: Arc::clone(frame),
            terms: campaign.terms.clone(),
            parameters,
            values: of.values(),
            noise: of.noise(&own, scatter.as_ref()),
            open: of.covariance(|of| of.left_open.as_ref()),
            driven: of.covariance(|of| of.driven.as_ref()),
            held: of_file.chain(held(campaign, findings)).filter(Held::at_rest).collect(),
            changed,
        })
    }

    /// The model with another tool in the place of the first mounting, and the index of its mounting: set-up errors
    /// of the balls are not in it.
    ///
    /// # Errors
    /// When a term is not known.
    pub fn model(&self, tool: &Mounting) -> Result<(Model<'_>, usize)> {
        let names: Vec<String> = self.mountings.iter().map(|(name, _)| name.clone()).collect();
        let mut mountings: Vec<Mounting> = self.mountings.iter().map(|(_, of)| *of).collect();
        let balls = Mounting { coincidence_mm: mountings[0].coincidence_mm, ..*tool };
        mountings.push(balls);
        let (middle_mm, reach_mm) = (self.frame.middle_mm, self.frame.reach_mm);
        let ends_mm = [middle_mm - reach_mm, middle_mm + reach_mm];
        let frame = LocalFrame::around(&self.machine, &mountings, ends_mm.into_iter());
        let frame = frame.map(Arc::new);
        let mut terms = identify::terms(&self.terms, frame.as_ref(), &self.machine, &names)?;
        for held in &self.held {
            terms.push(Box::new(held.effect.clone()));
        }
        let tool = mountings.len() - 1;
        Ok((Model::new(&self.machine, mountings, terms), tool))
    }
}

/// What is the machine's own of what a campaign holds beside its parameters. The effects of findings stand in their order;
/// those that differ from run to run, or that one run had, are none of the machine's.
fn held<'a>(campaign: &'a Campaign, findings: &'a [Finding]) -> impl Iterator<Item = Held> + 'a {
    let of_machine = campaign.held.first().into_iter().flatten().filter(|of| of.run.is_none());
    let found = findings.iter().filter(|finding| finding.owner() == Owner::All);
    of_machine.zip(found).map(|(effect, finding)| {
        let size = finding.numbers.first();
        let uncertain = size.and_then(|of| Some(of.sigma? / of.value.abs()));
        let uncertain = uncertain.filter(|share| share.is_finite()).unwrap_or(0.0);
        Held { effect: effect.clone(), uncertain: uncertain.min(1.0) }
    })
}

/// Of a parameter that readings determine by less than this nothing is seen that could change.
const SEEN: f64 = 0.5;

/// Means over the repeats. Noise is another one every time; what a test leaves open is the same, and so is what is not
/// known of effects.
struct Means<'a> {
    repeats: &'a [Identification],
    /// What each of them sees.
    seen: Vec<SeenErrors>,
    count: usize,
}

impl Means<'_> {
    /// Mean over the repeats of a number.
    fn mean(&self, of: impl Fn(&SeenErrors) -> f64) -> f64 {
        self.seen.iter().map(of).sum::<f64>() / self.seen.len() as f64
    }

    fn values(&self) -> Vec<f64> {
        (0..self.count).map(|k| self.mean(|of| of.values[k])).collect()
    }

    /// Covariance of the mean: repeats do not scatter by less than they do.
    fn noise(&self, own: &Matrix, scatter: Option<&Matrix>) -> Matrix {
        let in_common = |of: &SeenErrors| of.effects.as_ref().map_or(0, Matrix::columns);
        let width = self.seen.iter().map(in_common).min().unwrap_or(0);
        let common = Matrix::from_fn(self.count, width, |i, k| {
            self.mean(|of| of.effects.as_ref().map_or(0.0, |effects| effects[(i, k)]))
        });
        let repeats = self.repeats.len() as f64;
        let of_common = common.times_own_transpose();
        Matrix::from_fn(self.count, self.count, |i, k| {
            let scatter = scatter.map_or(0.0, |between| between[(i, k)]);
            (own[(i, k)] + scatter) / repeats + of_common[(i, k)]
        })
    }

    /// Covariance of one repeat by its own noise, in the mean.
    fn own(&self) -> Matrix {
        let repeats = self.repeats.len() as f64;
        let each: Vec<Matrix> =
            self.seen.iter().filter_map(|of| squared(of.effects.as_ref())).collect();
        Matrix::from_fn(self.count, self.count, |i, k| {
            let all = self.mean(|of| of.covariance[(i, k)]);
            let shared = each.iter().map(|of| of[(i, k)]).sum::<f64>() / repeats;
            all - shared
        })
    }

    /// Covariance of the values between the repeats; `None` of one, and where they are not of one test.
    fn between(&self) -> Option<Matrix> {
        let means = self.values();
        let freedom = self.repeats.len() as f64 - 1.0;
        let from_mean = Matrix::from_fn(self.count, self.repeats.len(), |k, repeat| {
            (self.seen[repeat].values[k] - means[k]) / freedom.sqrt()
        });
        let scatters = freedom > 0.0 && identify::of_one_test(self.repeats);
        scatters.then(|| from_mean.times_own_transpose())
    }

    /// By how many times their own noise the repeats differ at the most; `None` where that is within [`CHANGED`].
    fn changed(&self, own: &Matrix, between: &Matrix) -> Option<f64> {
        let seen = |k: &usize| self.repeats.iter().all(|of| of.estimates[*k].observed > SEEN);
        let ratios = (0..self.count).filter(seen).map(|k| (between[(k, k)] / own[(k, k)]).sqrt());
        ratios.filter(|ratio| *ratio > CHANGED && ratio.is_finite()).reduce(f64::max)
    }

    fn covariance<'b>(&'b self, of: impl Fn(&'b SeenErrors) -> Option<&'b Matrix>) -> Matrix {
        let each: Vec<Matrix> = self.seen.iter().filter_map(|one| squared(of(one))).collect();
        let repeats = self.repeats.len() as f64;
        Matrix::from_fn(self.count, self.count, |i, k| {
            each.iter().map(|of| of[(i, k)]).sum::<f64>() / repeats
        })
    }
}

fn squared(of: Option<&Matrix>) -> Option<Matrix> {
    of.filter(|of| of.columns() > 0).map(Matrix::times_own_transpose)
}
