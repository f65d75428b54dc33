//! A program that is right, and the ways in which it is broken.

use ballbar::nc::Severity;

/// Retract, approach, engagement, three degrees of the equator there and back, release, retract.
pub(crate) const BASE: &str = "\
%
O1001 (BALL-BAR FREE R150 F500)
(MOUNTING A - G54 ZERO IS THE WORKPIECE BALL)
N10 G21 G17 G90 G94 G40 G49 G80
G69 G15 G50
N20 G54
N30 G64
(APPROACH)
M00 (BALL-BAR MUST BE OFF)
G00 G53 Z399.000
G53 X191.500 Y-40.000
N35 M00 (COMPARE)
N40 G00 X171.500 Y-5.000 Z-5.000
N50 G01 X151.500 Y0.000 Z0.000 F500.
N60 M00 (FIT BALL-BAR)
N70 G04 P2000
(ENGAGE)
N80 G01 X150.000 Y0.000 Z0.000
N90 G04 P3000
(ARC 1 FORWARD)
G01 X149.999 Y0.654 Z0.000
X149.994 Y1.309 Z0.000
X149.987 Y1.963 Z0.000
X149.977 Y2.618 Z0.000
X149.964 Y3.272 Z0.000
X149.949 Y3.927 Z0.000
N100 G04 P3000
(ARC 1 BACKWARD)
G01 X149.964 Y3.272 Z0.000
X149.977 Y2.618 Z0.000
X149.987 Y1.963 Z0.000
X149.994 Y1.309 Z0.000
X149.999 Y0.654 Z0.000
X150.000 Y0.000 Z0.000
N110 G04 P3000
(RELEASE)
N120 G01 X151.500 Y0.000 Z0.000
N130 G04 P2000
M00 (TAKE BALL-BAR OFF)
G00 Z359.000
N140 M30
%
";

/// What is done to the program; the finding is expected in the first line that differs, unless the case
/// says otherwise.
#[derive(Clone, Copy)]
pub(crate) enum Edit {
    /// The first of these becomes that.
    Replace(&'static str, &'static str),
    /// Lines are put behind the first line that holds this.
    Insert(&'static str, &'static str),
    /// Everything from the first of these on is cut off.
    Cut(&'static str),
}
use Edit::{Cut, Insert, Replace};

/// Where the finding is expected.
#[derive(Clone, Copy)]
pub(crate) enum At {
    /// In the first line that differs, at this column (0: the line as a whole).
    Edit(usize),
    /// In the first line that holds this, at this column.
    Line(&'static str, usize),
    /// In the file as a whole.
    File,
}
use At::{Edit as Here, File, Line};

/// What LinuxCNC's interpreter says.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Rs274 {
    Refuses,
    /// It lets pass what a Fanuc, or a ball-bar, trips over.
    Passes,
    /// It refuses what a Fanuc allows: why.
    OnlyItself(&'static str),
}
use Rs274::{OnlyItself, Passes, Refuses};

pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) edit: Edit,
    pub(crate) severity: Severity,
    pub(crate) at: At,
    pub(crate) told: &'static str,
    pub(crate) rs274: Rs274,
}

const fn case(
    name: &'static str,
    edit: Edit,
    severity: Severity,
    at: At,
    told: &'static str,
    rs274: Rs274,
) -> Case {
    Case { name, edit, severity, at, told, rs274 }
}

const E: Severity = Severity::Error;
const W: Severity = Severity::Warning;
/// An arc block that most cases break.
const CHORD: &str = "X149.987 Y1.963 Z0.000";

