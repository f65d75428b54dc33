"""The stages of the library on NumPy arrays; see the package for what is common to all."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, SupportsIndex, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "AlignedRun",
    "Campaign",
    "Compensation",
    "Diagnosis",
    "Identification",
    "IdentifiedRun",
    "Linearised",
    "Machine",
    "Plan",
    "Problem",
    "Program",
    "Run",
    "Simulation",
    "Test",
    "Trials",
    "Volume",
    "__version__",
    "_panic",
    "align",
    "compensate",
    "diagnose",
    "identify",
    "plan",
    "programs",
    "simulate",
    "volume",
]

_Array = NDArray[np.float64]
_Path = str | os.PathLike[str]

__version__: str

@final
class Machine:
    """A machine: the order of its slides, their travels and accelerations, its control. It can be pickled."""

    @staticmethod
    def read(path: _Path) -> Machine:
        """Read a machine file."""

    @staticmethod
    def parse(text: str, file: _Path = ...) -> Machine:
        """Check the text of a machine file; ``file`` is for messages."""

    @staticmethod
    def of(keys: Mapping[str, Any]) -> Machine:
        """A machine of a mapping with the keys of the file: docs/reference.md."""

    @staticmethod
    def builtin(name: str) -> Machine:
        """A machine that is in the package: ``"vertical"``, ``"horizontal"`` or ``"hu40t"``."""

    @property
    def name(self) -> str: ...
    @property
    def file(self) -> Path: ...
    @property
    def text(self) -> str:
        """The text of the file."""

    @property
    def topology(self) -> str:
        """From the workpiece ``w`` over the slides to the tool ``t``."""

    @property
    def travel_mm(self) -> _Array:
        """Lowest and highest machine coordinate of X, Y, Z, mm, shape (3, 2)."""

    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Test:
    """A test: machine, bar, mountings, arcs, what is estimated, and the runs that were measured. It can be pickled."""

    __test__ = False

    @staticmethod
    def read(path: _Path, machine: Machine | None = None) -> Test:
        """Read a test file and, unless one is given, the machine file that it names."""

    @staticmethod
    def parse(text: str, machine: Machine | None = None, file: _Path = ...) -> Test:
        """Check the text of a test file; paths in it are relative to the folder of ``file``."""

    @staticmethod
    def of(keys: Mapping[str, Any], machine: Machine | None = None, file: _Path = ...) -> Test:
        """A test of a mapping with the keys of the file; with a machine, ``"machine"`` need not be among them."""

    def estimating(
        self,
        *,
        terms: Sequence[str] | None = None,
        loss: str | None = None,
        minimum_norm: bool | None = None,
    ) -> Test:
        """The same test with another choice of what is estimated: the keys of ``[identify]``."""

    @property
    def name(self) -> str: ...
    @property
    def file(self) -> Path: ...
    @property
    def text(self) -> str:
        """The text of the file."""

    @property
    def machine(self) -> Machine: ...
    @property
    def terms(self) -> list[str]: ...
    @property
    def mountings(self) -> list[str]:
        """Their names, in order."""

    @property
    def coincidence_mm(self) -> _Array:
        """Where the balls coincide in each mounting, machine coordinates, mm, shape (mountings, 3)."""

    @property
    def tool_ball_mm(self) -> _Array:
        """The tool ball in the frame of the last slide on the tool side, mm, shape (mountings, 3)."""

    @property
    def bar_length_mm(self) -> _Array:
        """Nominal length of the bar in each mounting, mm, shape (mountings,)."""

    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Program:
    """An NC program of a test."""

    @property
    def name(self) -> str:
        """Name of its file."""

    @property
    def mounting(self) -> str: ...
    @property
    def text(self) -> str: ...

@final
class Run:
    """A program that ran and what the bar read. It can be pickled, without what is true of a simulated run.

    Its arrays are checked and copied once.

    Args:
        program: text of the program.
        time_s: on the instrument's clock, increasing, s, shape (n,), C-contiguous float64.
        deviation_um: length minus nominal length, um, shape (n,); NaN where the bar was out of range.
        name: what it is called in messages.
        mounting: its name; may be left out where the test has one.
        repeat: runs of the same repeat are identified together.
        feed_override_percent: where the knob stood, 1 to 200.
    """

    def __new__(
        cls,
        program: str,
        time_s: _Array,
        deviation_um: _Array,
        *,
        name: str = "run1",
        mounting: str = "",
        repeat: int = 1,
        feed_override_percent: float = 100.0,
    ) -> Run: ...
    def with_deviation_um(self, deviation_um: _Array) -> Run:
        """The same run with other readings at its times, um, shape (n,): to hide an effect of one's own."""

    @property
    def name(self) -> str: ...
    @property
    def program(self) -> str: ...
    @property
    def mounting(self) -> str: ...
    @property
    def repeat(self) -> int: ...
    @property
    def feed_override_percent(self) -> float: ...
    @property
    def time_s(self) -> _Array:
        """Shape (n,), s; a copy."""

    @property
    def deviation_um(self) -> _Array:
        """Shape (n,), um, NaN out of range; a copy."""

    @property
    def true_deviation_um(self) -> _Array | None:
        """What the bar would have read without noise, steps and range, um, shape (n,); of a simulated run."""

    @property
    def true_position_mm(self) -> _Array | None:
        """Where the slides were commanded to be, mm, shape (n, 3); of a simulated run."""

    @property
    def true_program_s(self) -> _Array | None:
        """Where in its program the machine was, s, shape (n,); of a simulated run."""

    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Simulation:
    """The runs of a virtual machine, and what is true of it."""

    @property
    def runs(self) -> list[Run]: ...
    @property
    def truth(self) -> str:
        """What was put in, TOML as in truth.toml."""

