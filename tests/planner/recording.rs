//! What LinuxCNC's servo thread did, a row for every millisecond of its own time.

use std::fmt::Write as _;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use ballbar::motion::{BlockKind, Trajectory};
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use nalgebra::Vector3;

/// Period of the servo thread, s.
const PERIOD_S: f64 = 1e-3;
/// Of a recording that is kept, every such row, and the last.
const KEPT: usize = 20;
/// A slide that turns round stands for a period or two; what is longer is a standstill, s.
const STANDSTILL_S: f64 = 0.01;

/// Time since the first motion (s), the operator's time left out, and the position then (mm).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub(crate) time_s: f64,
    pub(crate) position_mm: Vector3<f64>,
}

/// A standstill between two motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rest {
    /// How long the program says, s.
    dwell_s: f64,
    /// An operator is waited for.
    waits: bool,
}

/// The standstills of a program between its first motion and its last.
pub(crate) fn rests(trajectory: &Trajectory) -> Vec<Rest> {
    let moves = |kind: BlockKind| matches!(kind, BlockKind::Rapid | BlockKind::Feed);
    let blocks = trajectory.blocks();
    let first = blocks.iter().position(|block| moves(block.kind)).unwrap();
    let last = blocks.iter().rposition(|block| moves(block.kind)).unwrap();
    blocks[first..=last]
        .chunk_by(|a, b| moves(a.kind) == moves(b.kind))
        .filter(|stretch| !moves(stretch[0].kind))
        .map(|stretch| Rest {
            dwell_s: stretch.iter().map(|block| block.duration_s).sum(),
            waits: stretch.iter().any(|block| block.kind == BlockKind::Stop),
        })
        .filter(|rest| rest.waits || rest.dwell_s > STANDSTILL_S)
        .collect()
}

/// From the first motion to the last.
pub(crate) struct Recording {
    pub(crate) rows: Vec<Row>,
}

impl Recording {
    /// From the file that `run` writes, if the machine stood still where the program says and nowhere else.
    ///
    /// LinuxCNC times dwells by another clock than motion, the one of the computer: they count as programmed.
    pub(crate) fn of_motion(text: &str, rests: &[Rest]) -> Result<Self, String> {
        let mut waits = Vec::new();
        let mut positions = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let fields: Vec<f64> = line.split_whitespace().flat_map(str::parse).collect();
            let [count, x, y, z, wait] = fields[..] else {
                return Err(format!("row {number} is `{line}`"));
            };
            if (count - number as f64).abs() > 0.5 {
                return Err(format!("rows were lost before number {count}"));
            }
            positions.push(Vector3::new(x, y, z));
            waits.push(wait > 0.5);
        }
        let (Some(first), Some(last)) = (positions.first(), positions.last()) else {
            return Err("nothing was recorded".to_owned());
        };
        let begin = positions.iter().position(|p| p != first).ok_or("nothing moved")? - 1;
        let end = positions.iter().rposition(|p| p != last).ok_or("nothing moved")? + 1;
        let mut rows: Vec<Row> = Vec::new();
        let mut stood = Vec::new();
        let mut at = begin;
        while at <= end {
            let same = (at..=end).take_while(|&k| positions[k] == positions[at]).count();
            let waited = waits[at..at + same].contains(&true);
            let mut count = same;
            if waited || same as f64 * PERIOD_S > STANDSTILL_S {
                let dwell_s = rests.get(stood.len()).map_or(0.0, |rest| rest.dwell_s);
                count = 1 + (dwell_s / PERIOD_S).round() as usize;
                stood.push(waited);
            }
            for _ in 0..count {
                let time_s = rows.len() as f64 * PERIOD_S;
                rows.push(Row { time_s, position_mm: positions[at] });
            }
            at += same;
        }
        if stood != rests.iter().map(|rest| rest.waits).collect::<Vec<_>>() {
            return Err(format!("it stood still {} times, not {}", stood.len(), rests.len()));
        }
        Ok(Self { rows })
    }

    /// One that was kept.
    pub(crate) fn read(name: &str) -> Vec<Row> {
        let mut text = String::new();
        let file = std::fs::File::open(file(name)).unwrap();
        GzDecoder::new(file).read_to_string(&mut text).unwrap();
        text.lines()
            .skip(1)
            .map(|line| {
                let fields: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
                let [time_s, x, y, z] = fields[..] else { panic!("`{line}` in {name}") };
                Row { time_s, position_mm: Vector3::new(x, y, z) }
            })
            .collect()
    }

    /// Keeps this one.
    pub(crate) fn write(&self, name: &str) {
        let mut text = "time_s,x_mm,y_mm,z_mm\n".to_owned();
        let last = self.rows.len() - 1;
        for (_, row) in self.rows.iter().enumerate().filter(|(k, _)| k % KEPT == 0 || *k == last) {
            let p = &row.position_mm;
            writeln!(text, "{:.3},{:.4},{:.4},{:.4}", row.time_s, p.x, p.y, p.z).unwrap();
        }
        std::fs::create_dir_all(file(name).parent().unwrap()).unwrap();
        let out = std::fs::File::create(file(name)).unwrap();
        let mut out = GzEncoder::new(out, Compression::best());
        out.write_all(text.as_bytes()).unwrap();
        out.finish().unwrap();
    }
}

fn file(name: &str) -> PathBuf {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/planner");
    data.join(format!("{name}.csv.gz"))
}
