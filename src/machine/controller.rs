//! The control: what it writes, reads and does at corners.

use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::bounds::ACCELERATIONS_MM_S2;
use crate::error::{Error, Result};
use crate::toml_text::Text;

/// Which control reads the programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dialect {
    /// Fanuc 15i/150i and its relatives.
    #[default]
    Fanuc,
    /// LinuxCNC, RS274/NGC.
    LinuxCnc,
    /// Siemens SINUMERIK 840D sl, 828D and their relatives.
    Siemens,
    /// HEIDENHAIN TNC and iTNC, Klartext.
    Heidenhain,
}

impl Dialect {
    /// All, the default first.
    pub const ALL: [Self; 4] = [Self::Fanuc, Self::LinuxCnc, Self::Siemens, Self::Heidenhain];

    /// What its controls can do besides and usually can, each ended by words of their own at the beginning of a program.
    pub fn usual_options(self) -> &'static [&'static str] {
        match self {
            Self::Fanuc => &["G69", "G15", "G50"],
            Self::LinuxCnc => &[],
            Self::Siemens => &["TRAFOOF", "TRANS", "COMPOF"],
            Self::Heidenhain => &["CYCL DEF 7", "CYCL DEF 8", "CYCL DEF 10", "CYCL DEF 11"],
        }
    }

    /// The same with those that fewer of its controls have.
    fn options(self) -> &'static [&'static str] {
        match self {
            Self::Heidenhain => &[
                "CYCL DEF 7",
                "CYCL DEF 8",
                "CYCL DEF 10",
                "CYCL DEF 11",
                "PLANE RESET STAY",
                "M129",
            ],
            _ => self.usual_options(),
        }
    }

    /// Finest decimals of an axis word.
    fn most_decimals(self) -> usize {
        match self {
            Self::Heidenhain => 4,
            _ => 6,
        }
    }

    /// Whether a file holds subprograms behind the program.
    pub fn divides(self) -> bool {
        matches!(self, Self::Fanuc | Self::LinuxCnc)
    }

    /// The planes, by their normal, in which it drives arcs of one block; the others are chords.
    pub fn turns_about(self, normal: usize) -> bool {
        self != Self::Heidenhain || normal == 2
    }

    /// Its name in a machine file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fanuc => "fanuc",
            Self::LinuxCnc => "linuxcnc",
            Self::Siemens => "siemens",
            Self::Heidenhain => "heidenhain",
        }
    }
}

/// What the control writes, reads and does at corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// The dialect of the programs.
    pub dialect: Dialect,
    /// Decimals of an axis word.
    pub decimals: usize,
    /// Step of the N numbers; 0 writes none.
    pub sequence_step: u32,
    /// Characters allowed in comments besides letters and digits.
    pub comment_characters: String,
    /// Block that switches look-ahead on, empty for none.
    pub look_ahead_on: String,
    /// Block that switches look-ahead off, empty for none.
    pub look_ahead_off: String,
    /// Blocks that cancel what this control can do besides and somebody may have left in force.
    pub cancel_blocks: Vec<String>,
    /// Acceleration along the path at feed, mm/s².
    pub path_acceleration_mm_s2: f64,
    /// Corners sharper than this are taken with a stop, rad.
    pub corner_stop_rad: f64,
    /// By how much the speed of a slide may jump at a corner, mm/s; infinite where only
    /// [`Controller::corner_stop_rad`] counts.
    pub corner_speed_step_mm_s: f64,
    /// Within how much the control rounds corners, mm: the arc that fits is driven with the acceleration
    /// of the path across it. Infinite where that does not limit the speed.
    pub corner_tolerance_mm: f64,
    /// In how much time the acceleration along the path builds up, s; 0 at once. The jerk is the
    /// acceleration over this time.
    pub acceleration_change_s: f64,
    /// Time that the control needs to prepare a block, s; 0 none.
    pub block_time_s: f64,
    /// Largest program that the control's memory holds, bytes; none if it does not matter.
    pub memory_bytes: Option<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawController {
    dialect: Spanned<String>,
    decimals: Spanned<usize>,
    sequence_step: Spanned<u32>,
    comment_characters: String,
    look_ahead_on: Spanned<String>,
    look_ahead_off: Spanned<String>,
    cancel_blocks: Option<Spanned<Vec<String>>>,
    path_acceleration_mm_s2: Spanned<f64>,
    corner_stop_deg: Spanned<f64>,
    corner_speed_step_mm_min: Option<Spanned<f64>>,
    corner_tolerance_um: Option<Spanned<f64>>,
    acceleration_change_ms: Spanned<f64>,
    block_time_ms: Spanned<f64>,
    memory_kb: Option<Spanned<f64>>,
}

