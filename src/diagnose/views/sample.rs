//! The samples as views see them.

use crate::align::Place;
use crate::identify::Campaign;
use crate::machine::Axis;
use crate::model::Variable;
use crate::residual::data::Data;

/// Later than this after a reversal nothing is looked for, s.
const AFTER_REVERSAL_S: f64 = 10.0;
/// Repeats take turns in being foretold from the others, in so many parts at the most.
const MOST_FOLDS: usize = 12;
/// Of one repeat this many parts, arcs taking turns.
const FOLDS_OF_ARCS: usize = 6;

/// A sample as views see it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// Index of its run over all repeats.
    pub(crate) run: usize,
    /// Which part it is foretold with.
    pub(crate) fold: usize,
    pub(crate) before_mm: f64,
    pub(crate) after_mm: f64,
    /// Along the bar.
    pub(crate) direction: [f64; 3],
    pub(crate) sense: [f64; 3],
    /// +1 forward, -1 backward.
    pub(crate) way: f64,
    /// Position, velocity, time since reversal of each slide; time; azimuth; polar angle; feed.
    pub(crate) values: [f64; VALUES],
    /// Index of the circle and the angle on it, degrees.
    pub(crate) on_circle: (usize, f64),
}

/// How many values a sample has.
pub(crate) const VALUES: usize = 13;
/// The index of the time among them.
pub(crate) const ELAPSED: usize = 9;
/// Where the azimuth of the bar, its polar angle and the feed stand among the values.
pub(crate) const AZIMUTH: usize = 10;
pub(crate) const POLAR_ANGLE: usize = 11;
pub(crate) const FEED: usize = 12;

impl Seen {
    /// Position of a slide, mm.
    pub(crate) fn position_mm(&self, axis: Axis) -> f64 {
        self.values[axis.index()]
    }

    /// Time since the program began, s.
    pub(crate) fn elapsed_s(&self) -> f64 {
        self.values[ELAPSED]
    }
}

/// The samples of all runs, and the names of the circles. The campaign is the one that the data are linear
/// about.
pub(crate) fn seen(
    data: &Data,
    campaign: &Campaign,
    after_mm: &[Vec<f64>],
) -> (Vec<Seen>, Vec<String>) {
    let mut all = Vec::with_capacity(data.samples());
    let mut circles: Vec<String> = Vec::new();
    let several = data.blocks.len() > 1;
    let mut run = 0;
    let repeats = data.blocks.iter().zip(after_mm).zip(&campaign.repeats);
    for (number, ((block, after_mm), repeat)) in repeats.enumerate() {
        for (index, range) in block.runs.iter().enumerate() {
            let alignment = &repeat.runs[index].alignment;
            // The arc and its circle.
            let mut last: Option<(usize, usize)> = None;
            for k in range.clone() {
                let sample = &block.samples[k];
                let Place::Arc(arc) = alignment.samples[sample.sample].place else { continue };
                let section = &alignment.sections[arc];
                let at = &sample.situation;
                let u = &at.direction;
                if last.is_none_or(|(known, _)| known != arc) {
                    let name = section.circle.name();
                    let known = circles.iter().position(|known| *known == name);
                    let circle = known.unwrap_or_else(|| {
                        circles.push(name);
                        circles.len() - 1
                    });
                    last = Some((arc, circle));
                }
                let circle = last.map_or(0, |(_, circle)| circle);
                let mut values = [f64::NAN; VALUES];
                for axis in Axis::ALL {
                    let i = axis.index();
                    values[i] = at.pose.position_mm[i];
                    values[3 + i] = at.motion.velocity_mm_s[i];
                    let since = Variable::SinceReversal(axis).value(&at.pose, &at.motion);
                    values[6 + i] = since.filter(|s| *s < AFTER_REVERSAL_S).unwrap_or(f64::NAN);
                }
                values[ELAPSED] = at.motion.elapsed_s;
                values[AZIMUTH] = u.y.atan2(u.x).to_degrees().rem_euclid(360.0);
                values[POLAR_ANGLE] = u.z.clamp(-1.0, 1.0).acos().to_degrees();
                values[FEED] = (60.0 * section.feed_mm_s).round();
                let fold =
                    if several { number % MOST_FOLDS } else { block.arcs[k] % FOLDS_OF_ARCS };
                all.push(Seen {
                    run,
                    fold,
                    before_mm: block.residual_mm[k],
                    after_mm: after_mm[k],
                    direction: [u.x, u.y, u.z],
                    sense: std::array::from_fn(|i| at.pose.sense[i]),
                    way: if section.forward { 1.0 } else { -1.0 },
                    values,
                    on_circle: (circle, section.circle.angle_rad(u).to_degrees()),
                });
            }
            run += 1;
        }
    }
    (all, circles)
}
