//! How the files that an analysis is of are named in it.

use super::facts::Analysis;

impl Analysis {
    /// Names every file as it is to be called in what is written; what has no name stays without.
    pub fn name_files(&mut self, name: &dyn Fn(&str) -> String) {
        let before = self.before.iter_mut().flat_map(|before| &mut before.repeats);
        let runs = self.repeats.iter_mut().chain(before).flat_map(|repeat| &mut repeat.runs);
        let of_runs = runs.flat_map(|run| [&mut run.program, &mut run.log]);
        for file in of_runs.chain([&mut self.test.file, &mut self.machine.file]) {
            if !file.is_empty() {
                *file = name(file);
            }
        }
    }
}
