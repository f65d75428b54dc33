"""Ball-bar tests of machine tools on NumPy arrays.

A test is planned (:func:`plan`, :func:`programs`), run on a machine or on a virtual one (:func:`simulate`), its logs are
laid over their programs (:func:`align`) and the machine is identified (:func:`identify`); :func:`diagnose` says what the
model gets wrong, :func:`volume` how far the tool is off anywhere, and :func:`compensate` what a control takes against it.

Names end with their units. Deviations are length minus nominal length, positive outward; positions are machine
coordinates in the programmed sense; parameters have the units that ``units`` lists (mm and rad). Whatever fails raises
:class:`Error`. Long work runs without the interpreter's lock, so threads run side by side.
"""

from ._ballbar import (
    AlignedRun,
    Campaign,
    Compensation,
    Diagnosis,
    Identification,
    IdentifiedRun,
    Linearised,
    Machine,
    Plan,
    Problem,
    Program,
    Run,
    Simulation,
    Test,
    Trials,
    Volume,
    __version__,
    align,
    compensate,
    diagnose,
    identify,
    plan,
    programs,
    simulate,
    volume,
)
from ._error import Error

__all__ = [
    "AlignedRun",
    "Campaign",
    "Compensation",
    "Diagnosis",
    "Error",
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
    "align",
    "compensate",
    "diagnose",
    "identify",
    "plan",
    "programs",
    "simulate",
    "volume",
]