@final
class Plan:
    """What a test takes and what it will determine; p parameters."""

    @property
    def names(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def sigma_noise(self) -> _Array:
        """Standard deviation of each parameter by the noise, in its unit, shape (p,)."""

    @property
    def observed(self) -> _Array:
        """How much of each the test determines, 0 to 1, shape (p,)."""

    @property
    def covariance(self) -> _Array:
        """Shape (p, p), in the units of the parameters."""

    @property
    def rank(self) -> int: ...
    @property
    def samples(self) -> int: ...
    @property
    def machine_s(self) -> float:
        """Time that the machine takes, s."""

    @property
    def total_s(self) -> float:
        """Time with that of the operator, s."""

    def answers(self) -> dict[str, dict[str, Any]]:
        """What will be known at the place of the test; as :meth:`Identification.answers`."""

    def report(self) -> dict[str, Any]:
        """What plan.json holds: docs/plan-schema.md."""

@final
class AlignedRun:
    """A log laid over its program, before any fit."""

    @property
    def name(self) -> str: ...
    @property
    def mounting(self) -> str: ...
    @property
    def bar_length_mm(self) -> float: ...
    @property
    def clock_rate_ppm(self) -> float:
        """How much faster the machine's clock goes than the instrument's, 1e-6."""

    @property
    def sample_period_s(self) -> float: ...
    def columns(self) -> dict[str, Any]:
        """Where every reading was taken: float64 arrays of shape (n,) or, of X, Y, Z, (n, 3).

        ``log_s``, ``program_s``, ``time_sigma_s``, ``elapsed_s`` (since the program began), ``deviation_um``,
        ``position_mm`` (n, 3), ``velocity_mm_s`` (n, 3), ``sense`` (n, 3; -1, 0, 1), and int64 ``arc`` (-1 outside of
        arcs), ``leg``, ``line`` (number of the reading in its log).
        """

@final
class Campaign:
    """All repeats of a test, identified; indexing gives an :class:`Identification`."""

    @property
    def terms(self) -> list[str]: ...
    @property
    def repeats(self) -> list[Identification]: ...
    @property
    def left_out(self) -> list[tuple[str, str]]:
        """Runs that took no part, each with the reason."""

    @property
    def cautions(self) -> list[str]: ...
    @property
    def elapsed_s(self) -> float:
        """How long the library took, s; NaN of a campaign that came of a diagnosis."""

    def analysis(self) -> dict[str, Any]:
        """What analysis.json holds: docs/analysis-schema.md."""

    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex, /) -> Identification: ...