impl Default for RawController {
    fn default() -> Self {
        fn bare<T>(value: T) -> Spanned<T> {
            Spanned::new(Range { start: 0, end: 0 }, value)
        }
        Self {
            dialect: bare("fanuc".into()),
            decimals: bare(3),
            sequence_step: bare(10),
            // The characters that the generic Fanuc post-processors let through.
            comment_characters: " .,=_-".into(),
            look_ahead_on: bare(String::new()),
            look_ahead_off: bare(String::new()),
            cancel_blocks: None,
            path_acceleration_mm_s2: bare(500.0),
            corner_stop_deg: bare(25.0),
            corner_speed_step_mm_min: None,
            corner_tolerance_um: None,
            acceleration_change_ms: bare(0.0),
            block_time_ms: bare(0.0),
            memory_kb: None,
        }
    }
}

impl RawController {
    pub(super) fn check(self, text: &Text<'_>) -> Result<Controller> {
        let name = self.dialect.get_ref();
        let dialect =
            Dialect::ALL.into_iter().find(|dialect| dialect.name() == name).ok_or_else(|| {
                Error::input(format!("unknown dialect `{name}`"))
                    .at(text.place(self.dialect.span()))
                    .hint(format!(
                        "write one of `{}`",
                        Dialect::ALL.map(Dialect::name).join("`, `")
                    ))
            })?;
        let decimals = *self.decimals.get_ref();
        let most = dialect.most_decimals();
        if !(2..=most).contains(&decimals) {
            return Err(Error::input(format!("an axis word cannot have {decimals} decimals"))
                .at(text.place(self.decimals.span()))
                .hint(format!(
                    "give 2 to {most}: increment system IS-B has 3 decimals, IS-C has 4"
                )));
        }
        if let Some(memory) = self.memory_kb.as_ref().filter(|_| !dialect.divides()) {
            return Err(Error::input("programs of this control are not divided")
                .at(text.place(memory.span()))
                .hint("subprograms are files of their own there: leave `memory_kb` out"));
        }
        for block in [&self.look_ahead_on, &self.look_ahead_off] {
            check_look_ahead(block, dialect, text)?;
        }
        let sequence_step = *self.sequence_step.get_ref();
        if sequence_step > LARGEST_STEP {
            return Err(Error::input(format!(
                "blocks cannot be numbered in steps of {sequence_step}"
            ))
            .at(text.place(self.sequence_step.span()))
            .hint(format!("give 1 to {LARGEST_STEP}, or 0 for no numbers")));
        }
        let corner_deg = *self.corner_stop_deg.get_ref();
        if !(0.0..=180.0).contains(&corner_deg) {
            return Err(Error::input(format!("a corner of {corner_deg} degrees cannot be"))
                .at(text.place(self.corner_stop_deg.span()))
                .hint("give the angle between the two directions of motion, 0 to 180"));
        }
        Ok(Controller {
            dialect,
            decimals,
            sequence_step,
            comment_characters: self.comment_characters,
            look_ahead_on: self.look_ahead_on.into_inner(),
            look_ahead_off: self.look_ahead_off.into_inner(),
            cancel_blocks: check_cancel(self.cancel_blocks, dialect, text)?,
            path_acceleration_mm_s2: text.within(
                &self.path_acceleration_mm_s2,
                "path_acceleration_mm_s2",
                ACCELERATIONS_MM_S2[0],
                ACCELERATIONS_MM_S2[1],
            )?,
            corner_stop_rad: corner_deg.to_radians(),
            corner_speed_step_mm_s: match &self.corner_speed_step_mm_min {
                None => f64::INFINITY,
                Some(step) => text.within(step, "corner_speed_step_mm_min", 0.1, 1e6)? / 60.0,
            },
            corner_tolerance_mm: match &self.corner_tolerance_um {
                None => f64::INFINITY,
                Some(tolerance) => text.within(tolerance, "corner_tolerance_um", 0.01, 1e5)? * 1e-3,
            },
            acceleration_change_s: text.within(
                &self.acceleration_change_ms,
                "acceleration_change_ms",
                0.0,
                1000.0,
            )? * 1e-3,
            block_time_s: text.within(&self.block_time_ms, "block_time_ms", 0.0, 1000.0)? * 1e-3,
            memory_bytes: match &self.memory_kb {
                None => None,
                Some(memory) => {
                    Some((text.within(memory, "memory_kb", 0.1, LARGEST_KB)? * 1024.0) as usize)
                }
            },
        })
    }
}

