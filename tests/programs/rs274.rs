//! LinuxCNC's stand-alone interpreter, where it is installed; `.ci/run` installs it and asks for it.

use std::process::Command;

/// What the interpreter makes of a program.
pub(crate) struct Canon {
    /// End points of moves in program coordinates, mm.
    pub(crate) ends_mm: Vec<[f64; 3]>,
    /// Of those moves that are arcs: the index of the end, the centre in program coordinates, mm, and the turns begun,
    /// CCW above 0.
    pub(crate) arcs: Vec<(usize, [f64; 3], f64)>,
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
    let mut canon =
        Canon { ends_mm: Vec::new(), arcs: Vec::new(), dwell_s: 0.0, stops: 0, ended: false };
    // The axis that is normal to the plane of arcs.
    let mut normal = 2;
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
            "SELECT_PLANE" => {
                normal = match rest {
                    plane if plane.contains("PLANE_YZ") => 0,
                    plane if plane.contains("PLANE_XZ") => 1,
                    _ => 2,
                };
            }
            "ARC_FEED" => {
                let arc = numbers();
                let (first, second) = ((normal + 1) % 3, (normal + 2) % 3);
                let (mut end_mm, mut centre_mm) = ([0.0; 3], [0.0; 3]);
                (end_mm[first], end_mm[second], end_mm[normal]) = (arc[0], arc[1], arc[5]);
                (centre_mm[first], centre_mm[second], centre_mm[normal]) = (arc[2], arc[3], arc[5]);
                canon.arcs.push((canon.ends_mm.len(), centre_mm, arc[4]));
                canon.ends_mm.push(end_mm);
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
