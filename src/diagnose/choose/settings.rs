//! What the machine file or the test file may state wrong: pivots, and the places of the balls.
//!
//! With another setting all lengths change, and what the coefficients of the model do not follow of the
//! change is a column `c'` as that of an effect. Where one explains more than any cause or curve does, the
//! campaign is identified again as if it were so, through the exact chain, and only what the sum of squares
//! really falls by counts.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::search::{MOST_EFFECTS, Search};
use crate::diagnose::thresholds::{FOLLOWED, threshold_mm2};
use crate::error::Result;
use crate::identify::Campaign;
use crate::machine::{Axis, Machine, Mounting, Pivot};
use crate::model::{BALL_PLACE, Ball, Effect, PIVOT, Seat, SetUp, Situation};
use crate::plan::Test;
use crate::residual::{Beside, Column, Residuals, Sample};

/// So many settings are corrected at most.
const MOST: usize = 3;
/// Settings that are tried through the exact chain.
const CLOSELY: usize = 3;
/// Tried is what would explain at least this part of what the best cause does: a place that is far off may explain more
/// than a first step towards it says.
const WORTH_TRYING: f64 = 0.5;
/// And what by a first look through the exact chain explains at least this part of what it must.
const WORTH_IDENTIFYING: f64 = 0.9;
/// Steps towards the place of a ball.
const MOST_STEPS: usize = 6;
/// A place is tried this far away to see what it changes, mm.
const ASIDE_MM: f64 = 1.0;
/// No step is longer, mm: errors are cubics.
const LONGEST_MM: f64 = 60.0;

/// Something that a file states and these runs contradict.
#[derive(Debug, Clone, PartialEq)]
pub struct WrongSetting {
    /// What is so in truth, as an effect.
    pub effect: Effect,
    /// Standard deviation of the ball's place, mm; `None` for a pivot.
    pub sigma_mm: Option<f64>,
    /// Residual with the setting as it is stated, mm rms.
    pub before_mm: f64,
    /// And as it is in truth.
    pub after_mm: f64,
}

/// A campaign as it is with other settings.
#[derive(Debug)]
pub(crate) struct Corrected {
    pub(crate) test: Test,
    pub(crate) machine: Machine,
    pub(crate) campaign: Campaign,
    pub(crate) wrong: Vec<WrongSetting>,
}

/// A setting that may be another one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Setting {
    Pivot(Axis),
    /// A ball in one mounting, or in all.
    Place(SetUp, Option<usize>),
}

/// What a setting would change.
struct Tried {
    setting: Setting,
    /// Of which setting would explain most, in its unit.
    amount: f64,
    sigma: f64,
    gain_mm2: f64,
}

impl Tried {
    /// Whether a first look through the exact chain gains so much. Where all poses are others, or other terms may be the
    /// complete ones, nobody has looked.
    fn may_gain(&self, test: &Test, machine: &Machine, campaign: &Campaign, mm2: f64) -> bool {
        if self.setting.moves_poses() || matches!(self.setting, Setting::Pivot(_)) {
            return true;
        }
        let amount_mm = self.amount.clamp(-LONGEST_MM, LONGEST_MM);
        let (test, machine) = self.setting.applied(test, machine, amount_mm);
        let left_mm2 = campaign.would_leave_mm2(&test, &machine);
        left_mm2.is_ok_and(|left_mm2| campaign.leaves_mm2() - left_mm2 > mm2)
    }
}

impl Setting {
    /// Whether every pose is another one with it.
    fn moves_poses(self) -> bool {
        matches!(self, Self::Place(SetUp { ball: Ball::Workpiece, .. }, _))
    }

