//! What is done about what people ask, and about the features of a plane.

const SCALE: &str = "correct the scale in the control (pitch error compensation), after the machine has had time to warm up";
const SQUARENESS: &str =
    "align the guideways, or enter it in the squareness compensation of the control";
const LOST: &str = "check nut, coupling and bearings of the drive; what is left is for the backlash compensation of the control";
const OVER: &str = "lower the backlash compensation of the control by this, and measure again";
const LATERAL: &str =
    "adjust the gibs or the preload of the guideways; no compensation of backlash removes it";
const POSITIONING: &str = "enter it in the pitch error compensation of the axis";
const STRAIGHTNESS: &str =
    "level the machine and align the guideways; straightness compensation where the control has it";
const SERVO: &str =
    "set equal position gains (Fanuc 1825) and feed-forward on all axes, then repeat at two feeds";

/// By the first word of a name: `squareness XY`, `backlash Y`. `lost` says of a reversal whether the motion is lost or
/// over-compensated.
pub(in crate::report) fn of(name: &str, lost: bool) -> Option<&'static str> {
    let mut words = name.split(' ');
    let (first, second) = (words.next()?, words.next().unwrap_or(""));
    match first {
        // A slide that turns at its reversals, such as `reversal ECX`.
        "reversal" if second.len() > 1 => Some(LATERAL),
        "scale" => Some(SCALE),
        "squareness" => Some(SQUARENESS),
        "reversal" | "backlash" if lost => Some(LOST),
        "reversal" | "backlash" => Some(OVER),
        "lateral" => Some(LATERAL),
        "positioning" => Some(POSITIONING),
        "straightness" => Some(STRAIGHTNESS),
        "servo" => Some(SERVO),
        _ => None,
    }
}
