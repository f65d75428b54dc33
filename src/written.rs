//! Numbers in the unit in which files name them: lengths are kept in mm and written in um.

use serde::Serializer;

/// A length kept in mm, written in um: for fields that are called `.._um` outside.
///
/// # Errors
/// When the serializer cannot write a number.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
pub(crate) fn um<S: Serializer>(mm: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(mm * 1e3)
}
