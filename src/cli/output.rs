//! How the program speaks: data on stdout, talk on stderr.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use serde_json::{Value, json};

use super::common::{Color, Common};
use super::stage::Stage;
use crate::error::{Error, Kind, Result};

/// Headings of a summary, and of those the cautions.
const HEADING: Style = AnsiColor::Cyan.on_default().bold();
const CAUTION: Style = AnsiColor::Yellow.on_default().bold();
/// The word that an error begins with, and the one before its hint.
const ERROR: Style = AnsiColor::Red.on_default().bold();
const HINT: Style = AnsiColor::Cyan.on_default().bold();

/// What goes to stderr.
pub(super) struct Talk {
    quiet: bool,
    verbose: bool,
    json: bool,
    began: Instant,
}

impl Talk {
    pub(super) fn new(common: &Common) -> Self {
        match common.color {
            Color::Auto => ColorChoice::Auto,
            Color::Always => ColorChoice::Always,
            Color::Never => ColorChoice::Never,
        }
        .write_global();
        Self {
            quiet: common.quiet,
            verbose: common.verbose,
            json: common.json,
            began: Instant::now(),
        }
    }

    /// A line for the user, unless he wants quiet.
    pub(super) fn say(&self, text: &str) {
        if !self.quiet {
            // Nobody left to read it is no reason to fail.
            let _ = writeln!(std::io::stderr(), "{}", harmless(text));
        }
    }

    /// The same for who wants to know what is done.
    fn detail(&self, text: &str) {
        if self.verbose {
            self.say(text);
        }
    }

    /// Files that a command reads.
    pub(super) fn reads<'a>(&self, files: impl IntoIterator<Item = &'a PathBuf>) {
        for file in files {
            self.detail(&format!("reads {}", file.display()));
        }
    }

    /// How long all of it took.
    pub(super) fn took(&self) {
        self.detail(&format!("all: {:.2} s", self.began.elapsed().as_secs_f64()));
    }

    /// The error with its hint; a stream that shows no colours gets none. Who reads JSON gets one line of it.
    pub(super) fn error(&self, error: &Error) {
        if self.json {
            let _ = writeln!(std::io::stderr(), "{}", harmless(&error_json(error).to_string()));
            return;
        }
        let text = format!("{ERROR}error{ERROR:#}: {}", harmless(&error.to_string()));
        let text = text.replace("\nhint:", &format!("\n{HINT}hint{HINT:#}:"));
        let _ = writeln!(anstream::stderr(), "{text}");
    }

    /// A stage of so many steps: a bar on a terminal.
    pub(super) fn progress(&self, total: usize, what: &'static str) -> Stage {
        Stage::new(what, total, !self.quiet, self.verbose)
    }

    /// Ends a stage, and tells its time to who wants to know.
    pub(super) fn ended(&self, stage: &Stage) {
        if let Some(took) = stage.end() {
            self.say(&took);
        }
    }
}

/// An error for other programs, with the line where it is as far as it is known.
pub(super) fn error_json(error: &Error) -> Value {
    let place = error.place.as_deref();
    let at = |number: usize| (number > 0).then_some(number);
    let value = place.filter(|place| place.column > 0).map(|place| {
        place.text.chars().skip(place.column - 1).take(place.width).collect::<String>()
    });
    json!({
        "format": "ballbar.error/1",
        "error": {
            "message": error.what,
            "file": place.map(|place| place.file.display().to_string()),
            "line": place.and_then(|place| at(place.line)),
            "column": place.and_then(|place| at(place.column)),
            "value": value.filter(|value| !value.is_empty()),
            "hint": error.hint,
        },
        "exit_code": error.kind.exit_code(),
    })
}

/// A command line that cannot be understood, for other programs.
pub(super) fn usage_json(message: &str) -> String {
    let message = message.trim().trim_start_matches("error: ");
    let (what, rest) = message.split_once("\n\n").unwrap_or((message, ""));
    let all = json!({
        "format": "ballbar.error/1",
        "error": { "message": what, "file": null, "line": null, "column": null, "value": null, "hint": rest.trim() },
        "exit_code": 2,
    });
    all.to_string()
}

