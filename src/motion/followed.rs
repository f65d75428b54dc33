//! Slides that follow a program with a first-order lag.

use nalgebra::Vector3;

use super::block::Block;
use super::profile::Phase;
use super::trajectory::Trajectory;
use crate::nc::{Move, Path};

/// What was so many time constants ago no longer tells where a slide is.
const FORGOTTEN: f64 = 20.0;

/// Places and weights of Gauss-Legendre over an interval of length one.
const LEGENDRE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Where slides are that follow a trajectory `c`, each with a time constant of its own: `T dy/dt = c - y`.
///
/// As long as a block goes on alike, from `t0` on,
///
/// `y(t) = p(t) + exp(-(t - t0) / T) (y(t0) - p(t0))`,
/// `p = c - T c' + (T² c'' - T³ c''') / (1 + (ω T)²)`,
///
/// with the rate ω at which an arc turns: exact for lines of constant jerk and for arcs of constant speed. Where an arc gains
/// or loses speed, which takes a fraction of a second, the integral of `c(t - x) exp(-x / T) / T` is taken by Gauss-Legendre.
#[derive(Debug, Clone)]
pub struct Followed {
    constants_s: Vector3<f64>,
    pieces: Vec<Piece>,
    /// Index of the first piece of each block, or of the one after it.
    first: Vec<usize>,
}

/// A while in which a block goes on alike.
#[derive(Debug, Clone)]
struct Piece {
    start_s: f64,
    block: usize,
    /// The phase of the block, with when it begins (s) and how far along (mm); `None` where it stands, at its end.
    phase: Option<(f64, f64, Phase)>,
    /// How far the slides are from `p` when it begins, mm; where `p` does not hold, where they are.
    from_mm: Vector3<f64>,
    /// By how much that grows with the time constant of each, mm/s.
    from_grows_mm_s: Vector3<f64>,
}

/// A command and how it goes on.
struct Command {
    /// Position (mm) and its first three derivatives by time.
    derivatives: [Vector3<f64>; 4],
    /// Square of the rate at which it turns, 1/s².
    turning: f64,
    /// Whether it turns while its speed changes.
    uneven: bool,
}

impl Followed {
    /// A trajectory as slides of these time constants follow it; `None` of one that was recorded, which has no blocks that
    /// go on alike.
    pub fn new(trajectory: &Trajectory, constants_s: Vector3<f64>) -> Option<Self> {
        if trajectory.recorded_pauses_s().is_some() {
            return None;
        }
        let blocks = trajectory.blocks();
        let mut followed = Self { constants_s, pieces: Vec::new(), first: Vec::new() };
        let start_mm = blocks.first().map_or_else(Vector3::zeros, |block| block.start_mm);
        let mut now = [start_mm, Vector3::zeros()];
        for (index, block) in blocks.iter().enumerate() {
            followed.first.push(followed.pieces.len());
            let phases = block.motion.as_ref().map_or(0, |(_, profile)| profile.phase_count());
            for k in 0..phases {
                let Some(in_block) = block.phase(k) else { continue };
                let (into_s, _, phase) = in_block;
                let span_s = [block.start_s + into_s, block.start_s + into_s + phase.duration_s];
                followed.go_on(blocks, index, Some(in_block), span_s, &mut now);
            }
            if phases == 0 {
                let end_s = block.start_s + block.duration_s;
                followed.go_on(blocks, index, None, [block.start_s, end_s], &mut now);
            }
        }
        // And then it stands.
        if let Some(last) = blocks.len().checked_sub(1) {
            let end_s = trajectory.end_s();
            followed.go_on(blocks, last, None, [end_s, f64::INFINITY], &mut now);
        }
        Some(followed)
    }

    /// Another piece, and where the slides are at its end.
    fn go_on(
        &mut self,
        blocks: &[Block],
        block: usize,
        phase: Option<(f64, f64, Phase)>,
        [start_s, end_s]: [f64; 2],
        now: &mut [Vector3<f64>; 2],
    ) {
        // Not a negative one by rounding either.
        if end_s.partial_cmp(&start_s).is_none_or(std::cmp::Ordering::is_le) {
            return;
        }
        let [from_mm, from_grows_mm_s] = *now;
        let mut piece = Piece { start_s, block, phase, from_mm, from_grows_mm_s };
        let command = piece.command(blocks, start_s);
        if !command.uneven {
            for k in 0..3 {
                let [place_mm, grows_mm_s] = command.settled(k, self.constants_s[k]);
                piece.from_mm[k] -= place_mm;
                piece.from_grows_mm_s[k] -= grows_mm_s;
            }
        }
        if end_s.is_finite() {
            *now = self.within(&piece, blocks, end_s);
        }
        self.pieces.push(piece);
    }

    /// Where slides are (mm), and by how much more of its time constant moves each (mm/s), at a time near that of a block, by
    /// its index.
    pub fn at(&self, trajectory: &Trajectory, time_s: f64, near: usize) -> [Vector3<f64>; 2] {
        let blocks = trajectory.blocks();
        let last = self.pieces.len().saturating_sub(1);
        let mut index = self.first.get(near).map_or(last, |first| (*first).min(last));
        while index > 0 && self.pieces[index].start_s > time_s {
            index -= 1;
        }
        while self.pieces.get(index + 1).is_some_and(|next| next.start_s <= time_s) {
            index += 1;
        }
        match self.pieces.get(index) {
            Some(piece) if piece.start_s <= time_s => self.within(piece, blocks, time_s),
            _ => [trajectory.position_near_mm(time_s, near), Vector3::zeros()],
        }
    }

