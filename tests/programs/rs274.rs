//! LinuxCNC's stand-alone interpreter, where it is installed; `.ci/run` installs it and asks for it.

use std::process::Command;

/// What the interpreter makes of a program.
pub(crate) struct Canon {
    /// End points of moves in program coordinates, mm.
    pub(crate) ends_mm: Vec<[f64; 3]>,
    /// Sum of the dwells, s.
    pub(crate) dwell_s: f64,
    /// How often it stops.
    pub(crate) stops: usize,
    /// It came to M30.
    pub(crate) ended: bool,
}

/// Interprets a program; the error is the interpreter's own message.
pub(crate) fn interpret(program: &str) -> Result<Canon, String> {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("program.ngc");
    std::fs::write(&file, program).unwrap();
    // It keeps its tools in a file in the home directory, where another one would truncate it.
    let mut command = Command::new("rs274");
    let output = command.env("HOME", directory.path()).arg("-g").arg(&file).output().unwrap();
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr).replace("executing\n", "");
        return Err(told.lines().next().unwrap_or("no message").to_owned());
    }
    let mut canon = Canon { ends_mm: Vec::new(), dwell_s: 0.0, stops: 0, ended: false };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Some((call, rest)) = line.split_once('(') else { continue };
        let numbers = || {
            let inside = rest.trim_end_matches(')').split(',');
            inside.map(|number| number.trim().parse::<f64>().unwrap()).collect::<Vec<_>>()
        };
        match call.rsplit(' ').next().unwrap_or("") {
            "STRAIGHT_FEED" | "STRAIGHT_TRAVERSE" => {
                let at = numbers();
                canon.ends_mm.push([at[0], at[1], at[2]]);
            }
            "DWELL" => canon.dwell_s += numbers()[0],
            "PROGRAM_STOP" => canon.stops += 1,
            "PROGRAM_END" => canon.ended = true,
            _ => {}
        }
    }
    Ok(canon)
}

/// The words in which a Fanuc and LinuxCNC differ, as LinuxCNC writes them: dwells count in seconds by P,
/// and neither the look-ahead nor rotation, polar coordinates and scaling have words.
pub(crate) fn translated(fanuc: &str) -> String {
    let block = |line: &str| {
        if ["G05", "G08 P", "G69", "G15", "G50"].iter().any(|word| line.contains(word)) {
            return String::new();
        }
        match line.split_once("G04 P") {
            Some((head, ms)) if !ms.contains('.') && !line.starts_with('(') => {
                let digits = ms.find(|c: char| !c.is_ascii_digit()).unwrap_or(ms.len());
                match ms[..digits].parse::<f64>() {
                    Ok(ms_value) => {
                        format!("{head}G04 P{:.3}{}", ms_value / 1e3, &ms[digits..])
                    }
                    Err(_) => line.to_owned(),
                }
            }
            _ => line.to_owned(),
        }
    };
    fanuc.lines().map(|line| block(line) + "\n").collect()
}