    /// All that the model is sensitive to. With one mounting, a place is nothing but other coefficients.
    fn all(test: &Test, campaign: &Campaign) -> Vec<Self> {
        let turns = |slide: &Axis| {
            let estimates = campaign.repeats.iter().flat_map(|repeat| &repeat.estimates);
            let mut turning = estimates.filter_map(|e| {
                let of = crate::model::Coefficient::parse(&e.parameter.name)?;
                (of.slide == *slide && of.component.is_angular()).then_some(())
            });
            turning.next().is_some()
        };
        let mut all: Vec<Self> = Axis::ALL.into_iter().filter(turns).map(Self::Pivot).collect();
        let count = test.mountings().len();
        if count > 1 {
            let balls = [Ball::Tool, Ball::Workpiece];
            let balls =
                balls.into_iter().flat_map(|ball| Axis::ALL.map(|axis| SetUp { ball, axis }));
            all.extend(balls.flat_map(|ball| {
                let each = (0..count).map(Some).chain([None]);
                each.map(move |mounting| Self::Place(ball, mounting))
            }));
        }
        all
    }

    /// The files with this setting changed.
    fn applied(self, test: &Test, machine: &Machine, amount_mm: f64) -> (Test, Machine) {
        match self {
            Self::Pivot(slide) => {
                let other = match machine.slide(slide).pivot {
                    Pivot::Carriage => Pivot::Base,
                    Pivot::Base => Pivot::Carriage,
                };
                (test.clone(), machine.clone().with_pivot(slide, other))
            }
            Self::Place(of, mounting) => {
                let mut moved = test.clone();
                for (index, named) in test.mountings().iter().enumerate() {
                    if mounting.is_none_or(|one| one == index) {
                        let Mounting { mut coincidence_mm, mut tool_ball_mm } = named.mounting;
                        match of.ball {
                            Ball::Tool => tool_ball_mm[of.axis.index()] += amount_mm,
                            Ball::Workpiece => coincidence_mm[of.axis.index()] += amount_mm,
                        }
                        moved = moved.with_balls(index, Mounting { coincidence_mm, tool_ball_mm });
                    }
                }
                (moved, machine.clone())
            }
        }
    }

    /// As an effect on what the files say.
    fn effect(self, amount_mm: f64) -> Effect {
        match self {
            Self::Pivot(slide) => Effect::new(&PIVOT, Seat::Slide(slide), Vec::new()),
            Self::Place(of, mounting) => {
                let number = mounting.map_or(0.0, |index| index as f64 + 1.0);
                let seat = Seat::Ball(of);
                Effect::new(&BALL_PLACE, seat, vec![amount_mm, number])
            }
        }
    }

    /// The part of a column over all mountings that is this setting's.
    fn of_mountings(self, residuals: &Residuals, column: &Column) -> Column {
        let Self::Place(_, Some(mounting)) = self else { return column.clone() };
        let repeats = column.iter().zip(&residuals.repeats);
        repeats
            .map(|(column, repeat)| {
                let samples = column.iter().zip(&repeat.samples);
                let here = |at: usize| if at == mounting { 1.0 } else { 0.0 };
                samples.map(|(c, sample)| c * here(sample.situation.mounting)).collect()
            })
            .collect()
    }

    /// The same in all mountings.
    fn everywhere(self) -> Self {
        match self {
            Self::Place(of, _) => Self::Place(of, None),
            pivot @ Self::Pivot(_) => pivot,
        }
    }
}

/// The campaign and what its model predicts at the samples.
struct Stated<'a> {
    test: &'a Test,
    machine: &'a Machine,
    campaign: &'a Campaign,
    lengths_mm: Column,
}

impl<'a> Stated<'a> {
    fn new(
        residuals: &Residuals,
        test: &'a Test,
        machine: &'a Machine,
        campaign: &'a Campaign,
    ) -> Result<Self> {
        let lengths_mm = lengths_mm(residuals, campaign, (test, machine), None)?;
        Ok(Self { test, machine, campaign, lengths_mm })
    }

