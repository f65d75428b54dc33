//! A stage of the work that may take longer than a moment.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// A stage: a bar on a terminal, and with `-v` how long it took.
pub(super) struct Stage {
    bar: ProgressBar,
    what: &'static str,
    began: Instant,
    /// Whether its time is told when it ends; it is told once.
    told: AtomicBool,
}

impl Stage {
    /// One with so many steps; `shown` unless the user wants quiet.
    pub(super) fn new(what: &'static str, total: usize, shown: bool, told: bool) -> Self {
        let bar = if shown && std::io::stderr().is_terminal() {
            ProgressBar::new(total as u64)
        } else {
            ProgressBar::hidden()
        };
        let template = "{msg} [{bar:30}] {pos}/{len} {elapsed}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what);
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar, what, began: Instant::now(), told: AtomicBool::new(told) }
    }

    /// A step is done.
    pub(super) fn inc(&self, steps: u64) {
        self.bar.inc(steps);
    }

    /// Does something while nothing is drawn.
    pub(super) fn suspend<T>(&self, what: impl FnOnce() -> T) -> T {
        self.bar.suspend(what)
    }

    /// Ends it; says how long it took, where that is wanted.
    pub(super) fn end(&self) -> Option<String> {
        self.bar.finish_and_clear();
        let told = self.told.swap(false, Ordering::Relaxed);
        told.then(|| format!("{}: {:.2} s", self.what, self.began.elapsed().as_secs_f64()))
    }
}
