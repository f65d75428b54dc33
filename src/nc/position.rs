//! Where the machine stands, as far as the program has said so, and where a block takes it.

use nalgebra::Vector3;

use super::arc::Ends;
use super::code::{Code, Motion};
use super::command::Command;
use super::grammar::{Form, Grammar};
use super::modal::Modal;
use super::program::{Move, Path};
use super::reading::Reading;
use super::word::{Fault, Letters, Word};

/// Addresses of coordinates.
pub(crate) const COORDINATES: Letters = Letters::of(b"XYZ");

/// Addresses of arcs.
pub(crate) const ARC: Letters = Letters::of(b"IJKR");

/// A shorter line is none, mm: far below any input increment, far above the rounding of a sum.
const NO_LENGTH_MM: f64 = 1e-7;

/// What the coordinates of a block make of the machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Moved {
    /// Nothing.
    Not,
    /// It moves from a place that is known.
    Along(Move),
    /// It positions from a place that is not known in all three axes: where to, mm, as far as that is known.
    Opening([Option<f64>; 3]),
}

/// The state that moves depend on.
#[derive(Debug)]
pub(crate) struct Machine<'a> {
    reading: &'a Reading,
    grammar: &'static Grammar,
    /// What stays in force from block to block.
    pub(crate) modal: Modal,
    /// Machine coordinates in mm of X, Y, Z, each known once it was commanded absolutely.
    position: [Option<f64>; 3],
    /// The centre of arcs to come, likewise, in a dialect that states it beforehand.
    pole: [Option<f64>; 3],
}

impl<'a> Machine<'a> {
    /// A machine that may stand anywhere.
    pub(crate) fn new(reading: &'a Reading) -> Self {
        let grammar = Grammar::of(reading.dialect);
        Self { reading, grammar, modal: Modal::default(), position: [None; 3], pole: [None; 3] }
    }

    fn length_mm(&self, word: &Word) -> f64 {
        self.modal.length_mm(word, self.grammar.increments)
    }

    /// Takes over what a block that could not be followed puts in force and where it leads, as far as
    /// its words tell.
    pub(crate) fn assume(&mut self, words: &[Word]) {
        for word in words {
            match word.letter {
                b'G' => {
                    if let Ok(code) = self.grammar.code(word) {
                        if matches!(code, Code::Dwell | Code::MachineCoordinates | Code::Pole) {
                            return;
                        }
                        self.modal.apply(code);
                    }
                }
                // A negative feed has been told already; without one, every block would be told too.
                b'F' => drop(self.modal.set_feed(&Word { value: word.value.abs(), ..*word })),
                _ => {}
            }
        }
        let Some(zero) = self.reading.work_offsets_mm.get(&self.modal.work_offset) else { return };
        for word in words {
            let axis = usize::from(word.letter.wrapping_sub(b'X'));
            let Some(before) = self.position.get(axis).copied() else { continue };
            let value = self.length_mm(word);
            self.position[axis] = if self.modal.incremental {
                before.map(|from| from + value)
            } else {
                Some(zero[axis] + value)
            };
        }
    }