    /// What the lengths change by with a setting, in all mountings, times the root of the weight; per
    /// [`ASIDE_MM`] of a place.
    fn column(&self, residuals: &Residuals, setting: Setting) -> Result<Column> {
        let (test, machine) = setting.everywhere().applied(self.test, self.machine, ASIDE_MM);
        let mut column = lengths_mm(residuals, self.campaign, (&test, &machine), Some(self.test))?;
        let repeats = column.iter_mut().zip(self.lengths_mm.iter()).zip(&residuals.repeats);
        for ((column, stated), repeat) in repeats {
            for ((c, stated), sample) in column.iter_mut().zip(stated).zip(&repeat.samples) {
                *c = (*c - stated) * sample.root_weight;
            }
        }
        Ok(column)
    }
}

/// Lengths that the model of a campaign predicts under some files; poses are shifted by what the balls of
/// the first test lie aside from those of the `stated` one.
fn lengths_mm(
    residuals: &Residuals,
    campaign: &Campaign,
    (test, machine): (&Test, &Machine),
    stated: Option<&Test>,
) -> Result<Column> {
    let at = |test: &Test, mounting: usize| test.mountings()[mounting].mounting.coincidence_mm;
    let shift = |mounting: usize| match stated {
        Some(stated) => at(test, mounting) - at(stated, mounting),
        None => Vector3::zeros(),
    };
    let repeats = residuals.repeats.par_iter().enumerate().map(|(index, repeat)| {
        let values = campaign.repeats[index].values();
        let model = campaign.model(test, machine, index)?;
        let length = |sample: &Sample| {
            let Situation { mut pose, motion, mounting, .. } = sample.situation;
            pose.position_mm += shift(mounting);
            model.length_mm(&values, &pose, &motion, mounting)
        };
        Ok(repeat.samples.iter().map(length).collect())
    });
    Ok(Column::from(repeats.collect::<Result<Vec<Vec<f64>>>>()?))
}

/// The campaign with what is stated wrong put right, `None` where nothing is; and its residuals.
pub(crate) fn corrected(
    test: &Test,
    machine: &Machine,
    campaign: &Campaign,
) -> Result<(Option<Corrected>, Residuals)> {
    let mut residuals = Residuals::of(test, machine, campaign)?;
    let mut best: Option<Corrected> = None;
    for _ in 0..MOST {
        let (test, machine, campaign) = match &best {
            Some(now) => (&now.test, &now.machine, &now.campaign),
            None => (test, machine, campaign),
        };
        let Some(mut next) = step(test, machine, campaign, &residuals)? else { break };
        residuals = Residuals::of(&next.test, &next.machine, &next.campaign)?;
        if let Some(before) = best.take() {
            next.wrong.splice(0..0, before.wrong);
        }
        best = Some(next);
    }
    Ok((best, residuals))
}

/// Puts one setting right.
fn step(
    test: &Test,
    machine: &Machine,
    campaign: &Campaign,
    residuals: &Residuals,
) -> Result<Option<Corrected>> {
    let settings = Setting::all(test, campaign);
    if settings.is_empty() {
        return Ok(None);
    }
    let alone = residuals.alone();
    let least_mm2 = threshold_mm2(&alone);
    let stated = Stated::new(residuals, test, machine, campaign)?;
    let mut tried = Vec::new();
    let mut last: Option<(Setting, Column)> = None;
    for setting in settings {
        let known = last.take_if(|(of, _)| *of == setting.everywhere());
        let column = match known {
            Some((_, column)) => column,
            None => stated.column(residuals, setting)?,
        };
        let own = setting.of_mountings(residuals, &column);
        tried.extend(explained(&alone, setting, &own));
        last = Some((setting.everywhere(), column));
    }
    tried.retain(|tried| tried.gain_mm2 > least_mm2);
    if tried.is_empty() {
        return Ok(None);
    }
    let cause = Search::new(residuals, campaign).next(None, true, MOST_EFFECTS);
    let best_cause_mm2 = cause.map_or(0.0, |(_, score_mm2)| score_mm2);
    tried.retain(|tried| tried.gain_mm2 > WORTH_TRYING * best_cause_mm2);
    tried.sort_by(|a, b| b.gain_mm2.total_cmp(&a.gain_mm2));
    let mut best: Option<(Corrected, f64)> = None;
    let before_mm2 = alone.left_mm2();
    let enough_mm2 = least_mm2.max(best_cause_mm2);
    tried.truncate(CLOSELY);
    tried.retain(|tried| tried.may_gain(test, machine, campaign, WORTH_IDENTIFYING * enough_mm2));
    for first in &tried {
        if best.as_ref().is_some_and(|(_, after_mm2)| before_mm2 - after_mm2 > first.gain_mm2) {
            break;
        }
        if let Some(now) = exactly(test, machine, campaign, first)?
            && best.as_ref().is_none_or(|(_, squares_mm2)| now.1 < *squares_mm2)
        {
            best = Some(now);
        }
    }
    let Some((mut corrected, after_mm2)) = best else { return Ok(None) };
    if before_mm2 - after_mm2 < enough_mm2 {
        return Ok(None);
    }
    for wrong in &mut corrected.wrong {
        wrong.before_mm = residuals.rms_mm(before_mm2);
        wrong.after_mm = residuals.rms_mm(after_mm2);
    }
    Ok(Some(corrected))
}