#[rustfmt::skip]
pub(crate) const CASES: &[Case] = &[
    // Words and numbers.
    case("no decimal point", Replace("X149.987 Y1.963", "X149987 Y1.963"), E, Here(1), "X149987 has no decimal point: the control reads 149.987 mm", Passes),
    case("no decimal point, small", Replace("Y1.963 Z0.000", "Y2 Z0.000"), E, Here(10), "Y2 has no decimal point: the control reads 0.002 mm", Passes),
    case("two decimal points", Replace(CHORD, "X149.98.7 Y1.963 Z0.000"), E, Here(1), "more than one decimal point", Refuses),
    case("decimal comma", Replace(CHORD, "X149,987 Y1.963 Z0.000"), E, Here(5), "`,` has no meaning", Refuses),
    case("two signs", Replace(CHORD, "X149.987 Y--1.963 Z0.000"), E, Here(10), "more than one sign", Passes),
    case("sign behind", Replace(CHORD, "X149.987- Y1.963 Z0.000"), E, Here(1), "sign in the number after X is not in front", Refuses),
    case("exponent", Replace(CHORD, "X149.987 Y1.963E0 Z0.000"), E, Here(16), "E0 has no meaning", Refuses),
    case("no number", Replace(CHORD, "X149.987 Y Z0.000"), E, Here(10), "Y has no number", Refuses),
    case("letter for digit", Replace(CHORD, "X149.987 Y1.963 ZO.000"), E, Here(17), "Z has no number", Refuses),
    case("number without address", Replace(CHORD, "149.987 Y1.963 Z0.000"), E, Here(1), "a number without an address", Refuses),
    case("more decimals than the control has", Replace("Y1.963 Z0.000", "Y1.9634 Z0.000"), W, Here(10), "Y1.9634 has more than 3 decimals", Passes),
    case("nine digits", Replace("Y1.963 Z0.000", "Y196300.000 Z0.000"), E, Here(10), "outside of -99999.999 to 99999.999 mm", Passes),
    case("address twice", Replace(CHORD, "X149.987 Y1.963 Y0.000"), E, Here(17), "a second Y in one block", Refuses),
    case("unknown G", Replace("N30 G64", "N30 G66.6"), E, Here(5), "G66.6 is not known", Refuses),
    case("unknown M", Replace("N140 M30", "N140 M987\nN150 M30"), E, Here(6), "M987 is not known", Refuses),
    case("rotary axis", Replace(CHORD, "X149.987 Y1.963 Z0.000 B10."), E, Here(24), "B10 has no meaning", Passes),
    case("macro", Replace(CHORD, "X#100 Y1.963 Z0.000"), E, Here(1), "X has no number", Passes),
    case("tool length compensation", Replace("G40 G49", "G40 G43 H1"), E, Here(25), "G43 is not known", Passes),
    case("cutter compensation", Replace("G40 G49", "G41 D1 G49"), E, Here(21), "G41 is not known", Refuses),
    case("fixed cycle", Insert("N30", "G81 Z-5.000 R2.000 F100."), E, Here(1), "G81 is not known", Passes),
    case("inverse time feed", Replace("G94", "G93"), E, Here(17), "G93 is not known", Refuses),
    case("tool change", Insert("N30", "T1 M06"), E, Here(4), "M06 is not known", Passes),
    case("reference return", Insert("N30", "G91 G28 Z0."), E, Here(5), "G28 is not known", Refuses),
    // Characters, comments, the file.
    case("lower case", Replace("G01 X149.964 Y3.272", "g01 x149.964 y3.272"), E, Here(1), "the address `g` is in lower case", Passes),
    case("lower case in a comment", Replace("(RELEASE)", "(Release)"), W, Here(3), "`e` in a comment", Passes),
    case("not ASCII", Replace("(RELEASE)", "(LÖSEN)"), E, Here(3), "`Ö` is not an ASCII character", Passes),
    case("character that comments must not have", Replace("(RELEASE)", "(RELEASE!)"), W, Here(9), "`!` in a comment", Passes),
    case("comment not closed", Replace("(RELEASE)", "(RELEASE"), E, Here(1), "the comment is not closed", Refuses),
    case("comment in a comment", Replace("(RELEASE)", "(RELEASE (OUT))"), E, Here(15), "a comment is closed that was not opened", Refuses),
    case("comment closed twice", Replace("(RELEASE)", "(RELEASE))"), E, Here(10), "a comment is closed that was not opened", Refuses),
    case("comment behind a semicolon", Replace(CHORD, "X149.987 Y1.963 Z0.000 ; POLE"), E, Here(26), "text follows the end of the block", Passes),
    case("block too long", Replace("(RELEASE)", LONG), E, Here(0), "the block has 302 characters", Refuses),
    case("no % at the beginning", Replace("%\nO1001", "O1001"), W, File, "does not begin with %", Passes),
    case("no % at the end", Cut("%\n\0"), E, Line("M30", 0), "begins with % and does not end with it", Passes),
    case("blocks behind the last %", Insert("M30", "%\nN150 G01 X0. Y0. Z0."), W, Line("N150", 0), "outside of the two %", Passes),
    case("% inside a block", Replace(CHORD, "X149.987 % Y1.963 Z0.000"), E, Here(10), "% stands inside a block", Refuses),
    // Numbers of blocks and programs, ends.
    case("N0", Replace("N100", "N0"), E, Here(1), "N0 is out of range", Passes),
    case("N beyond 99999", Replace("N100", "N100000"), E, Here(1), "N100000 is out of range", Passes),
    case("N negative", Replace("N100", "N-100"), E, Here(1), "N-100 is not a block number", Refuses),
    case("N twice", Replace("N100", "N90"), W, Here(1), "a second block N90", Passes),
    case("N in the middle", Replace("N100 G04", "G04 N100"), E, Here(5), "a block number stands inside a block", Refuses),
    case("O0", Replace("O1001", "O0"), E, Here(1), "O0 is not a program number", Passes),
    case("O of the builder", Replace("O1001", "O9001"), W, Here(1), "O9001 belongs to the machine tool builder", Passes),
    case("O with five digits", Replace("O1001", "O10010"), W, Here(1), "more than four digits", Passes),
    case("O is a name", Replace("O1001", "OBAR"), E, Here(1), "O has no number", Refuses),
    case("O inside the program", Insert("(RELEASE)", "O1002"), E, Line("(RELEASE)", 0), "the program ends at line 36 without M30", Passes),
    case("no M30", Replace("N140 M30\n", ""), E, Line("G00 Z359", 0), "ends at line 40 without M30", Passes),
    case("blocks behind M30", Insert("M30", "N150 G00 X300.000"), W, Here(0), "nothing leads to this block", Passes),
    case("M99 in the main program", Replace("M30", "M99"), E, Here(6), "M99 in the main program", Passes),
    case("two M words", Replace("N140 M30", "N140 M00 M30"), E, Here(10), "a second M in one block", Refuses),
    case("call of nothing", Insert("N90", "M98 P2000"), E, Here(5), "the file has no subprogram O2000", Refuses),
    case("subprogram that nobody calls", Replace("M30\n%\n\0", "M30\nO2000\nG04 P100\nM99\n%\n"), W, Line("G04 P100", 0), "nothing calls O2000", Passes),
    case("subprogram without return", Replace("N140 M30\n%\n\0", "M98 P2000\nN140 M30\nO2000\nG04 P100\n%\n"), E, Line("G04 P100", 0), "subprogram O2000 ends at line 44 without M99", Passes),
    case("block delete", Replace("N100", "/N100"), W, Here(1), "depends on a switch", Passes),
    // Modal state.
    case("G00 and G01", Replace("N80 G01", "N80 G00 G01"), E, Here(9), "G01 in a block that already sets the kind of motion", Refuses),
    case("G90 and G91", Replace("G90 G94", "G90 G91"), E, Here(17), "G91 in a block that already sets absolute or incremental", Refuses),
    case("two planes", Replace("G17 G90", "G17 G18 G90"), E, Here(13), "G18 in a block that already sets the plane", Refuses),
    case("no F", Replace(" F500.", ""), E, Here(9), "a feed move without a feed", Refuses),
    case("F of zero", Replace("F500.", "F0."), E, Here(9), "a feed move without a feed", Refuses),
    case("F negative", Replace("F500.", "F-500."), E, Here(32), "the feed -500 is negative", Refuses),
    case("a larger F", Replace("F500.", "F5000."), E, Line("N80", 0), "5000.0 mm/min with the bar fitted", Passes),
    case("a smaller F", Replace("F500.", "F50."), W, Line("G01 X149.999", 0), "an arc at 50.0 mm/min", Passes),
    case("coordinates before any G00", Replace("G00 G53 Z399.000", "Z399.000"), E, Here(1), "coordinates before the first G00", Refuses),
    case("incremental from nowhere", Replace("G90", "G91"), E, Line("N40", 9), "an incremental move from a place of X", Refuses),
    case("incremental by mistake", Replace("G01 X149.999", "G91 G01 X149.999"), E, Here(9), "axis X would go to 319.999 mm", Passes),
    case("other work offset", Replace("N20 G54", "N20 G55"), E, Line("N40", 9), "a coordinate in G55, which is not known", Passes),
    case("inches", Replace("G21", "G20"), E, Line("N40", 9), "axis X would go to 4376.100 mm", Passes),
    case("G53 with G01", Replace("N80 G01", "N80 G53 G01"), E, Here(5), "G53 without G00", Passes),
    case("arc without its centre", Replace(CHORD, "G03 X149.987 Y1.963 Z0.000"), E, Here(1), "an arc without I, J, K and R", Refuses),
    case("arc with a wrong centre", Replace(CHORD, "G03 X149.987 Y1.963 I-100. J5."), E, Here(21), "the arc starts at radius", Refuses),
    case("dwell without a time", Replace("N90 G04 P3000", "N90 G04"), E, Here(5), "a dwell needs one time", Refuses),
    case("dwell with P in seconds", Replace("P3000", "P3.0"), E, Here(9), "by P has a decimal point", Passes),
    case("dwell of milliseconds", Replace("P3000", "P3"), W, Here(9), "a dwell of 3 ms", Passes),
    case("dwell with X in milliseconds", Replace("G04 P3000", "G04 X3"), E, Here(9), "the control waits 3 ms", Refuses),
    case("dwell by X", Replace("G04 P3000", "G04 X3.0"), W, File, "", OnlyItself("a Fanuc dwells by X in seconds; LinuxCNC knows P only")),
    case("look-ahead of the control", Insert("(ARC 1 FORWARD)", "G05.1 Q1"), W, File, "", OnlyItself("G05.1 is AI contour control on a Fanuc, and a spline on LinuxCNC")),
    // Machine.
    case("beyond the travel", Replace("X171.500", "X371.500"), E, Here(9), "axis X would go to 391.500 mm", Passes),
    case("spindle", Insert("N30", "M03 S100"), E, Here(1), "M03 turns the spindle", Passes),
    case("coolant", Insert("N30", "M08"), W, Here(1), "M08 turns the coolant on", Passes),
    case("feed of a rocket", Replace("F500.", "F500000."), E, Here(32), "a feed of 500000", Passes),
    // The bar.
    case("rapid into the reach", Replace("N80 G01", "N80 G00"), E, Here(0), "within the reach of the bar", Passes),
    case("rapid with the bar engaged", Replace("G01 X149.964", "G00 X149.964"), E, Here(0), "within the reach of the bar", Passes),
    case("stop inside an arc", Insert("X149.987", "M00"), E, Here(0), "a stop inside an arc", Passes),
    case("stop inside an arc, with a comment", Insert("X149.987", "M00 (LOOK)"), E, Here(0), "a stop inside an arc", Passes),
    case("optional stop inside an arc", Insert("X149.987", "M01"), W, Here(1), "M01 inside an arc", Passes),
    case("dwell inside an arc", Insert("X149.987", "G04 P500"), W, Here(0), "a dwell inside an arc", Passes),
    case("coolant off inside an arc", Insert("X149.987", "M09"), W, Here(1), "M09 inside an arc", Passes),
    case("G53 inside an arc", Insert("X149.987", "G00 G53 Z40.000\nG01"), W, Here(5), "G53 inside an arc", Passes),
    case("mistyped coordinate", Replace("X149.987", "X147.987"), E, Here(0), "the bar would be 2.000 mm shorter", Passes),
    case("transposed digits", Replace("X149.987", "X149.897"), W, Here(0), "um off the sphere", Passes),
    case("lost sign", Replace("G01 X149.964 Y3.272", "G01 X149.964 Y-3.272"), W, Here(0), "the chord sags", Passes),
    case("chord left out", Replace("X149.987 Y1.963 Z0.000\nX149.977 Y2.618 Z0.000\n", ""), W, Here(0), "the chord sags", Passes),
    case("exact stop", Replace("N30 G64", "N30 G61"), W, Line("G01 X149.999", 0), "exact stop at every chord", Passes),
    case("exact stop in one block", Replace(CHORD, "G09 X149.987 Y1.963 Z0.000"), W, Here(0), "exact stop at every chord", OnlyItself("G09 is a Fanuc's exact stop; it is only worth a warning")),
    case("no engagement", Replace("N80 G01 X150.000 Y0.000 Z0.000\n", ""), W, Line("G01 X149.999", 0), "the bar does not engage along the radius", Passes),
    case("nowhere near the sphere", Replace("G01 X151.500", "M30"), E, File, "the bar never engages", Passes),
    case("no release", Replace("N120 G01 X151.500 Y0.000 Z0.000\n", ""), E, Line("G00 Z359", 0), "within the reach of the bar", Passes),
    case("release to the inside", Replace("N120 G01 X151.500", "N120 G01 X148.500"), E, Here(0), "1.500 mm shorter", Passes),
    case("no stop to fit the bar", Replace("N60 M00 (FIT BALL-BAR)\n", ""), W, Line("N80", 0), "no M00 before the bar engages", Passes),
    case("a slide that has not moved", Replace("Y-40.000\nN35 M00 (COMPARE)\nN40 G00 X171.500 Y-5.000", "Y-35.000\nN35 M00 (COMPARE)\nN40 G00 X171.500 Y0.000"), W, Line("N80", 0), "Y has not moved when the bar engages", Passes),
    case("bar not taken off", Replace("M00 (TAKE BALL-BAR OFF)\n", ""), E, Line("G00 Z359", 0), "positioning with the bar fitted", Passes),
    case("end with the bar fitted", Replace("M00 (TAKE BALL-BAR OFF)\nG00 Z359.000\n", ""), W, Line("N140", 0), "the program ends with the bar fitted", Passes),
    case("second start", Replace("G00 G53 Z399.000\nG53 X191.500 Y-40.000\nN35 M00 (COMPARE)\nN40 G00 X171.500", "N40 G00 X-171.500"), E, Line("N40", 0), "started again from its end, positioning passes", Passes),
    // What is in force at power-on.
    case("first motion", Replace("G00 G53 Z399.000\nG53 X191", "G00 G53 X191"), E, Line("G00 G53 X191", 0), "started from X20.000 Y-35.000 Z40.000 of the machine, positioning passes 0.000 mm", Passes),
    case("absolute or not", Replace("G90 G94", "G94"), E, Line("G00 G53", 0), "before the program has stated G90", Passes),
    case("compensation or not", Replace(" G40 G49", ""), E, Line("G00 G53", 0), "before the program has stated G40, G49", Passes),
    case("work offset or not", Replace("N20 G54\n", ""), E, Line("G00 G53", 0), "before the program has stated G54", Passes),
    case("rotation or not", Replace("G69 G15 G50\n", ""), W, Line("G00 G53", 0), "before the program has stated G69, G15, G50", Passes),
    case("the spindle nose beside the post", Insert("N40 G00", "G01 X171.500 Y-5.000 Z-150.000 F500.\nX60.000\nX171.500"), E, Line("X60.000", 0), "spindle nose and support touch on COMPARE at the ball vector (72.", Passes),
    case("the spindle nose beside the post, at rapid", Insert("N40 G00", "G00 X171.500 Y-5.000 Z-150.000\nX30.000 Y-5.000\nX171.500"), E, Line("X30.000", 0), "spindle nose and support touch on COMPARE at the ball vector (", Passes),
];

const LONG: &str = concat!(
    "(",
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
    "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
    ")"
);

impl Case {
    /// The broken program, and the line of the first difference.
    pub(crate) fn program(&self) -> (String, usize) {
        // The end of the text can be named too.
        let base = format!("{BASE}\0");
        let broken = match self.edit {
            Replace(from, to) => {
                assert!(base.contains(from), "{}: {from}", self.name);
                base.replacen(from, to, 1)
            }
            Insert(after, lines) => {
                let at = base.find(after).unwrap_or_else(|| panic!("{}: {after}", self.name));
                let end = at + base[at..].find('\n').unwrap() + 1;
                format!("{}{lines}\n{}", &base[..end], &base[end..])
            }
            Cut(from) => base[..base.find(from).unwrap()].to_owned(),
        };
        let broken = broken.replace('\0', "");
        let line = BASE.lines().zip(broken.lines()).take_while(|(a, b)| a == b).count() + 1;
        (broken, line)
    }
}
