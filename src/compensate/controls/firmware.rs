//! Klipper, Marlin, `RepRapFirmware` and grblHAL: scale, squareness and lost motion, as far as each has a word for them.
//!
//! `s_xy` is the error along X a length of Y: +Y leans to +X. Klipper and Marlin take the tangents and subtract; `RepRapFirmware` adds what it is
//! given, a hundred times the tangent with the other sign. Steps a millimetre grow as the machine falls short.

use std::fmt::Write as _;

use super::asked::{Named, SMALLEST_MM, Written};
use super::lines::{Line, lines, whole};
use crate::compensate::tables::Tables;
use crate::compensate::wanted::Wanted;
use crate::error::Result;
use crate::machine::Axis;

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Firmware {
    Klipper,
    Marlin,
    RepRap,
    Grbl,
}

/// Where the error of `s_xy`, `s_xz` and `s_yz` stands in the matrix.
const SQUARE: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

impl Firmware {
    fn file(self) -> &'static str {
        match self {
            Self::Klipper => "printer-skew.cfg",
            Self::Marlin => "marlin.gcode",
            Self::RepRap => "reprapfirmware.g",
            Self::Grbl => "grblhal.txt",
        }
    }

    /// What a comment begins with.
    fn comment(self) -> char {
        if self == Self::Klipper { '#' } else { ';' }
    }

    fn has_play(self) -> bool {
        self != Self::Klipper
    }

    fn has_skew(self) -> bool {
        self != Self::Grbl
    }

    pub(super) fn write(self, wanted: &Wanted) -> Written {
        let linear = wanted.linear();
        let play_mm = Axis::ALL.map(|axis| wanted.play_mm(axis));
        let mut written = Written::default();
        let mut text = String::new();
        let comment = self.comment();
        for axis in Axis::ALL {
            let scale = linear[(axis.index(), axis.index())];
            let [low, high] = wanted.range_mm(axis);
            if scale.abs() * (high - low) < SMALLEST_MM {
                continue;
            }
            let (what, factor) = match self {
                Self::Klipper => (
                    format!("rotation_distance of stepper_{}", axis.letter().to_ascii_lowercase()),
                    1.0 + scale,
                ),
                Self::Grbl => (
                    format!("${} (steps a millimetre of {axis})", 100 + axis.index()),
                    1.0 / (1.0 + scale),
                ),
                _ => (format!("M92 {axis}"), 1.0 / (1.0 + scale)),
            };
            let _ = writeln!(text, "{comment} multiply {what} by {factor:.9}");
        }
        let [xy, xz, yz] = SQUARE.map(|of| linear[of] + 0.0);
        if self.has_skew() {
            let _ = match self {
                Self::Klipper => writeln!(
                    text,
                    "[skew_correction]\n[skew_correction ballbar]\nxy_skew = {xy:.9}\nxz_skew = {xz:.9}\nyz_skew = {yz:.9}"
                ),
                Self::Marlin => writeln!(text, "M852 I{xy:.9} J{xz:.9} K{yz:.9}"),
                _ => writeln!(
                    text,
                    "M556 S100 X{:.7} Y{:.7} Z{:.7}",
                    -100.0 * xy + 0.0,
                    -100.0 * yz + 0.0,
                    -100.0 * xz + 0.0
                ),
            };
        } else {
            for ((j, k), s) in SQUARE.into_iter().zip([xy, xz, yz]) {
                written.lost.push(format!(
                    "squareness {}{}, {:.1} um/m: it has only the offset of a motor of a gantry ($170 and following), which is this times the distance of the two motors",
                    Axis::ALL[j], Axis::ALL[k], 1e6 * s
                ));
            }
        }
        for (axis, play) in Axis::ALL.into_iter().zip(play_mm) {
            if play < 0.0 && -play >= SMALLEST_MM && self.has_play() {
                written.lost.push(format!(
                    "{axis} gains {:.2} um at a reversal: only lost motion can be said",
                    -1e3 * play
                ));
            }
        }
        let lost = play_mm.map(|play| play.max(0.0));
        match self {
            Self::Klipper => written.lost.extend(
                Axis::ALL
                    .into_iter()
                    .zip(play_mm)
                    .filter(|(_, play)| play.abs() >= SMALLEST_MM)
                    .map(|(axis, play)| {
                        format!(
                            "lost motion of {axis}, {:.2} um: Klipper has no word for it",
                            1e3 * play
                        )
                    }),
            ),
            Self::Marlin => {
                let _ = writeln!(text, "M425 F1 X{:.4} Y{:.4} Z{:.4}", lost[0], lost[1], lost[2]);
                text.push_str("M500\n");
            }
            Self::RepRap => {
                let _ = writeln!(text, "M425 X{:.4} Y{:.4} Z{:.4}", lost[0], lost[1], lost[2]);
            }
            Self::Grbl => {
                for (axis, play) in Axis::ALL.into_iter().zip(lost) {
                    let _ = writeln!(text, "${}={play:.4}", 160 + axis.index());
                }
            }
        }
        written.files = vec![(self.file().into(), text)];
        written.load = self.load();
        written
    }

    fn load(self) -> Vec<String> {
        let all: &[&str] = match self {
            Self::Klipper => &[
                "Put the sections into printer.cfg (an old profile of skew goes), multiply rotation_distance, RESTART, and load with SKEW_PROFILE LOAD=ballbar in the start code; GET_CURRENT_SKEW shows what is active.",
            ],
            Self::Marlin => &[
                "Needs SKEW_CORRECTION_GCODE, for XZ and YZ SKEW_CORRECTION_FOR_Z, and BACKLASH_COMPENSATION with BACKLASH_GCODE. Multiply the steps that M503 shows and send them with M92; send the file; M503 must show the numbers again: a firmware may have fewer decimals.",
                "Marlin corrects inside the bed only: test there.",
            ],
            Self::RepRap => &[
                "Put the lines into config.g, multiply the steps of M92, start again. M556 without words shows what is active.",
            ],
            Self::Grbl => &[
                "Send the lines one by one; $160 to $162 need ENABLE_BACKLASH_COMPENSATION. Multiply $100 to $102. $$ shows what is active.",
            ],
        };
        all.iter().map(|told| (*told).to_owned()).collect()
    }

    pub(super) fn read(self, files: &[Named]) -> Result<Tables> {
        let mut tables = Tables::default();
        for file in files {
            if file.0 != self.file() {
                return Err(whole(&file.0, "no file of this control has this name"));
            }
            for line in lines(file)? {
                let text = line.text.trim();
                let understood = match text.strip_prefix(self.comment()) {
                    Some(told) => self.scale(&line, told.trim(), &mut tables)?,
                    None if text.is_empty() => true,
                    None => self.words(&line, text, &mut tables)?,
                };
                if !understood {
                    return Err(line.faulty("nothing of the kind is written here"));
                }
            }
        }
        if self == Self::Klipper || self == Self::Marlin {
            // x' = x - y xy - z (xz - xy yz)
            let product = tables.linear[SQUARE[0]] * tables.linear[SQUARE[2]];
            tables.linear[SQUARE[1]] -= product;
        }
        Ok(tables)
    }

    fn scale(self, line: &Line, told: &str, tables: &mut Tables) -> Result<bool> {
        let Some((what, factor)) =
            told.strip_prefix("multiply ").and_then(|t| t.split_once(" by "))
        else {
            return Ok(false);
        };
        let named = |axis: &Axis| match self {
            Self::Klipper => {
                what == format!(
                    "rotation_distance of stepper_{}",
                    axis.letter().to_ascii_lowercase()
                )
            }
            Self::Grbl => what.starts_with(&format!("${} ", 100 + axis.index())),
            _ => what == format!("M92 {axis}"),
        };
        let Some(axis) = Axis::ALL.into_iter().find(named) else { return Ok(false) };
        let factor = line.number(factor)?;
        if !(0.5..=2.0).contains(&factor) {
            return Err(line.faulty("no machine is off by that much"));
        }
        // Sent to `h`, it goes `h` divided by what it errs.
        let k = axis.index();
        tables.linear[(k, k)] =
            if self == Self::Klipper { 1.0 - 1.0 / factor } else { 1.0 - factor };
        Ok(true)
    }

    fn words(self, line: &Line, text: &str, tables: &mut Tables) -> Result<bool> {
        if self == Self::Klipper {
            if text == "[skew_correction]" || text == "[skew_correction ballbar]" {
                return Ok(true);
            }
            let Some((key, value)) = text.split_once('=') else { return Ok(false) };
            let of = ["xy_skew", "xz_skew", "yz_skew"].iter().position(|name| *name == key.trim());
            let Some(of) = of else { return Ok(false) };
            tables.linear[SQUARE[of]] = line.number(value)?;
            return Ok(true);
        }
        if let Some((setting, value)) = text.strip_prefix('$').and_then(|t| t.split_once('=')) {
            let axis =
                line.whole(setting)?.checked_sub(160).filter(|k| *k < 3 && self == Self::Grbl);
            let Some(axis) = axis else { return Ok(false) };
            tables.play_mm[axis] = line.number(value)?;
            return Ok(true);
        }
        let mut words = text.split_whitespace();
        let (skew, factor, order) = match self {
            Self::Marlin => ("M852", 1.0, ['I', 'J', 'K']),
            _ => ("M556", -0.01, ['X', 'Z', 'Y']),
        };
        match words.next() {
            Some("M500") if self == Self::Marlin => return Ok(words.next().is_none()),
            Some(code) if code == skew && self != Self::Grbl => {
                for word in words {
                    if word == "S100" && self == Self::RepRap {
                        continue;
                    }
                    let of = order.iter().position(|letter| word.starts_with(*letter));
                    let Some(of) = of else { return Ok(false) };
                    tables.linear[SQUARE[of]] = factor * line.number(&word[1..])?;
                }
            }
            Some("M425") if self != Self::Grbl => {
                for word in words {
                    if word == "F1" && self == Self::Marlin {
                        continue;
                    }
                    let axis = Axis::ALL.into_iter().find(|axis| word.starts_with(axis.letter()));
                    let Some(axis) = axis else { return Ok(false) };
                    tables.play_mm[axis.index()] = line.number(&word[1..])?;
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }
}
