//! Features of the circular tests of a repeat, in the order of repair.

use rayon::prelude::*;

use super::feature::Feature;
use super::order::Deed;
use super::readings::Readings;
use super::scene::{Draft, Repeat, Scene};
use super::volume::Volume;
use super::{angles, backlash, found, geometry, order, servo};
use crate::circular::CircularTest;
use crate::diagnose::Finding;
use crate::error::Result;
use crate::identify::{Campaign, Identification};
use crate::machine::{Axis, Machine};
use crate::plan::{Plane, Test};

/// A feature that does less than this to every reading does nothing here, mm: a thousandth of what the best bars resolve.
const NOTHING_MM: f64 = 1e-7;

/// A circular test with the features of its plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking<'a> {
    /// The test.
    pub test: &'a CircularTest,
    /// Those that are told apart from 0 in the order of repair, then the others, the largest fall of the deviation first.
    pub features: Vec<Feature>,
    /// By how much G(b) falls, of one way G, without all those that are not told apart from 0 together, mm.
    pub untold_fall_mm: f64,
    /// What is left of it without any of the features, mm.
    pub left_mm: f64,
    /// What the program's own chords and rounding make of it by themselves, mm.
    pub commanded_mm: f64,
    /// What noise makes of it by itself, and whatever the model does not explain, mm.
    pub unexplained_mm: f64,
    /// The volumetric error over the sphere that was measured, mm rms; `None` where not all axes moved.
    pub volumetric_mm: Option<f64>,
}

/// Those of a repeat's circular tests that lie in coordinate planes, in the order in which they were driven. `findings` are
/// what the campaign was extended by.
///
/// # Errors
/// When readings cannot be fitted: numbers that are not finite.
pub fn of<'a>(
    (test, machine, campaign): (&Test, &Machine, &Campaign),
    findings: &[Finding],
    repeat: usize,
    tests: &'a [CircularTest],
) -> Result<Vec<Ranking<'a>>> {
    let (Some(identification), Some(frame)) = (campaign.repeats.get(repeat), &campaign.frame)
    else {
        return Ok(Vec::new());
    };
    let model = campaign.model(test, machine, repeat)?;
    let values = identification.values();
    let of_same_test =
        |(k, other): &(usize, &Identification)| *k != repeat && other.is_of_test_of(identification);
    let others =
        campaign.repeats.iter().enumerate().filter(of_same_test).map(|(k, identification)| {
            Ok(Repeat { model: campaign.model(test, machine, k)?, identification })
        });
    let others = others.collect::<Result<Vec<_>>>()?;
    let held = campaign.held.get(repeat).map_or(&[][..], Vec::as_slice);
    let in_planes =
        tests.par_iter().filter_map(|test| test.circle.plane().map(|(plane, _)| (test, plane)));
    let of_test = |(test, plane): (&'a CircularTest, Plane)| {
        let scene = Scene {
            model: &model,
            frame,
            identification,
            values: &values,
            others: &others,
            held,
            findings,
            repeat,
            axes: plane.axes().map(|k| Axis::ALL[k]),
            normal: Axis::ALL[plane.normal()],
            radius_mm: test.radius_mm,
            feed_mm_s: test.feed_mm_s,
            runs: test.ways.iter().map(|way| way.path.run).collect(),
        };
        ranked(&scene, test)
    };
    in_planes.map(of_test).collect()
}

fn ranked<'a>(scene: &Scene, test: &'a CircularTest) -> Result<Ranking<'a>> {
    let mut drafts = geometry::drafts(scene);
    drafts.extend(backlash::drafts(scene));
    drafts.extend(servo::draft(scene));
    drafts.extend(angles::drafts(scene));
    drafts.extend(found::drafts(scene));
    let volume = Volume::of(scene);
    let readings = Readings::of(scene, test);
    let as_read = vec![0.0; readings.count()];
    let read_mm = readings.deviation_without_mm(&as_read, 0.0)?;
    let (mut deeds, mut all_mm, mut untold_mm) = (Vec::new(), as_read.clone(), as_read);
    for Draft { feature, column } in drafts {
        let adds_mm = readings.adds_mm(&column);
        let does = adds_mm.iter().any(|mm| mm.abs() > NOTHING_MM);
        if !does && feature.size_mm.is_none() {
            continue;
        }
        let add = |to: &mut Vec<f64>| to.iter_mut().zip(&adds_mm).for_each(|(to, mm)| *to += mm);
        add(&mut all_mm);
        if !feature.is_told() {
            add(&mut untold_mm);
        }
        let fall_mm = |share: f64| Ok(read_mm - readings.deviation_without_mm(&adds_mm, share)?);
        let by = |sigma: Option<f64>| match sigma {
            Some(sigma) if feature.value != 0.0 => {
                let aside = sigma / feature.value;
                Ok(Some(0.5 * (fall_mm(1.0 + aside)? - fall_mm(1.0 - aside)?).abs()))
            }
            _ => Ok(None),
        };
        let moves_mm = volume.as_ref().and_then(|volume| volume.moves_mm(&column));
        let volumetric_fall_mm = volume.as_ref().zip(moves_mm.as_ref());
        let feature = Feature {
            fall_mm: fall_mm(1.0)?,
            fall_noise_mm: by(feature.noise)?,
            fall_all_mm: by(feature.uncertainty())?,
            volumetric_fall_mm: volumetric_fall_mm.map(|(volume, moves)| volume.fall_mm(moves)),
            ..feature
        };
        deeds.push(Deed { feature, adds_mm, moves_mm });
    }
    let left_mm = readings.deviation_without_mm(&all_mm, 1.0)?;
    let commanded_mm = readings.deviation_mm(&readings.commanded_mm())?;
    let unexplained_mm = readings.deviation_mm(&readings.residual_mm())?;
    let untold_fall_mm = read_mm - readings.deviation_without_mm(&untold_mm, 1.0)?;
    let volumetric_mm = volume.as_ref().map(Volume::rms_mm);
    let mut features = order::of(&readings, volume, deeds)?;
    share(&mut features);
    Ok(Ranking {
        test,
        features,
        untold_fall_mm,
        left_mm,
        commanded_mm,
        unexplained_mm,
        volumetric_mm,
    })
}

/// Each size as a share of the sum of all.
fn share(features: &mut [Feature]) {
    let sum: f64 = features.iter().filter_map(|feature| feature.size_mm).sum();
    for feature in features {
        feature.share = feature.size_mm.filter(|_| sum > 0.0).map(|size| size / sum);
    }
}