    /// Obeys the coordinates of a block.
    pub(crate) fn motion(&mut self, command: &Command) -> Result<Moved, Fault> {
        let Some(first) = command.first(COORDINATES.and(ARC)) else {
            return match command.one_shot {
                Some((_, word)) => {
                    Err(Fault::word(word, format!("{} without X, Y or Z", word.name()))
                        .hint("it says where to position in machine coordinates, in its own block"))
                }
                None => Ok(Moved::Not),
            };
        };
        if let Some((Code::Pole, _)) = command.one_shot {
            let at_mm = self.target(command)?;
            let stated = |axis: usize| command.coordinate(axis).and(at_mm[axis]);
            self.pole = [0, 1, 2].map(stated);
            return Ok(Moved::Not);
        }
        let Some(motion) = self.modal.motion else {
            return Err(Fault::word(first, "coordinates before the first G00, G01, G02 or G03")
                .hint(
                    "a parameter of the control decides which of them holds at the start: write it",
                ));
        };
        if let (Motion::Rapid | Motion::Line, Some(word)) = (motion, command.first(ARC)) {
            return Err(self.grammar.unknown(word));
        }
        let target = self.target(command)?;
        if motion == Motion::Rapid {
            return Ok(self.positioning(target, command));
        }
        let start_mm = self.known_start(first)?;
        let end_mm = Vector3::from_fn(|axis, _| target[axis].unwrap_or(start_mm[axis]));
        if self.modal.feed_mm_s <= 0.0 {
            return Err(Fault::word(first, "a feed move without a feed")
                .hint("write F before it or in its block; a change between G20 and G21 also asks for a new F"));
        }
        let path = match motion {
            Motion::Arc { counter_clockwise } => {
                let ends =
                    Ends { start_mm, end_mm, axis: self.modal.plane_axis, counter_clockwise };
                self.arc(command, ends)?
            }
            Motion::Rapid | Motion::Line => Path::Line,
        };
        if path == Path::Line && (end_mm - start_mm).norm() < NO_LENGTH_MM {
            return Ok(Moved::Not);
        }
        self.position = target;
        Ok(Moved::Along(Move {
            rapid: false,
            path,
            start_mm,
            end_mm,
            feed_mm_s: self.modal.feed_mm_s,
            exact_stop: self.modal.exact_stop || command.exact_stop,
        }))
    }

    /// G00, from a known place or to one.
    fn positioning(&mut self, target: [Option<f64>; 3], command: &Command) -> Moved {
        let start = all(self.position);
        if let (Some(start_mm), Some(end_mm)) = (start, all(target)) {
            if (end_mm - start_mm).norm() < NO_LENGTH_MM {
                return Moved::Not;
            }
            self.position = target;
            return Moved::Along(Move {
                rapid: true,
                path: Path::Line,
                start_mm,
                end_mm,
                feed_mm_s: 0.0,
                exact_stop: self.modal.exact_stop || command.exact_stop,
            });
        }
        self.position = target;
        Moved::Opening(target)
    }

    /// Where the coordinates of the block lead; an axis without a word stays where it is.
    fn target(&self, command: &Command) -> Result<[Option<f64>; 3], Fault> {
        let in_machine_coordinates = match command.one_shot {
            Some((Code::MachineCoordinates, word)) => {
                self.check_machine_coordinates(word)?;
                true
            }
            _ => false,
        };
        let mut target = self.position;
        for (axis, target) in target.iter_mut().enumerate() {
            let Some(word) = command.coordinate(axis) else {
                continue;
            };
            let value = self.length_mm(word);
            *target = Some(if in_machine_coordinates {
                value
            } else if self.modal.incremental {
                let from = self.position[axis].ok_or_else(|| {
                    let letter = char::from(word.letter);
                    Fault::word(
                        word,
                        format!("an incremental move from a place of {letter} that is not known"),
                    )
                    .hint(format!(
                        "the machine may stand anywhere: position {letter} with {} first",
                        self.grammar.rapid
                    ))
                })?;
                from + value
            } else {
                self.zero(word)?[axis] + value
            });
        }
        Ok(target)
    }

    /// G53 is only unambiguous with G00 and G90: with G01 one make of control positions and another
    /// feeds, with G91 it is ignored or incremental.
    fn check_machine_coordinates(&self, word: &Word) -> Result<(), Fault> {
        if self.modal.motion != Some(Motion::Rapid) {
            let name = word.name();
            let rapid = self.grammar.rapid.rsplit(' ').next().unwrap_or_default();
            return Err(Fault::word(word, format!("{name} without {rapid}")).hint(format!(
                "whether {name} then feeds or positions depends on the control: write {}",
                self.grammar.machine_rapid
            )));
        }
        if self.modal.incremental {
            let name = word.name();
            return Err(Fault::word(word, format!("{name} with G91")).hint(format!(
                "whether {name} is then obeyed depends on the control: write {}",
                self.grammar.machine_rapid
            )));
        }
        Ok(())
    }

