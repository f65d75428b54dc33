//! Files of controls, as `compensate --on-top` reads them: the name of the control, that of the file, and its text.

use ballbar::compensate::{Control, Tables};
use ballbar::machine::{Axis, Machine, Pose};

use super::{Target, accepted};
use crate::seeds::{self, joined, parts};

const SEEDS: [[&str; 3]; 9] = [
    ["linuxcnc", "joint1.comp", "-100 -100.01 -99.98\n0 0.005 0.025\n100 100.02 100.04\n"],
    [
        "linuxcnc",
        "compensation.ini",
        "# X\n[JOINT_0]\nBACKLASH = 0.02\n[JOINT_1]\nCOMP_FILE = joint1.comp\nCOMP_FILE_TYPE = 0\n",
    ],
    [
        "siemens",
        "NC_CEC.INI",
        "%_N_NC_CEC_INI\nCHANDATA(1)\n$AN_CEC[0,0]=0.001\n$AN_CEC[0,1]=0\n$AN_CEC_INPUT_AXIS[0]=(AX2)\n$AN_CEC_OUTPUT_AXIS[0]=(AX1)\n$AN_CEC_STEP[0]=10\n$AN_CEC_MIN[0]=-10\n$AN_CEC_MAX[0]=0\n$AN_CEC_DIRECTION[0]=-1\n$AN_CEC_MULT_BY_TABLE[0]=0\n$AN_CEC_IS_MODULO[0]=0\nM17\n",
    ],
    [
        "fanuc",
        "PITCH.TXT",
        "%\n(PITCH)\nG10 L50\nN3620 P1 R2\nN3621 P1 R1\nN3622 P1 R3\nN3623 P1 R1\nN3624 P1 R10000\nN10001 R-2\nN10002 R1\nN10003 R7\nN1851 P1 R6\nG11\n%\n",
    ],
    [
        "isg",
        "volcomp.csv",
        "// of a test\nX EXX EYX EZX EAX EBX ECX\n0 0 0 0 0 0 0\n10 0.001 0 0 1e-6 0 0\n#\nY EXY EYY EZY EAY EBY ECY\n0 0 0 0 0 0 0\n#\nZ EXZ EYZ EZZ EAZ EBZ ECZ\n0 0 0 0 0 0 0\n",
    ],
    ["csv", "grid.csv", "x_mm,y_mm,z_mm,cx_um,cy_um,cz_um\n0,0,0,1,2,3\n10,0,0,1,2,4\n"],
    [
        "klipper",
        "printer-skew.cfg",
        "# multiply rotation_distance of stepper_x by 1.0001\n[skew_correction]\n[skew_correction ballbar]\nxy_skew = 0.00005\nxz_skew = 0\nyz_skew = 0.0001\n",
    ],
    [
        "marlin",
        "marlin.gcode",
        "; multiply M92 X by 0.9999\nM852 I0.0001 J0 K-0.0001\nM425 F1 X0.02 Y0 Z0\nM500\n",
    ],
    [
        "grblhal",
        "grblhal.txt",
        "; multiply $100 (steps a millimetre of X) by 0.9999\n$160=0.02\n$161=0\n$162=0\n",
    ],
];

pub const TARGET: Target = Target {
    name: "tables",
    seeds: || SEEDS.map(|parts| joined(&parts.map(str::as_bytes))).into(),
    words: &[
        "linuxcnc",
        "siemens",
        "fanuc",
        "isg",
        "csv",
        "klipper",
        "marlin",
        "reprapfirmware",
        "grblhal",
        "joint0.comp",
        "AX_EEC.INI",
        "axes.csv",
        "volcomp.lis",
        "reprapfirmware.g",
        "$AA_ENC_COMP[0,0,X1]=",
        "M556 S100 X",
        "M425",
        "$163=",
        "N3624 P1 R0",
        "N10000 R8",
        "_STEP",
        "_MAX",
        "[JOINT_9]",
        "BACKLASH",
        "M17",
        "#",
        "//",
        "-1",
        "0",
        "1e400",
        "1e-320",
        "-1e6",
        "NaN",
        "inf",
    ],
    made: &[|| joined(&[b"linuxcnc", b"joint0.comp", "0 0 0\n".repeat(300_000).as_bytes()])],
    read,
};

fn read(input: &[u8]) -> bool {
    let [control, name, text] = parts(input);
    let Some(control) = Control::named(seeds::as_text(control).trim()) else { return false };
    let files = [(seeds::as_text(name).trim().to_owned(), seeds::as_text(text))];
    let tables = control.read(&files, &control.limits());
    let read = accepted(&tables);
    let machine = Machine::parse(seeds::OTHER_MACHINE, "machine.toml".as_ref());
    if let (Ok(tables), Ok(machine)) = (tables, machine) {
        told(&tables, &machine);
    }
    read
}

/// Whatever was read can be taken off anywhere.
fn told(tables: &Tables, machine: &Machine) {
    let tool_mm = machine.slide(Axis::X).location_mm;
    for at in [-1e4, -10.0, 0.0, 3.3, 1e4] {
        for to in [-1.0, 0.0, 1.0] {
            let mut pose = Pose { position_mm: tool_mm, sense: tool_mm };
            for (k, sign) in [1.0, -1.0, 0.5].into_iter().enumerate() {
                pose.position_mm[k] = sign * at;
                pose.sense[k] = sign.signum() * to;
            }
            let taken_mm = tables.error_mm(machine, tool_mm, &pose);
            assert!(taken_mm.iter().all(|mm| mm.is_finite()), "a number is taken off");
        }
    }
}
