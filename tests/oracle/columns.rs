//! Every one of the 96 columns against derivatives of the exact chain that were found another way.

use ballbar::machine::{ChainErrors, Machine, Mounting, Pose};
use ballbar::model::{Ball, ErrorFunctions, Model, Motion, Situation, coefficients, terms};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::common::{machines, pivots, random_mounting, random_pose};
use crate::dual_chain::{Column, Values, length};

/// A machine, a mounting and a pose with a bar of any direction between its balls.
struct Case {
    machine: usize,
    mounting: Mounting,
    pose: Pose,
}

const POSES: usize = 1000;
/// Shorter bars magnify the second order, longer ones nobody has, mm.
const BAR_MM: std::ops::Range<f64> = 40.0..600.0;
/// The length that scales the powers of `h`, mm.
const TRAVEL_MM: f64 = 300.0;

/// Poses of one machine, every one with one of its eight choices of pivots.
fn cases(variants: &[Machine], seed: u64) -> Vec<Case> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut cases = Vec::with_capacity(POSES);
    while cases.len() < POSES {
        let machine = random.random_range(0..variants.len());
        let mounting = random_mounting(&variants[machine], &mut random);
        let pose = random_pose(&variants[machine], &mut random);
        let bar_mm = (pose.position_mm - mounting.coincidence_mm).norm();
        if BAR_MM.contains(&bar_mm) {
            cases.push(Case { machine, mounting, pose });
        }
    }
    cases
}

/// The row that the model makes: 90 coefficients and the six set-up errors.
fn row(variants: &[Machine], case: &Case) -> Vec<f64> {
    let machine = &variants[case.machine];
    let all = terms(&["all".to_owned()], &["A".to_owned()]).unwrap();
    let model = Model::new(machine, vec![case.mounting], all);
    let situation = Situation::new(machine, &case.mounting, 0, &case.pose).unwrap();
    let mut row = vec![0.0; 96];
    model.row(&situation, &mut row);
    row
}

/// Length through the exact chain with one error of the given size, mm.
fn bent_length_mm(machine: &Machine, case: &Case, column: Column, value: f64) -> f64 {
    let mut errors = ChainErrors::zero();
    match column {
        Column::Coefficient(coefficient) => {
            let mut functions = ErrorFunctions::default();
            functions.set(coefficient, value);
            let slide = coefficient.slide;
            errors.slides[slide.index()] = functions.slide_error(slide, &case.pose);
        }
        Column::SetUp(set_up) => {
            let ball = match set_up.ball {
                Ball::Workpiece => &mut errors.workpiece_ball_mm,
                Ball::Tool => &mut errors.tool_ball_mm,
            };
            ball[set_up.axis.index()] = value;
        }
    }
    machine.ball_vector_mm(&case.mounting, &case.pose.position_mm, &errors).norm()
}

/// Step of a central difference. A displacement `d` leaves `(d / bar)²` of truncation and
/// `1e-13 mm / d` of rounding: they balance near 3e-3 mm, and near 1e-5 rad on the levers here.
fn step(column: Column) -> f64 {
    let Column::Coefficient(of) = column else { return 3e-3 };
    let size = if of.component.is_angular() { 1e-5 } else { 3e-3 };
    let power = [0, 1, 2, 3, 0][of.power as usize];
    size / TRAVEL_MM.powi(power)
}

/// The worst error of each column over the cases, as a share of `max(|column|, its rms over the cases)`.
///
/// A column crosses zero where the bar is normal to what it describes; its own size there is no measure.
fn worst_errors(rows: &[Vec<f64>], oracle: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    (0..96)
        .map(|k| {
            let rms =
                (rows.iter().map(|row| row[k] * row[k]).sum::<f64>() / rows.len() as f64).sqrt();
            assert!(rms > 0.0, "column {k} vanishes at every pose");
            rows.iter().enumerate().fold(0.0, |worst: f64, (i, row)| {
                worst.max((row[k] - oracle(i, k)).abs() / row[k].abs().max(rms))
            })
        })
        .collect()
}

fn name(column: Column) -> String {
    match column {
        Column::Coefficient(coefficient) => coefficient.to_string(),
        Column::SetUp(set_up) => set_up.to_string(),
    }
}

/// Prints the worst column of a machine and holds all to a limit.
fn hold(machine: &Machine, what: &str, errors: &[f64], limit: f64) {
    let columns = Column::all();
    let worst = (0..96).max_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap();
    let topology = machine.topology().as_str();
    println!("{topology:<10} {what}: worst {:.1e} ({})", errors[worst], name(columns[worst]));
    for (error, column) in errors.iter().zip(columns) {
        assert!(*error < limit, "{topology} {what}: {} is off by {error:.2e}", name(column));
    }
}

#[test]
fn every_column_is_the_central_difference_of_the_exact_chain() {
    let columns = Column::all();
    for (seed, machine) in machines().iter().enumerate() {
        let variants = pivots(machine);
        let cases = cases(&variants, seed as u64);
        let rows: Vec<Vec<f64>> = cases.iter().map(|case| row(&variants, case)).collect();
        let difference = |i: usize, k: usize| {
            let (case, size) = (&cases[i], step(columns[k]));
            let at = |value| bent_length_mm(&variants[case.machine], case, columns[k], value);
            (at(size) - at(-size)) / (2.0 * size)
        };
        hold(machine, "central differences", &worst_errors(&rows, difference), 1e-6);
    }
}

#[test]
fn every_column_is_the_exact_derivative_of_a_chain_of_transforms() {
    for (seed, machine) in machines().iter().enumerate() {
        let variants = pivots(machine);
        let cases = cases(&variants, 100 + seed as u64);
        let rows: Vec<Vec<f64>> = cases.iter().map(|case| row(&variants, case)).collect();
        let derivative = |i: usize, k: usize| {
            let case = &cases[i];
            length(&variants[case.machine], &case.mounting, &case.pose, &Values::seeded(k)).eps
        };
        hold(machine, "dual numbers", &worst_errors(&rows, derivative), 1e-12);
    }
}

