//! What the logs of a campaign say of the day besides their readings.

use super::campaign::Campaign;
use crate::log::{Log, Said};

impl Campaign {
    /// Who measured and with what, where the logs that say it say the same.
    pub fn said(&self) -> Said {
        let said = || self.logs().filter_map(Log::by_angle).map(|log| &log.said);
        Said {
            operator: alike(said().filter_map(|said| said.operator.clone())),
            bar_serial: alike(said().filter_map(|said| said.bar_serial.clone())),
            bar_calibrated: alike(said().filter_map(|said| said.bar_calibrated)),
        }
    }
}

/// The one value of all; `None` of none, and where they differ.
fn alike<T: PartialEq>(mut values: impl Iterator<Item = T>) -> Option<T> {
    let first = values.next()?;
    values.all(|value| value == first).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::alike;

    #[test]
    fn what_two_files_say_otherwise_is_not_said() {
        assert_eq!(alike(["Meier", "Meier"].into_iter()), Some("Meier"));
        assert_eq!(alike(["Meier", "Huber"].into_iter()), None);
        assert_eq!(alike(std::iter::empty::<&str>()), None);
    }
}