    /// The same within a piece.
    fn within(&self, piece: &Piece, blocks: &[Block], time_s: f64) -> [Vector3<f64>; 2] {
        let command = piece.command(blocks, time_s);
        let since_s = time_s - piece.start_s;
        let constants_s = &self.constants_s;
        let alike = constants_s.min() >= constants_s.max();
        let mut left = (-since_s / constants_s[0]).exp();
        let (mut place_mm, mut grows_mm_s) = if command.uneven {
            self.integral(piece, blocks, &command, time_s)
        } else {
            (Vector3::zeros(), Vector3::zeros())
        };
        for k in 0..3 {
            let constant_s = constants_s[k];
            if !alike && k > 0 {
                left = (-since_s / constant_s).exp();
            }
            let [there_mm, there_grows_mm_s] = command.settled(k, constant_s);
            let from_mm = piece.from_mm[k] - if command.uneven { there_mm } else { 0.0 };
            place_mm[k] += there_mm + left * from_mm;
            grows_mm_s[k] += there_grows_mm_s
                + left * (since_s / (constant_s * constant_s) * from_mm + piece.from_grows_mm_s[k]);
        }
        [place_mm, grows_mm_s]
    }

    /// Integral, since a piece began, of how far the command was from where it is now, and by how much it grows.
    fn integral(
        &self,
        piece: &Piece,
        blocks: &[Block],
        command: &Command,
        time_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (mut sum_mm, mut grows_mm_s) = (Vector3::zeros(), Vector3::zeros());
        let shortest_s = self.constants_s.min();
        let over_s = (time_s - piece.start_s).min(FORGOTTEN * self.constants_s.max());
        let panels = (over_s / shortest_s).ceil().clamp(1.0, 2.0 * FORGOTTEN);
        let panel_s = over_s / panels;
        for panel in 0..panels as usize {
            for (place, weight) in LEGENDRE {
                let ago_s = (panel as f64 + place) * panel_s;
                let before = piece.command(blocks, time_s - ago_s).derivatives[0];
                let apart_mm = before - command.derivatives[0];
                for k in 0..3 {
                    let constant_s = self.constants_s[k];
                    let share = weight * panel_s / constant_s * (-ago_s / constant_s).exp();
                    sum_mm[k] += share * apart_mm[k];
                    grows_mm_s[k] += share * (ago_s / constant_s - 1.0) / constant_s * apart_mm[k];
                }
            }
        }
        (sum_mm, grows_mm_s)
    }
}

impl Piece {
    fn command(&self, blocks: &[Block], time_s: f64) -> Command {
        let block = &blocks[self.block];
        let (Some(motion), Some((into_s, into_mm, phase))) = (block.motion(), &self.phase) else {
            let at_mm = block.position_mm(block.start_s + block.duration_s);
            let mut derivatives = [Vector3::zeros(); 4];
            derivatives[0] = at_mm;
            return Command { derivatives, turning: 0.0, uneven: false };
        };
        let since_s = (time_s - block.start_s - into_s).clamp(0.0, phase.duration_s);
        Command::of(motion, block.length_mm, *into_mm, phase, since_s)
    }
}

impl Command {
    fn of(motion: &Move, length_mm: f64, into_mm: f64, phase: &Phase, since_s: f64) -> Self {
        let (further_mm, speed_mm_s) = phase.at(since_s);
        let share = (into_mm + further_mm) / length_mm;
        let [v, a, j] =
            [speed_mm_s, phase.acceleration_mm_s2 + phase.jerk_mm_s3 * since_s, phase.jerk_mm_s3]
                .map(|of| of / length_mm);
        let chord = motion.end_mm - motion.start_mm;
        match motion.path {
            Path::Line => Self {
                derivatives: [motion.position_mm(share), chord * v, chord * a, chord * j],
                turning: 0.0,
                uneven: false,
            },
            Path::Arc { center_mm, axis, sweep_rad } => {
                let place_mm = motion.position_mm(share);
                let mut arm_mm = place_mm - center_mm;
                arm_mm[axis] = 0.0;
                let mut across_mm = Vector3::zeros();
                let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
                (across_mm[first], across_mm[second]) = (-arm_mm[second], arm_mm[first]);
                let mut along_mm = Vector3::zeros();
                along_mm[axis] = chord[axis];
                let (w, dw, ddw) = (sweep_rad * v, sweep_rad * a, sweep_rad * j);
                Self {
                    derivatives: [
                        place_mm,
                        across_mm * w + along_mm * v,
                        across_mm * dw - arm_mm * (w * w) + along_mm * a,
                        across_mm * (ddw - w * w * w) - arm_mm * (3.0 * w * dw) + along_mm * j,
                    ],
                    turning: w * w,
                    uneven: phase.acceleration_mm_s2 != 0.0 || phase.jerk_mm_s3 != 0.0,
                }
            }
        }
    }

    /// Where a slide is that has forgotten how the command began (mm), and by how much that grows with its time constant (mm/s);
    /// of an uneven command where it is itself.
    fn settled(&self, slide: usize, constant_s: f64) -> [f64; 2] {
        let [c, c1, c2, c3] = self.derivatives.map(|of| of[slide]);
        if self.uneven {
            return [c, 0.0];
        }
        let t = constant_s;
        let divisor = 1.0 + self.turning * t * t;
        let bend = t * t * (c2 - t * c3) / divisor;
        let bend_grows = (t * (2.0 * c2 - 3.0 * t * c3) - 2.0 * self.turning * t * bend) / divisor;
        [c - t * c1 + bend, bend_grows - c1]
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
