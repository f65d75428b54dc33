//! The samples as views show them.

use crate::identify::Campaign;
use crate::machine::Axis;
use crate::model::Variable;
use crate::residual::{self, Column, Residuals};

/// Later than this after a reversal nothing is looked for, s.
const AFTER_REVERSAL_S: f64 = 10.0;
/// Repeats take turns in being foretold from the others, in so many parts at the most.
const MOST_FOLDS: usize = 12;
/// Of one repeat this many parts, arcs taking turns.
const FOLDS_OF_ARCS: usize = 6;

/// A sample as views show it: residuals, how it counts, and all that they are shown against.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shown {
    /// Index of its run over all repeats.
    pub(crate) run: usize,
    /// Which part it is foretold with.
    pub(crate) fold: usize,
    /// Residual of the model.
    pub(crate) before_mm: f64,
    /// Residual of the extended model.
    pub(crate) after_mm: f64,
    /// Unit vector from the workpiece ball to the tool ball.
    pub(crate) direction: [f64; 3],
    /// Sense of each slide.
    pub(crate) sense: [f64; 3],
    /// +1 forward, -1 backward.
    pub(crate) way: f64,
    pub(crate) position_mm: [f64; 3],
    pub(crate) velocity_mm_s: [f64; 3],
    /// `None` long after, or where a slide has never reversed.
    pub(crate) since_reversal_s: [Option<f64>; 3],
    pub(crate) elapsed_s: f64,
    pub(crate) azimuth_deg: f64,
    pub(crate) polar_deg: f64,
    pub(crate) feed_mm_min: f64,
    /// Index of its circle.
    pub(crate) circle: usize,
    /// The angle on it.
    pub(crate) on_circle_deg: f64,
}

/// The samples of all runs, and the names of the circles. The campaign is the one that the residuals are of:
/// it knows the sections of the programs.
pub(crate) fn shown(
    residuals: &Residuals,
    campaign: &Campaign,
    after_mm: &Column,
) -> (Vec<Shown>, Vec<String>) {
    let mut all = Vec::with_capacity(residuals.samples());
    let mut circles: Vec<String> = Vec::new();
    let several = residuals.repeats.len() > 1;
    for (number, (index, run)) in residuals.runs().enumerate() {
        let repeat = &residuals.repeats[index];
        let sections = &campaign.repeats[index].runs[run].alignment.sections;
        // The arc and its circle.
        let mut last: Option<(usize, usize)> = None;
        for k in repeat.runs[run].samples.clone() {
            let sample = &repeat.samples[k];
            let section = &sections[sample.section];
            let circle = match last {
                Some((known, circle)) if known == sample.section => circle,
                _ => index_of(&mut circles, section.circle.name()),
            };
            last = Some((sample.section, circle));
            let fold = if several { index % MOST_FOLDS } else { sample.arc % FOLDS_OF_ARCS };
            all.push(Shown {
                run: number,
                fold,
                before_mm: residuals.model_mm[index][k],
                after_mm: after_mm[index][k],
                way: if section.forward { 1.0 } else { -1.0 },
                feed_mm_min: (60.0 * section.feed_mm_s).round(),
                circle,
                on_circle_deg: section.circle.angle_rad(&sample.situation.direction).to_degrees(),
                ..Shown::placed(sample)
            });
        }
    }
    (all, circles)
}

/// Where a name stands among others; it joins them if it is new.
fn index_of(names: &mut Vec<String>, name: String) -> usize {
    names.iter().position(|known| *known == name).unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    })
}

impl Shown {
    /// Where the machine is and how it moves at a sample.
    fn placed(sample: &residual::Sample) -> Self {
        let at = &sample.situation;
        let u = &at.direction;
        let since = |axis: Axis| {
            Variable::SinceReversal(axis)
                .value(&at.pose, &at.motion)
                .filter(|since_s| *since_s < AFTER_REVERSAL_S)
        };
        Self {
            direction: [u.x, u.y, u.z],
            sense: at.pose.sense.into(),
            position_mm: at.pose.position_mm.into(),
            velocity_mm_s: at.motion.velocity_mm_s.into(),
            since_reversal_s: Axis::ALL.map(since),
            elapsed_s: at.motion.elapsed_s,
            azimuth_deg: u.y.atan2(u.x).to_degrees().rem_euclid(360.0),
            polar_deg: u.z.clamp(-1.0, 1.0).acos().to_degrees(),
            ..Self::default()
        }
    }
}