/// Errors ten times those of a good machine: a bar sees a little of what is across it then. The balls' own set-up errors
/// are not turned with what carries them.
#[test]
fn every_column_of_a_bent_machine_is_its_derivative_there() {
    const TURNED: f64 = 5e-3;
    let columns = Column::all();
    for (seed, machine) in machines().iter().enumerate() {
        let variants = pivots(machine);
        let mut random = Pcg64Mcg::seed_from_u64(400 + seed as u64);
        let cases = cases(&variants, 500 + seed as u64);
        let bent: Vec<Vec<f64>> = (0..cases.len())
            .map(|_| {
                let value = |&column| 10.0 * step(column) * random.random_range(-1.0..1.0);
                columns.iter().map(value).collect()
            })
            .collect();
        let at_values = |(case, values): (&Case, &Vec<f64>)| {
            let machine = &variants[case.machine];
            let all = terms(&["all".to_owned()], &["A".to_owned()]).unwrap();
            let model = Model::new(machine, vec![case.mounting], all);
            let mut row = vec![0.0; 96];
            let errors = model.errors(values, &case.pose, &Motion::REST, 0);
            let at = model.situation_bent(&errors, &case.pose, &Motion::REST, 0);
            model.row(&at, &mut row);
            row
        };
        let rows: Vec<Vec<f64>> = cases.iter().zip(&bent).map(at_values).collect();
        let derivative = |i: usize, k: usize| {
            let (case, values) = (&cases[i], Values::seeded_at(&bent[i], k));
            length(&variants[case.machine], &case.mounting, &case.pose, &values).eps
        };
        let errors = worst_errors(&rows, derivative);
        let straight: Vec<Vec<f64>> = cases.iter().map(|case| row(&variants, case)).collect();
        let unbent = worst_errors(&straight, derivative);
        for (k, column) in columns.iter().enumerate() {
            let limit = if matches!(column, Column::SetUp(_)) { TURNED } else { 1e-12 };
            let (topology, name) = (machine.topology().as_str(), name(*column));
            assert!(errors[k] < limit, "{topology}: {name} is off by {:.2e}", errors[k]);
            // Otherwise nothing was bent.
            assert!(unbent[k] > 1e-4, "{topology}: {name}, straight {:.2e}", unbent[k]);
        }
    }
}

/// Errors a thousand times those of a real machine, so that the order of the rotations shows.
#[test]
fn lengths_of_the_exact_chain_are_those_of_a_chain_of_transforms() {
    let columns = Column::all();
    for (seed, machine) in machines().iter().enumerate() {
        let variants = pivots(machine);
        let mut random = Pcg64Mcg::seed_from_u64(200 + seed as u64);
        let (mut worst, mut second_order): (f64, f64) = (0.0, 0.0);
        for case in cases(&variants, 300 + seed as u64) {
            let variant = &variants[case.machine];
            let mut functions = ErrorFunctions::default();
            let mut errors = ChainErrors::zero();
            let values: Vec<f64> = columns
                .iter()
                .map(|&column| 1e3 * step(column) * random.random_range(-1.0..1.0))
                .collect();
            for (&column, &value) in columns.iter().zip(&values) {
                match column {
                    Column::Coefficient(coefficient) => functions.set(coefficient, value),
                    Column::SetUp(s) if s.ball == Ball::Tool => {
                        errors.tool_ball_mm[s.axis.index()] = value;
                    }
                    Column::SetUp(s) => errors.workpiece_ball_mm[s.axis.index()] = value,
                }
            }
            errors.slides =
                ballbar::machine::Axis::ALL.map(|slide| functions.slide_error(slide, &case.pose));
            let position = &case.pose.position_mm;
            let exact_mm = variant.ball_vector_mm(&case.mounting, position, &errors).norm();
            let oracle_mm = length(variant, &case.mounting, &case.pose, &Values::plain(&values)).re;
            worst = worst.max((exact_mm / oracle_mm - 1.0).abs());

            // The terms bend the same chain as the error functions do.
            let all = terms(&["all".to_owned()], &["A".to_owned()]).unwrap();
            let model = Model::new(variant, vec![case.mounting], all);
            let by_terms_mm = model.length_mm(&values, &case.pose, &Motion::REST, 0);
            worst = worst.max((by_terms_mm / oracle_mm - 1.0).abs());

            let linear: f64 = row(&variants, &case).iter().zip(&values).map(|(j, x)| j * x).sum();
            let nominal_mm = (position - case.mounting.coincidence_mm).norm();
            second_order = second_order.max((exact_mm - nominal_mm - linear).abs());
        }
        let topology = machine.topology().as_str();
        println!(
            "{topology:<10} length: worst {worst:.1e}; second order up to {second_order:.2} mm"
        );
        assert!(worst < 1e-12, "{topology}: the lengths differ by {worst:.2e}");
        // Otherwise nothing but the first order was tested.
        assert!(second_order > 0.1, "{topology}: the errors were too small to show the rotations");
    }
}

#[test]
fn the_order_of_the_model_is_that_of_the_table() {
    let names: Vec<String> = Column::all().into_iter().map(name).collect();
    let model: Vec<String> = terms(&["all".to_owned()], &["A".to_owned()])
        .unwrap()
        .iter()
        .flat_map(|term| term.parameters())
        .map(|parameter| parameter.name)
        .collect();
    assert_eq!(names, model);
    assert_eq!(coefficients("all").unwrap().len(), 90);
}