@final
class Identification:
    """One repeat, identified; p parameters, each in the unit that ``units`` has."""

    @property
    def names(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def value(self) -> _Array:
        """Shape (p,)."""

    @property
    def sigma_noise(self) -> _Array:
        """Standard deviations by the noise: what repeats would scatter, shape (p,)."""

    @property
    def sigma_all(self) -> _Array:
        """By the noise and by what these runs cannot tell from other plausible faults; NaN where none was assumed."""

    @property
    def plausible(self) -> _Array:
        """Standard deviations of what was taken for plausible, NaN where nothing was, shape (p,)."""

    @property
    def observed(self) -> _Array:
        """How much of each the data determine, 0 to 1, shape (p,)."""

    @property
    def covariance(self) -> _Array:
        """By the noise, shape (p, p)."""

    @property
    def correlation(self) -> _Array:
        """Shape (p, p)."""

    @property
    def left_open(self) -> _Array | None:
        """What one plausible standard deviation of each fault (column) does to the estimates, then what each effect that nobody has
        explained has moved them by; shape (p, faults)."""

    @property
    def rank(self) -> int: ...
    @property
    def condition(self) -> float: ...
    @property
    def rms_um(self) -> float:
        """Root mean square of what the fit leaves, um."""

    @property
    def used(self) -> int:
        """Readings that took part."""

    @property
    def steps(self) -> int: ...
    @property
    def cautions(self) -> list[str]: ...
    @property
    def noise_um(self) -> float:
        """Standard deviation of the noise of a reading, um."""

    @property
    def noise_phi(self) -> _Array:
        """Coefficients of the autoregression of the noise, shape (order,)."""

    @property
    def noise_innovation_um(self) -> float:
        """Standard deviation of what is new in every reading, um."""

    @property
    def runs(self) -> list[IdentifiedRun]: ...
    def answers(self) -> dict[str, dict[str, Any]]:
        """What people ask of the machine at the place of the test.

        By name, such as ``"squareness XY"``: ``value``, ``sigma_noise``, ``sigma_all`` (or ``None``), all in ``unit``
        (``"um/m"``, ``"um"`` or ``"urad"``). Empty where there is no such place.
        """

    def problem(self) -> Problem:
        """The least squares that the fit came to rest at."""

    def linearised(self) -> Linearised:
        """The fit as orthonormal columns, to set columns of one's own beside."""

@final
class IdentifiedRun:
    """A run that took part; n readings."""

    @property
    def name(self) -> str: ...
    @property
    def mounting(self) -> str: ...
    @property
    def bar_length_mm(self) -> float: ...
    def columns(self) -> dict[str, Any]:
        """What is known of every reading: the columns of :meth:`AlignedRun.columns` with refined times, and more.

        ``computed_um``, ``residual_um`` (observed minus computed), ``whitened`` (in standard deviations, NaN where it
        took no part), ``weight`` (0 to 1), ``used`` (bool), all of shape (n,); ``apart``: why it took no part, a list.
        """

    def jacobian(self) -> _Array:
        """Change of the deviation at every reading with each parameter, mm per unit, shape (n, p); of a machine that
        does not err. The array takes over what the library computed, nothing is copied."""

@final
class Problem:
    """The least squares that a fit came to rest at; m residuals, u unknowns.

    Unknowns are the p parameters, through the exact chain, and what each run has for itself (offsets of legs in s,
    rates, how the control drove), by their derivatives where the fit came to rest. Readings, weights and noise are those
    of the fit. Residuals are observed minus computed in standard deviations: of readings, then of what is known of times
    and what is plausible.
    """

    @property
    def names(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def values_at_rest(self) -> _Array:
        """Where the fit came to rest, shape (u,)."""

    @property
    def about(self) -> list[str]:
        """What each residual is about: ``"reading"``, ``"time"`` or ``"plausible"``."""

    @property
    def stretch(self) -> NDArray[np.int64]:
        """Of each reading the stretch of neighbours that its noise is correlated with, shape (readings,)."""

    @property
    def reading_sigma_um(self) -> _Array:
        """Standard deviation that each reading counted with, um, shape (readings,); infinite where it had no weight."""

    def residuals(self, values: _Array) -> _Array:
        """Residuals at values of the unknowns, shape (u,): shape (m,)."""

    def jacobian(self, values: _Array) -> _Array:
        """Their derivatives, shape (m, u); the array takes over what the library computed, nothing is copied."""

    def solve(self, values: _Array | None = None) -> _Array:
        """Gauss-Newton from values to where less than 1e-7 of a standard deviation is left to gain, shape (u,)."""

@final
class Linearised:
    """A fit as a linear problem: what a further column explains beside it; n readings, r directions."""

    @property
    def basis(self) -> _Array:
        """Orthonormal columns that the fit follows, shape (n, r); one copy."""

    @property
    def left_um(self) -> _Array:
        """What the fit leaves, times the root of the weight, um, shape (n,)."""

    @property
    def root_weight(self) -> _Array:
        """What a column is multiplied by at each reading, shape (n,)."""

    @property
    def arc(self) -> NDArray[np.int64]:
        """Number of the arc, counted over the runs, shape (n,)."""

    @property
    def run(self) -> NDArray[np.int64]:
        """Number of the run, shape (n,)."""

    def columns(self) -> dict[str, Any]:
        """Where each reading was taken, as :meth:`AlignedRun.columns`."""

@final
class Diagnosis:
    """What the model gets wrong."""

    @property
    def nothing_found(self) -> bool: ...
    @property
    def effects(self) -> list[str]:
        """The effects that were found, the largest first, as :func:`simulate` takes them."""

    @property
    def before_after_um(self) -> tuple[float, float]:
        """Residual of the model, and of the model with what was found, um rms."""

    @property
    def model(self) -> str:
        """The model with what was found, the text of model.toml."""

    @property
    def extended(self) -> Campaign:
        """The campaign identified anew with what was found; the same where nothing was."""

    def report(self) -> dict[str, Any]:
        """The diagnosis in analysis.json: docs/analysis-schema.md."""

    def analysis(self) -> dict[str, Any]:
        """What analysis.json of ``ballbar analyse`` holds: docs/analysis-schema.md."""

@final
class Volume:
    """How far the tool is from where it should be; n points, X the fastest."""

    @property
    def counts(self) -> list[int]:
        """Points along X, Y, Z."""

    @property
    def position_mm(self) -> _Array:
        """Machine coordinates, mm, shape (n, 3)."""

    @property
    def error_um(self) -> _Array:
        """Displacement of the tool against the workpiece, mean of both senses, um, shape (n, 3)."""

    @property
    def sigma_noise_um(self) -> _Array:
        """Standard deviations by the noise, um, shape (n, 3)."""

    @property
    def sigma_all_um(self) -> _Array:
        """And with what the runs leave open, um, shape (n, 3)."""

    @property
    def near(self) -> NDArray[np.bool_]:
        """Whether something was measured near, shape (n,)."""

    def report(self) -> dict[str, Any]:
        """What volume.json holds: docs/volume-schema.md."""

@final
class Compensation:
    """Files for a control that compensates, and what they leave."""

    @property
    def control(self) -> str:
        """The control."""

    @property
    def files(self) -> dict[str, str]:
        """Texts of the files by their names, as the control takes them."""

    @property
    def text(self) -> str:
        """The page that says how they are loaded, how the sign is checked at one point, and what they leave."""

    def report(self) -> dict[str, Any]:
        """What `ballbar compensate --json` tells: docs/compensation-schema.md."""

@final
class Trials:
    """Effects hidden at random in simulated campaigns, diagnosed without knowing: the trials of ``ballbar blind``.

    A trial is its seed, its class and its index: the same three give the same result, wherever it is computed, but for
    how long it took.

    Args:
        seed: where everything random begins.
        size_um: size of every hidden effect, um rms outside of the model, 0.001 to 100; that of its class where none.
        test: a test file whose programs are driven, instead of the campaign that is in the package.
        repeats: how often the plan of that test is repeated, 1 to 1000, instead of its runs.
    """

    def __new__(
        cls, seed: int = 1, *, size_um: float | None = None, test: _Path | None = None, repeats: int | None = None
    ) -> Trials: ...
    def trial(self, kind: str, index: int) -> dict[str, Any]:
        """Does one trial: what ``ballbar blind --json`` says of it.

        ``kind`` is ``"single"``, ``"small"``, ``"sizes"``, ``"none"``, ``"two"`` or ``"outside"``.
        """

def _panic() -> None:
    """A fault, for the test that says what becomes of one."""

def plan(test: Test, *, repeats: int = 1) -> Plan:
    """Rehearse a test on a perfect virtual machine."""

def programs(test: Test) -> list[Program]:
    """Write the programs of a test's plan, one for each mounting."""

def simulate(
    test: Test,
    *,
    scenario: _Path | Mapping[str, Any] | None = None,
    hide: Sequence[str] = ...,
    model: _Path | None = None,
    seed: int | None = None,
    repeats: int = 1,
    paper: bool = False,
) -> Simulation:
    """Let a virtual machine run the programs of a test and an instrument read it.

    Args:
        scenario: what machine and instrument are like: a file, or a mapping with its keys.
        hide: effects, such as ``"cyclic:on=EXX,period_mm=10,amplitude_um=1.2"``.
        model: a model.toml whose errors the machine has.
        seed: where everything random begins.
        repeats: how often the test is run.
        paper: take the coefficients of the paper instead of drawing a machine.
    """

def align(test: Test, runs: Sequence[Run] | None = None) -> list[AlignedRun]:
    """Lay logs over their programs: the runs of the test file, or those that are given."""

def identify(
    test: Test,
    runs: Sequence[Run] | None = None,
    *,
    terms: Sequence[str] | None = None,
    loss: str | None = None,
    minimum_norm: bool | None = None,
    on_failure: Literal["refuse", "leave_out"] = "refuse",
) -> Campaign:
    """Identify the machine from the runs of the test file, or from those that are given.

    ``terms``, ``loss`` and ``minimum_norm`` stand for the keys of ``[identify]``; ``on_failure`` says what becomes of a
    run that cannot be identified.
    """

def diagnose(campaign: Campaign) -> Diagnosis:
    """Look for what the model of a campaign gets wrong."""

def compensate(
    source: Campaign | Diagnosis | _Path,
    control: str,
    *,
    tool_mm: _Array | None = None,
    at_mm: _Array | None = None,
    step_mm: float | None = None,
    points: int | None = None,
    tables: int | None = None,
    unit_um: float | None = None,
    on_top: Sequence[tuple[str, str]] | None = None,
) -> Compensation:
    """Write what a control takes to compensate the machine; nothing is written to disk.

    Args:
        source: what was identified or diagnosed, or the path of an analysis.json or of its folder.
        control: "linuxcnc", "isg", "siemens", "fanuc", "klipper", "marlin", "reprapfirmware", "grblhal" or "csv".
        tool_mm: tip of the tool in the frame of the last slide on the tool side, mm, shape (3,).
        at_mm: machine coordinates of the other slides while one moves, mm, shape (3,).
        step_mm: distance of the points of a table, 0.1 to 1000.
        points: of a table at the most, 2 to 5000.
        tables: for other axes at the most, 0 to 62.
        unit_um: detection unit of the axes, 0.001 to 10.
        on_top: names and texts of the files that were active when the machine was measured.
    """

def volume(
    source: Campaign | Diagnosis | _Path,
    *,
    box_mm: _Array | None = None,
    travel: bool = False,
    tool_mm: _Array | None = None,
    points: int = 9,
    keep_rigid: bool = False,
) -> Volume:
    """Map the volumetric error over what was measured, the travel, or a box.

    Args:
        source: what was identified or diagnosed, or the path of an analysis.json or of its folder.
        box_mm: lowest and highest machine coordinate of X, Y, Z, mm, shape (3, 2).
        tool_mm: tip of the tool in the frame of the last slide on the tool side, mm, shape (3,).
        points: along each axis, 2 to 21.
        keep_rigid: leave the rigid motion of the workpiece in.
    """
