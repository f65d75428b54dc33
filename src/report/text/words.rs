//! Words: capitals, lists, the signs of the trade.

/// The signs of the trade instead of ASCII.
pub(in crate::report) fn fine(text: &str) -> String {
    text.replace(" um", " µm").replace(" urad", " µrad").replace("+-", "±")
}

/// A sentence begins with a capital.
pub(in crate::report) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The first names, and how many more there are: so many fit on two lines.
pub fn list(names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    const MOST: usize = 12;
    let names: Vec<_> = names.into_iter().collect();
    let first: Vec<&str> = names.iter().take(MOST).map(AsRef::as_ref).collect();
    let first = first.join(", ");
    match names.len().saturating_sub(MOST) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_stays_a_line() {
        let names: Vec<String> = (0..45).map(|k| format!("E{k}")).collect();
        let whole = "E0, E1, E2, E3, E4, E5, E6, E7, E8, E9, E10, E11 and 33 more";
        assert_eq!(list(&names), whole);
        assert_eq!(list(&names[..2]), "E0, E1");
    }
}