    /// Machine coordinates of the zero of the work offset in force, mm.
    fn zero(&self, word: &Word) -> Result<&Vector3<f64>, Fault> {
        let number = self.modal.work_offset;
        self.reading.work_offsets_mm.get(&number).ok_or_else(|| {
            Fault::word(word, format!("a coordinate in G{number}, which is not known")).hint(
                format!("state the machine coordinates of the zero of G{number} in the test file"),
            )
        })
    }

    /// The start of a feed move, which must be known in all three axes.
    fn known_start(&self, word: &Word) -> Result<Vector3<f64>, Fault> {
        all(self.position).ok_or_else(|| {
            let unknown: Vec<&str> = ["X", "Y", "Z"]
                .into_iter()
                .zip(self.position)
                .filter_map(|(name, position)| position.is_none().then_some(name))
                .collect();
            let names = unknown.join(" and ");
            Fault::word(word, format!("a feed move from a place of {names} that is not known"))
                .hint(format!(
                    "the machine may stand anywhere: position {names} with {} first",
                    self.grammar.rapid
                ))
        })
    }

    /// The angle of an arc about the pole.
    fn about_pole(&self, command: &Command, ends: Ends) -> Result<Path, Fault> {
        let word = command.motion;
        let fault = |what: String| {
            word.map_or_else(|| Fault::line(what.clone()), |word| Fault::word(word, &*what))
        };
        let mut offset_mm = Vector3::zeros();
        for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate().filter(|(k, _)| *k != ends.axis)
        {
            let pole_mm = self.pole[axis].ok_or_else(|| {
                fault(format!("an arc whose pole has no {name}")).hint(
                    "write CC with both coordinates of the plane before C; TOOL CALL Z makes it XY",
                )
            })?;
            offset_mm[axis] = pole_mm - ends.start_mm[axis];
        }
        ends.about(offset_mm).map_err(|none| fault(none.what).hint(none.hint))
    }

    /// The centre and the angle of an arc.
    fn arc(&self, command: &Command, ends: Ends) -> Result<Path, Fault> {
        if self.grammar.form == Form::Klartext {
            return self.about_pole(command, ends);
        }
        let centers = [b'I', b'J', b'K'].map(|letter| command.word(letter));
        let first_center = command.first(Letters::of(b"IJK"));
        let made = match (first_center, command.word(b'R')) {
            (None, None) => {
                let word = command.motion.or(command.first(COORDINATES));
                let what = "an arc without I, J, K and R";
                let fault = word.map_or_else(|| Fault::line(what), |word| Fault::word(word, what));
                return Err(
                    fault.hint("write its centre by I, J, K or its radius by R; lines need G01")
                );
            }
            (Some(_), Some(radius)) => {
                return Err(Fault::word(radius, "an arc by centre and by radius at once")
                    .hint("write either I, J, K or R"));
            }
            (None, Some(radius)) => {
                ends.of_radius(self.length_mm(radius)).map_err(|none| (none, radius))
            }
            (Some(first), None) => {
                if let Some(word) = centers[ends.axis] {
                    let plane = ["YZ (G19)", "ZX (G18)", "XY (G17)"][ends.axis];
                    let what = format!(
                        "{} is not in the plane of the arc, {plane}",
                        char::from(word.letter)
                    );
                    return Err(Fault::word(word, what)
                        .hint("choose the plane by G17, G18 or G19, or remove the word"));
                }
                let offset = Vector3::from_fn(|axis, _| {
                    centers[axis].map_or(0.0, |word| self.length_mm(word))
                });
                ends.about(offset).map_err(|none| (none, first))
            }
        };
        made.map_err(|(none, word)| Fault::word(word, none.what).hint(none.hint))
    }
}

/// The point, when all its coordinates are known.
fn all(position: [Option<f64>; 3]) -> Option<Vector3<f64>> {
    match position {
        [Some(x), Some(y), Some(z)] => Some(Vector3::new(x, y, z)),
        _ => None,
    }
}
