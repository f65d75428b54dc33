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

/// The names of several parameters; a long list is cut.
pub(in crate::report) fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MOST: usize = 12;
    let names: Vec<&str> = names.collect();
    let told = names[..names.len().min(MOST)].join(", ");
    match names.len().saturating_sub(MOST) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}
