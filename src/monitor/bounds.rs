//! What numbers, names and lists of an analysis may be.

/// Largest magnitude of a number, in whatever unit.
const LARGEST: f64 = 1e9;
/// Most entries of a list, and most letters of a name.
pub(super) const MOST: usize = 10_000;
const LONGEST: usize = 1000;

/// Something that may be, or why it may not.
pub(super) type Checked<T> = std::result::Result<T, String>;

pub(super) fn number(value: f64, what: &str) -> Checked<f64> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    Err(format!("{what} is {value}; numbers go from -{LARGEST:e} to {LARGEST:e}"))
}

pub(super) fn deviation(value: f64, what: &str) -> Checked<f64> {
    if (0.0..=LARGEST).contains(&value) {
        return Ok(value);
    }
    Err(format!("the standard deviation of {what} is {value}; they go from 0 to {LARGEST:e}"))
}

pub(super) fn name(text: String, what: &str) -> Checked<String> {
    if text.len() <= LONGEST {
        return Ok(text);
    }
    Err(format!("{what} has more than {LONGEST} bytes"))
}

pub(super) fn few<T>(list: Vec<T>, what: &str) -> Checked<Vec<T>> {
    if list.len() <= MOST {
        return Ok(list);
    }
    Err(format!("there are more than {MOST} {what}"))
}
