//! From all terms to the largest set that a test can tell apart, each removal with its reason.

use super::observability::Sight;
use crate::error::Result;
use crate::solve::NullDirection;

/// A term that was left out because the terms before it explain it.
#[derive(Debug, Clone, PartialEq)]
pub struct Removal {
    /// Its column.
    pub column: usize,
    /// Its name.
    pub name: String,
    /// What it acts as, in words.
    pub reason: String,
    /// The same in numbers: moving the columns together by these changes is not seen. The removed
    /// column comes first, with the change 1.
    pub direction: NullDirection,
}

/// A complete set: every other term is explained by those that were kept.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selection {
    /// Columns that were kept, in the order of the visit.
    pub kept: Vec<usize>,
    /// What was left out, in the order of the visit.
    pub removed: Vec<Removal>,
}

impl Sight {
    /// The columns of an order of bare names, such as [`preference`](super::preference()) makes; a
    /// set-up error stands for those of all mountings. Names without a column are passed over.
    pub fn ordered(&self, names: &[String]) -> Vec<usize> {
        names.iter().flat_map(|name| self.columns(|bare| bare == name)).collect()
    }

    /// Keeps of these columns, visited in this order, those that the kept ones do not explain.
    pub fn select(&self, order: &[usize]) -> Result<Selection> {
        let choice = self.choose(order)?;
        let mut removed = Vec::with_capacity(choice.rejected.len());
        for &column in &choice.rejected {
            let place = |k: usize| order.iter().position(|&o| o == k);
            let before = choice.kept.iter().copied().filter(|&k| place(k) < place(column));
            let with: Vec<usize> = before.chain([column]).collect();
            let direction = self.explained(column, &with)?;
            let reason = self.told(&direction);
            removed.push(Removal { column, name: self.name(column).to_owned(), reason, direction });
        }
        Ok(Selection { kept: choice.kept, removed })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::Vector3;

    use crate::identify::{Gather, POINTS, preference};
    use crate::machine::{Axis, Machine, Mounting, Pivot};
    use crate::model::coefficients;
    use crate::plan::{Arc, Strategy};

    fn hu40t() -> Machine {
        Machine::read("machines/hu40t.toml".as_ref()).unwrap()
    }

    fn mounting(coincidence_mm: [f64; 3]) -> Mounting {
        let tool_ball_mm = Vector3::new(0.0, 0.0, -200.0);
        Mounting { coincidence_mm: Vector3::from(coincidence_mm), tool_ball_mm }
    }

    /// Names that are kept by the default preference, without set-up errors, sorted; and how many
    /// set-up errors.
    fn kept(machine: &Machine, places: &[[f64; 3]], arcs: &[Arc]) -> (Vec<String>, usize) {
        let mountings: Vec<Mounting> = places.iter().map(|&at| mounting(at)).collect();
        let mut gather = Gather::new(machine, &mountings).unwrap();
        for k in 0..mountings.len() {
            gather.drive(k, arcs, 150.0, POINTS);
        }
        let sight = gather.finish().unwrap();
        let order = sight.ordered(&preference(&[]).unwrap());
        let selection = sight.select(&order).unwrap();
        assert_eq!(selection.kept.len() + selection.removed.len(), 90 + 6 * places.len());
        assert_eq!(sight.rank(&order).unwrap(), selection.kept.len(), "complete");
        assert_eq!(sight.rank(&selection.kept).unwrap(), selection.kept.len(), "independent");
        let names: Vec<&str> = selection.kept.iter().map(|&k| sight.name(k)).collect();
        let set_ups = names.iter().filter(|name| name.contains(['t', 'w'])).count();
        let mut names: Vec<String> =
            names.iter().filter(|n| !n.contains(['t', 'w'])).map(|n| (*n).to_owned()).collect();
        names.sort();
        (names, set_ups)
    }

    fn of_set(name: &str, more: &[&str]) -> Vec<String> {
        let of_set = coefficients(name).unwrap();
        let mut names: Vec<String> = of_set.iter().map(ToString::to_string).collect();
        names.extend(more.iter().map(|&name| name.to_owned()));
        names.sort();
        names
    }

    const A: [f64; 3] = [20.0, -35.0, 40.0];

    #[test]
    fn one_mounting_on_carriages_keeps_the_observable_35() {
        let (names, set_ups) = kept(&hu40t(), &[A], &Strategy::ThreeD6.arcs());
        assert_eq!(names, of_set("observable35", &[]));
        assert_eq!(set_ups, 3);
    }

    /// The paper's set comes out whole, and is not complete: the roll of Z shows twice.
    #[test]
    fn one_mounting_with_the_pivot_of_x_on_the_base_keeps_the_papers_37_and_two_more() {
        let machine = hu40t().with_pivot(Axis::X, Pivot::Base);
        let (names, set_ups) = kept(&machine, &[A], &Strategy::ThreeD6.arcs());
        assert_eq!((names, set_ups), (of_set("paper37", &["EAZ3", "EAZb"]), 3));
    }

    #[test]
    fn three_planes_keep_the_planar_27_and_two_more() {
        let (names, set_ups) = kept(&hu40t(), &[A], &Strategy::TwoD.arcs());
        assert_eq!((names, set_ups), (of_set("planar27", &["EAZ3", "EAZb"]), 3));
    }

    #[test]
    fn three_places_keep_the_53_that_the_volume_needs() {
        let places = [A, [-60.0, 50.0, 40.0], [30.0, 60.0, 140.0]];
        let (names, set_ups) = kept(&hu40t(), &places, &Strategy::ThreeD6.arcs());
        assert_eq!((names, set_ups), (of_set("volume53", &[]), 9));
    }
}
