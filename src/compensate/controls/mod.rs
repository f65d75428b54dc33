//! The files that controls take, written and read back strictly.

mod asked;
mod csv;
mod fanuc;
mod firmware;
mod isg;
mod lines;
mod linuxcnc;
mod points;
mod siemens;

use super::tables::Tables;
use super::wanted::Wanted;
use crate::error::{Error, Result};

pub use asked::{Limits, Named, Written};
use firmware::Firmware;

/// A control that compensates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// LinuxCNC.
    Linuxcnc,
    /// SINUMERIK 840D sl, 828D.
    Siemens,
    /// Fanuc 0i to 30i.
    Fanuc,
    /// ISG kernel, Beckhoff TF5280.
    Isg,
    /// Any other one.
    Csv,
    /// Klipper.
    Klipper,
    /// Marlin.
    Marlin,
    /// `RepRapFirmware`.
    Reprapfirmware,
    /// grblHAL.
    Grblhal,
}

impl Control {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Linuxcnc,
        Self::Siemens,
        Self::Fanuc,
        Self::Isg,
        Self::Csv,
        Self::Klipper,
        Self::Marlin,
        Self::Reprapfirmware,
        Self::Grblhal,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linuxcnc => "linuxcnc",
            Self::Siemens => "siemens",
            Self::Fanuc => "fanuc",
            Self::Isg => "isg",
            Self::Csv => "csv",
            Self::Klipper => "klipper",
            Self::Marlin => "marlin",
            Self::Reprapfirmware => "reprapfirmware",
            Self::Grblhal => "grblhal",
        }
    }

    /// Its name for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Linuxcnc => "LinuxCNC",
            Self::Siemens => "SINUMERIK 840D sl, 828D",
            Self::Fanuc => "Fanuc 0i, 16i, 18i, 30i",
            Self::Isg => "ISG kernel, Beckhoff TF5280",
            Self::Csv => "any control, as CSV",
            Self::Klipper => "Klipper",
            Self::Marlin => "Marlin",
            Self::Reprapfirmware => "RepRapFirmware",
            Self::Grblhal => "grblHAL",
        }
    }

    /// The control of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|control| control.name() == name)
    }

    /// What it takes as it comes.
    pub fn limits(self) -> Limits {
        let most_points = match self {
            Self::Linuxcnc => linuxcnc::MOST_POINTS,
            Self::Siemens => siemens::MOST_POINTS,
            Self::Fanuc => fanuc::MOST_POINTS,
            Self::Isg => isg::MOST_POINTS,
            _ => csv::MOST_POINTS,
        };
        let most_tables = siemens::MOST_TABLES;
        Limits { most_points, most_tables, unit_mm: 1e-3, step_mm: None }
    }

    fn firmware(self) -> Option<Firmware> {
        match self {
            Self::Klipper => Some(Firmware::Klipper),
            Self::Marlin => Some(Firmware::Marlin),
            Self::Reprapfirmware => Some(Firmware::RepRap),
            Self::Grblhal => Some(Firmware::Grbl),
            _ => None,
        }
    }

    /// Writes its files.
    ///
    /// # Errors
    /// When they cannot hold what was asked for.
    pub fn write(self, wanted: &Wanted, limits: &Limits) -> Result<Written> {
        match self {
            Self::Linuxcnc => Ok(linuxcnc::write(wanted, limits)),
            Self::Siemens => siemens::write(wanted, limits),
            Self::Fanuc => fanuc::write(wanted, limits),
            Self::Isg => isg::write(wanted, limits),
            Self::Csv => Ok(csv::write(wanted, limits)),
            _ => Ok(self.firmware().map_or_else(Written::default, |of| of.write(wanted))),
        }
    }

    /// Reads them back, with the names that they were written under.
    ///
    /// # Errors
    /// When a file is none of this control, or has anything that is not written.
    pub fn read(self, files: &[Named], limits: &Limits) -> Result<Tables> {
        if files.is_empty() {
            return Err(Error::input("there is no file"));
        }
        match self {
            Self::Linuxcnc => linuxcnc::read(files),
            Self::Siemens => siemens::read(files),
            Self::Fanuc => fanuc::read(files, limits.unit_mm),
            Self::Isg => isg::read(files),
            Self::Csv => csv::read(files),
            _ => self.firmware().map_or_else(|| Ok(Tables::default()), |of| of.read(files)),
        }
    }
}