/// A path as it is typed into a command line: in quotes where a shell would take it apart.
pub(super) fn typed(path: &Path) -> String {
    let name = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '/' | '.' | '-' | '_' | ',' | '+');
    let plain_here = |c: char| plain(c) || cfg!(windows) && matches!(c, '\\' | ':');
    if name.chars().all(plain_here) {
        name
    } else if cfg!(windows) {
        format!("\"{name}\"")
    } else {
        format!("'{}'", name.replace('\'', r"'\''"))
    }
}

/// A summary on stdout: on a terminal its headings, the lines that are not indented, stand out.
pub(super) fn print_summary(text: &str) -> Result<()> {
    if AutoStream::choice(&std::io::stdout()) == ColorChoice::Never {
        return print(text);
    }
    let text = harmless(text);
    let heading = |line: &str| !line.is_empty() && !line.starts_with(' ');
    let mut coloured = String::with_capacity(text.len() + 512);
    for line in text.lines() {
        let style = match line {
            "Cautions" => CAUTION,
            line if heading(line) => HEADING,
            _ => Style::new(),
        };
        let _ = writeln!(coloured, "{style}{line}{style:#}");
    }
    // It asks the console of Windows to obey the colours.
    send(&mut anstream::stdout().lock(), &coloured)
}

/// Results of a command for other programs, which tell by the format what they have.
pub(super) fn print_json(command: &str, results: Value) -> Result<()> {
    print(&json_text(command, results))
}

/// The same as text.
pub(super) fn json_text(command: &str, mut results: Value) -> String {
    results["format"] = format!("ballbar.{command}/1").into();
    format!("{results:#}\n")
}

/// Data on stdout. A reader that went away, such as `head`, is no error.
pub(super) fn print(text: &str) -> Result<()> {
    send(&mut std::io::stdout().lock(), &harmless(text))
}

/// To stdout as it stands.
fn send(out: &mut impl Write, text: &str) -> Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Error::new(Kind::Output, format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Text that does nothing to a terminal: names come from files of others, and what a terminal obeys (it can clear
/// the screen, and write what was never said) is shown as JSON writes it, so that JSON stays the same.
fn harmless(text: &str) -> Cow<'_, str> {
    let obeyed = |c: char| {
        c.is_control() && !matches!(c, '\n' | '\t')
            // Characters that turn the direction of writing.
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if !text.contains(obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if obeyed(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::{harmless, typed};

    #[cfg(not(windows))]
    #[test]
    fn a_path_can_be_typed_as_it_is_told() {
        for (path, told) in [
            ("vmc/test.toml", "vmc/test.toml"),
            ("Fr\u{e4}se 3/test.toml", "'Fr\u{e4}se 3/test.toml'"),
            ("it's/$HOME", r"'it'\''s/$HOME'"),
        ] {
            assert_eq!(typed(path.as_ref()), told);
        }
    }

    #[cfg(windows)]
    #[test]
    fn a_path_can_be_typed_as_it_is_told() {
        for (path, told) in [
            (r"C:\vmc\test.toml", r"C:\vmc\test.toml"),
            ("Fr\u{e4}se 3\\test.toml", "\"Fr\u{e4}se 3\\test.toml\""),
        ] {
            assert_eq!(typed(path.as_ref()), told);
        }
    }

    #[test]
    fn a_name_cannot_clear_the_screen() {
        let text = "\u{1b}[2J run\r \u{9b}31m \u{202e}nc.1000O\u{7f}";
        assert_eq!(harmless(text), "\\u001b[2J run\\u000d \\u009b31m \\u202enc.1000O\\u007f");
        assert_eq!(harmless("Stra\u{df}e\t1\n"), "Stra\u{df}e\t1\n");
        // In a string of JSON it is the same character as before.
        let json = serde_json::to_string("\u{1b}\u{9b}\n").unwrap();
        let back: String = serde_json::from_str(&harmless(&json)).unwrap();
        assert_eq!(back, "\u{1b}\u{9b}\n");
    }
}
