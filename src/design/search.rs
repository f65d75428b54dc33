//! The search for the arcs and set-ups that tell most in the time there is.
//!
//! Set-ups are chosen first, by what they tell if all their arcs share the time; then arcs: from the best
//! shares of time rounded to whole arcs, and greedily; then each is exchanged for better ones until none
//! is. Nothing is drawn at random, and ties go to the first: the same request gives the same plan.

use super::problem::{Chosen, Problem};

/// Gains that are looked at, at the most, while arcs are exchanged: some seconds' worth.
const LOOKS: usize = 24_000;

impl Problem {
    /// Chooses set-ups and arcs for a budget, s; `None` if not one arc of one set-up fits.
    pub(super) fn solve(&self, budget_s: f64) -> Option<Chosen> {
        // The shares do not rank choices of different size: the best of each is filled.
        let mut choices = self.choices(budget_s);
        let mut sizes: Vec<usize> = Vec::new();
        choices.retain(|set_ups| {
            let first = !sizes.contains(&set_ups.len());
            sizes.push(set_ups.len());
            first
        });
        let looks = LOOKS / choices.len().max(1);
        let filled = choices.into_iter().map(|set_ups| self.fill(&set_ups, budget_s, looks));
        filled
            .filter(|chosen| !chosen.arcs.is_empty())
            .reduce(|best, next| if next.value < best.value { next } else { best })
    }
}

#[cfg(test)]
mod tests {
    use super::super::information::ArcInformation;
    use super::super::problem::Objective;
    use super::*;
    use crate::plan::Criterion;
    use crate::solve::Matrix;

    /// Three coefficients; each arc tells of some of them and of the set-up errors of its mounting.
    fn problem(criterion: Criterion) -> Problem {
        let factor = |rows: &[[f64; 6]]| Matrix::from_fn(rows.len(), 6, |i, k| rows[i][k]);
        let arc = |set_up, index, seconds, rows: &[[f64; 6]]| ArcInformation {
            set_up,
            arc: index,
            seconds,
            factor: factor(rows),
        };
        let square = Matrix::from_fn(3, 3, |i, k| if i == k { [1.0, 4.0, 0.5][i] } else { 0.2 });
        Problem {
            coefficients: 3,
            objective: Objective {
                criterion,
                wanted: vec![0, 2],
                mean_square: square,
                points: vec![
                    Matrix::from_fn(2, 3, |i, k| (1 + i + k) as f64),
                    Matrix::from_fn(2, 3, |i, k| 2.0 - (i * k) as f64),
                ],
            },
            arcs: vec![
                arc(0, 0, 10.0, &[[9.0, 1.0, 0.0, 3.0, 0.0, 1.0], [0.0, 4.0, 1.0, 0.0, 2.0, 0.0]]),
                arc(0, 1, 10.0, &[[1.0, 8.0, 2.0, 1.0, 1.0, 0.0]]),
                arc(0, 2, 20.0, &[[0.0, 3.0, 7.0, 0.0, 0.0, 5.0], [2.0, 2.0, 0.0, 4.0, 0.0, 0.0]]),
                arc(1, 0, 10.0, &[[5.0, 0.0, 5.0, 0.0, 2.0, 2.0], [0.0, 1.0, 6.0, 1.0, 0.0, 0.0]]),
                arc(1, 1, 5.0, &[[0.0, 6.0, 0.0, 3.0, 3.0, 0.0]]),
            ],
            set_up_s: vec![10.0, 15.0],
            known: Matrix::identity(3),
            most_set_ups: 2,
        }
    }

    /// The gain of one more arc is the difference of the values before and after it.
    #[test]
    fn a_gain_is_the_difference_of_two_values() {
        for criterion in [Criterion::A, Criterion::D, Criterion::G] {
            let problem = problem(criterion);
            let set_ups = [0, 1];
            let mut information = problem.start(&set_ups);
            problem.add(&mut information, &set_ups, 1, 1.0);
            let step = problem.step(&set_ups, &information).unwrap();
            for index in 0..problem.arcs.len() {
                let mut with = information.clone();
                problem.add(&mut with, &set_ups, index, 1.0);
                let after = problem.step(&set_ups, &with).unwrap().value;
                let gain = problem.gain(&step, &set_ups, index);
                assert!((step.value - after - gain).abs() < 1e-12 * step.value.abs().max(1.0));
                assert!(gain > 0.0);
            }
        }
    }

    /// Every affordable plan of the small problem is tried; the search comes within a few percent.
    #[test]
    fn the_search_comes_near_to_the_best_of_all_plans() {
        for criterion in [Criterion::A, Criterion::D, Criterion::G] {
            let problem = problem(criterion);
            let budget_s = 70.0;
            let found = problem.solve(budget_s).unwrap();
            let mut best = f64::INFINITY;
            for counts in 0..4_usize.pow(5) {
                let counts: Vec<usize> = (0..5).map(|k| counts / 4_usize.pow(k) % 4).collect();
                let set_ups: Vec<usize> = (0..2)
                    .filter(|&s| (0..5).any(|k| counts[k] > 0 && problem.arcs[k].set_up == s))
                    .collect();
                let cost_s: f64 = set_ups.iter().map(|&s| problem.set_up_s[s]).sum::<f64>()
                    + (0..5).map(|k| counts[k] as f64 * problem.arcs[k].seconds).sum::<f64>();
                if cost_s > budget_s || set_ups.is_empty() {
                    continue;
                }
                let mut information = problem.start(&set_ups);
                for (k, &count) in counts.iter().enumerate() {
                    problem.add(&mut information, &set_ups, k, count as f64);
                }
                best = best.min(problem.step(&set_ups, &information).unwrap().value);
            }
            let near = if criterion == Criterion::D { 0.1 } else { 0.1 * best };
            assert!(
                found.value >= best - 1e-12 && found.value - best < near,
                "{criterion:?} {} {best}",
                found.value
            );
            assert_eq!(problem.solve(budget_s).unwrap(), found, "deterministic");
        }
    }

    #[test]
    fn without_time_there_is_no_plan() {
        let problem = problem(Criterion::A);
        assert!(problem.solve(19.0).is_none());
        assert!((problem.shortest_s() - 20.0).abs() < 1e-12);
        assert!(problem.solve(20.0).is_some());
    }
}
