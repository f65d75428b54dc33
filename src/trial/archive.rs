//! The campaigns of trials as a data set for others: each a zip of its own, the same bytes every time.

use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::request::Request;
use crate::error::{Error, Kind, Result};
use crate::model::Effect;

/// A campaign as if it had been measured, and what is true of it.
#[derive(Debug)]
pub struct CampaignFiles {
    /// Which.
    pub request: Request,
    /// Size of each hidden effect outside of the model, mm rms.
    pub size_mm: f64,
    /// What is hidden, with the share of its rms outside of the model.
    pub hidden: Vec<(Effect, f64)>,
    /// In a grid: the value of every factor.
    pub strata: Vec<(&'static str, String)>,
    /// Name and text of every file: machine, test, programs, logs, truth.
    pub files: Vec<(String, String)>,
}

impl CampaignFiles {
    /// The name of its zip.
    pub fn archive_name(&self) -> String {
        format!("{}-{}.zip", self.request.class, self.request.index)
    }

    /// All files in a zip that tells neither when nor where it was made.
    ///
    /// # Errors
    /// When it would be too large for a zip.
    pub fn zip(&self) -> Result<Vec<u8>> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .system(System::Unix)
            .unix_permissions(0o644);
        let written = || {
            let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
            for (name, text) in &self.files {
                archive.start_file(name.as_str(), options)?;
                archive.write_all(text.as_bytes())?;
            }
            archive.finish()
        };
        let written = written().map_err(|error: zip::result::ZipError| {
            let what = format!("{} cannot be written: {error}", self.archive_name());
            Error::new(Kind::Output, what)
        })?;
        Ok(written.into_inner())
    }

    /// Its row of the table of all campaigns.
    pub fn row(&self) -> CampaignRow {
        let effects: Vec<String> =
            self.hidden.iter().map(|(effect, _)| effect.to_string()).collect();
        let shares: Vec<String> =
            self.hidden.iter().map(|(_, share)| format!("{share:.4}")).collect();
        let size_um = if self.hidden.is_empty() { 0.0 } else { 1e3 * self.size_mm };
        let mut fields = vec![
            ("campaign".to_owned(), self.archive_name()),
            ("class".to_owned(), self.request.class.to_string()),
            ("index".to_owned(), self.request.index.to_string()),
            ("hidden".to_owned(), effects.join(" + ")),
            ("size_um".to_owned(), format!("{size_um:.4}")),
            ("share_seen".to_owned(), shares.join(" + ")),
        ];
        let named = |(factor, value): &(&str, String)| (factor.replace(' ', "_"), value.clone());
        fields.extend(self.strata.iter().map(named));
        CampaignRow(fields)
    }
}

/// A row of the table of all campaigns: columns with their values.
#[derive(Debug)]
pub struct CampaignRow(Vec<(String, String)>);

/// The table of all campaigns as CSV. Columns are those of any row, in the order in which they come; a row without one
/// leaves it empty.
pub fn campaigns_csv(rows: &[CampaignRow]) -> String {
    let mut columns: Vec<&str> = Vec::new();
    for (column, _) in rows.iter().flat_map(|row| &row.0) {
        if !columns.contains(&column.as_str()) {
            columns.push(column);
        }
    }
    let mut text = line(columns.iter().copied());
    for CampaignRow(fields) in rows {
        let value = |column: &&str| {
            fields.iter().find(|(of, _)| of.as_str() == *column).map(|(_, value)| value.as_str())
        };
        text += &line(columns.iter().map(|column| value(column).unwrap_or_default()));
    }
    text
}

/// Effects have commas in them.
fn line<'a>(fields: impl Iterator<Item = &'a str>) -> String {
    let fields: Vec<String> = fields
        .map(|field| {
            if field.contains([',', '"']) {
                format!("\"{}\"", field.replace('"', "\"\""))
            } else {
                field.to_owned()
            }
        })
        .collect();
    fields.join(",") + "\n"
}