/// What a setting explains of the residuals; `None` where the model follows it.
fn explained(alone: &Beside, setting: Setting, column: &Column) -> Option<Tried> {
    let outside = alone.residuals.outside(column);
    let (square, whole) = (column.product(&outside), column.square());
    if whole <= 0.0 || square < FOLLOWED * whole {
        return None;
    }
    let common = column.product(&alone.left_mm);
    let per = ASIDE_MM / square;
    Some(Tried {
        setting,
        amount: common * per,
        sigma: (alone.noise().long_run_mm2 / square).sqrt() * ASIDE_MM,
        gain_mm2: common * common / square,
    })
}

/// The campaign identified with a setting changed, and its sum of squares, mm².
fn exactly(
    test: &Test,
    machine: &Machine,
    campaign: &Campaign,
    first: &Tried,
) -> Result<Option<(Corrected, f64)>> {
    let (mut amount_mm, mut sigma_mm) = (0.0, first.sigma);
    let mut step_mm = first.amount;
    let mut best: Option<(Corrected, f64)> = None;
    for _ in 0..MOST_STEPS {
        amount_mm += step_mm.clamp(-LONGEST_MM, LONGEST_MM);
        let (test, machine) = first.setting.applied(test, machine, amount_mm);
        let identified = if first.setting.moves_poses() {
            campaign.realigned(&test, &machine)
        } else {
            // Other terms may be the complete ones.
            campaign.reidentified(&test, &machine)
        };
        let Ok(identified) = identified else { break };
        let residuals = Residuals::of(&test, &machine, &identified)?;
        let alone = residuals.alone();
        let squares_mm2 = alone.left_mm2();
        if best.as_ref().is_some_and(|(_, before)| squares_mm2 >= *before)
            || identified.repeats.len() != campaign.repeats.len()
        {
            break;
        }
        let stated = Stated::new(&residuals, &test, &machine, &identified)?;
        let column = stated.column(&residuals, first.setting)?;
        let column = first.setting.of_mountings(&residuals, &column);
        let left = explained(&alone, first.setting, &column);
        let pivot = matches!(first.setting, Setting::Pivot(_));
        if let Some(left) = &left {
            (step_mm, sigma_mm) = (left.amount, left.sigma);
        }
        let wrong = WrongSetting {
            effect: first.setting.effect(amount_mm),
            sigma_mm: (!pivot).then_some(sigma_mm),
            before_mm: 0.0,
            after_mm: 0.0,
        };
        best = Some((
            Corrected { test, machine, campaign: identified, wrong: vec![wrong] },
            squares_mm2,
        ));
        if pivot || left.is_none() || step_mm.abs() < sigma_mm {
            break;
        }
    }
    Ok(best)
}