/// A larger program is not read anyway, KB.
const LARGEST_KB: f64 = 65_536.0;

/// N numbers go to 99999 and then begin anew, which leaves a hundred of them different.
const LARGEST_STEP: u32 = 1000;

/// All options of the dialect that its controls usually have, or those that the file says the control has: of the others
/// the word is an alarm.
fn check_cancel(
    blocks: Option<Spanned<Vec<String>>>,
    dialect: Dialect,
    text: &Text<'_>,
) -> Result<Vec<String>> {
    let Some(blocks) = blocks else {
        return Ok(dialect.usual_options().iter().map(|&block| block.to_owned()).collect());
    };
    let options = dialect.options();
    let place = text.place(blocks.span());
    let blocks = blocks.into_inner();
    let unknown = |(k, block): (usize, &String)| {
        !options.contains(&block.as_str()) || blocks[..k].contains(block)
    };
    if let Some((_, block)) = blocks.iter().enumerate().find(|&of| unknown(of)) {
        let what = format!("`{}` is nothing to cancel once", block.escape_debug());
        let hint = if options.is_empty() {
            "LinuxCNC has nothing to cancel: leave `cancel_blocks` out".to_owned()
        } else {
            format!("write those of `{}` that the control knows, each once", options.join("`, `"))
        };
        return Err(Error::input(what).at(place).hint(hint));
    }
    Ok(blocks)
}

/// A block around every arc switches the look-ahead and does nothing else: on a Fanuc G05.1 Q, G05 P or G08 P with a number,
/// alone; on a Siemens words that change how the path is followed and not where it leads.
fn check_look_ahead(block: &Spanned<String>, dialect: Dialect, text: &Text<'_>) -> Result<()> {
    let written = block.get_ref();
    let words: Vec<&str> = written.split_whitespace().collect();
    let known = match dialect {
        Dialect::Fanuc => {
            let joined = words.concat();
            let switches = |begin: &str| {
                let argument = joined.strip_prefix(begin);
                argument.is_some_and(|n| !n.is_empty() && n.bytes().all(|c| c.is_ascii_digit()))
            };
            ["G05.1Q", "G5.1Q", "G05P", "G5P", "G08P", "G8P"].into_iter().any(switches)
        }
        Dialect::Siemens => words.iter().enumerate().all(|(k, word)| {
            ["FFWON", "FFWOF", "SOFT", "BRISK"].contains(word) && !words[..k].contains(word)
        }),
        Dialect::LinuxCnc | Dialect::Heidenhain => false,
    };
    if words.is_empty() || known {
        return Ok(());
    }
    Err(Error::input(format!("`{}` does not switch a look-ahead", written.escape_debug()))
        .at(text.place(block.span()))
        .hint(match dialect {
            Dialect::Fanuc => {
                "write `G05.1 Q1`, `G05 P10000` or `G08 P1`, off with 0, or leave it empty"
            }
            Dialect::Siemens => {
                "write `FFWON`, `SOFT` or both, off with `FFWOF`, or leave it empty"
            }
            Dialect::LinuxCnc => "LinuxCNC has no word for it: leave it empty",
            Dialect::Heidenhain => "a TNC has no word for it: leave it empty",
        }))
}
