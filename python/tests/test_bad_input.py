"""What cannot be used is an exception that names the argument and what was expected."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ballbar
import numpy as np
import pytest

PROGRAM = "%\nO1\nG90 G54 G00 X0. Y0. Z0.\nM30\n%\n"
TIMES = np.arange(5.0)
READINGS = np.zeros(5)


def anything(value: object) -> Any:
    """What types would not let through."""
    return value


def refused(call: Callable[[], object]) -> ballbar.Error:
    with pytest.raises(ballbar.Error) as raised:
        call()
    assert raised.value.what and raised.value.hint
    return raised.value


@pytest.mark.parametrize(
    ("time_s", "deviation_um", "argument", "told"),
    [
        ([0.0, 1.0], READINGS, "time_s", "a list where a float64 array of shape (n,)"),
        (None, READINGS, "time_s", "a NoneType where"),
        (np.arange(5), READINGS, "time_s", "an array of int64 where"),
        (TIMES.astype(np.float32), READINGS, "time_s", "an array of float32 where"),
        (TIMES.astype(">f8"), READINGS, "time_s", "an array of >f8 where"),
        (TIMES.astype(object), READINGS, "time_s", "an array of object where"),
        (TIMES.astype(complex), READINGS, "time_s", "an array of complex128 where"),
        (np.array(["a"] * 5), READINGS, "time_s", "an array of <U1 where"),
        (TIMES.reshape(5, 1), READINGS, "time_s", "an array of shape (5, 1) where"),
        (np.float64(3.0), READINGS, "time_s", "a float64 where"),
        (np.array(3.0), READINGS, "time_s", "an array of shape () where"),
        (np.zeros(0), READINGS, "time_s", "an empty array where"),
        (np.arange(10.0)[::2], READINGS, "time_s", "a strided or Fortran-ordered array"),
        (TIMES[::-1], READINGS, "time_s", "a strided or Fortran-ordered array"),
        (np.ma.masked_array(TIMES), READINGS, "time_s", "a masked array where a float64 array of shape (n,)"),
        (TIMES, np.ma.masked_array(READINGS, mask=[False, True, False, False, False]), "deviation_um", "its mask would be lost"),
        (TIMES, np.ma.masked_invalid(np.full(5, np.nan)), "deviation_um", "leave masked rows out"),
        (np.array([0.0, 1.0, np.nan, 3.0, 4.0]), READINGS, "time_s", "time 3 is NaN"),
        (np.array([0.0, 1.0, np.inf, 3.0, 4.0]), READINGS, "time_s", "time 3 is inf"),
        (np.array([0.0, 1.0, 1.0, 3.0, 4.0]), READINGS, "time_s", "time 3 is 1 s and does not come after"),
        (TIMES, np.zeros(4), "deviation_um", "5 times and 4 deviations"),
        (TIMES, np.full(5, np.nan), "deviation_um", "no deviation is a number"),
        (TIMES, np.full(5, 1e5), "deviation_um", "deviation 1 is 100000 um"),
        (TIMES, np.full(5, -np.inf), "deviation_um", "deviation 1 is -inf um"),
    ],
)
def test_arrays_that_are_no_log(time_s: Any, deviation_um: Any, argument: str, told: str) -> None:
    error = refused(lambda: ballbar.Run(PROGRAM, time_s, deviation_um))
    assert error.argument == argument and error.kind == "input"
    assert told in str(error)


def test_a_read_only_array_is_only_read() -> None:
    time_s, deviation_um = TIMES.copy(), READINGS.copy()
    time_s.setflags(write=False)
    deviation_um.setflags(write=False)
    run = ballbar.Run(PROGRAM, time_s, deviation_um)
    assert np.array_equal(run.time_s, time_s)
    # And what the package gives belongs to who asked.
    run.time_s[0] = 7.0
    assert run.time_s[0] == 0.0


def test_what_arrays_may_hold_and_mappings_may_not(plane: ballbar.Test) -> None:
    machine = {"name": "m", "topology": "wXYFZSt", "axes": {axis: {} for axis in "XYZ"}}
    error = refused(lambda: ballbar.Machine.of(machine))
    assert error.file == "machine.toml" and error.line is not None
    assert refused(lambda: ballbar.Machine.of({"name": object()})).argument == "keys[\"name\"]"
    assert refused(lambda: ballbar.Machine.of({"name": 2**70})).argument == "keys[\"name\"]"
    assert refused(lambda: ballbar.Machine.of(anything({3: "x"}))).argument == "keys"
    assert refused(lambda: ballbar.Machine.of(anything(3))).argument == "keys"
    endless: dict[str, Any] = {}
    endless["self"] = endless
    assert "too deep" in str(refused(lambda: ballbar.Machine.of(endless)))
    assert refused(lambda: ballbar.Test.of(anything([]), plane.machine)).argument == "keys"


def test_files_that_cannot_be_used(tmp_path: Path, root: Path) -> None:
    error = refused(lambda: ballbar.Test.read(tmp_path / "nowhere.toml"))
    assert error.file == str(tmp_path / "nowhere.toml")
    # A worker that has the test and not the machine.
    alone = tmp_path / "test.toml"
    alone.write_text((root / "tests/data/planar/test.toml").read_text())
    error = refused(lambda: ballbar.Test.read(alone))
    assert error.file is not None and "machines" in error.file
    # From another version: a key that nobody knows.
    text = (root / "machines/vertical.toml").read_text()
    error = refused(lambda: ballbar.Machine.parse("wobble_mm = 1.0\n" + text, file="new.toml"))
    assert (error.file, error.line, error.column) == ("new.toml", 1, 1)
    assert "wobble_mm" in error.what
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\x00\xff\x00")
    assert refused(lambda: ballbar.Machine.read(binary)).file == str(binary)


def test_arguments_beyond_their_bounds(plane: ballbar.Test, campaign: ballbar.Campaign) -> None:
    runs = ballbar.simulate(plane, seed=1).runs
    calls: list[tuple[str, Callable[[], object]]] = [
        ("runs", lambda: ballbar.identify(plane, [])),
        ("runs", lambda: ballbar.identify(plane, [ballbar.Run(PROGRAM, TIMES, READINGS, mounting="B")])),
        ("on_failure", lambda: ballbar.identify(plane, runs, on_failure=anything("ignore"))),
        ("loss", lambda: ballbar.identify(plane, runs, loss="l1")),
        ("repeats", lambda: ballbar.plan(plane, repeats=0)),
        ("repeats", lambda: ballbar.simulate(plane, repeats=0)),
        ("feed_override_percent", lambda: ballbar.Run(PROGRAM, TIMES, READINGS, feed_override_percent=np.nan)),
        ("points", lambda: ballbar.volume(campaign, points=1)),
        ("box_mm", lambda: ballbar.volume(campaign, box_mm=np.zeros((2, 3)))),
        ("box_mm", lambda: ballbar.volume(campaign, box_mm=np.asfortranarray(np.ones((3, 2))))),
        ("box_mm", lambda: ballbar.volume(campaign, box_mm=np.full((3, 2), np.nan))),
        ("box_mm", lambda: ballbar.volume(campaign, box_mm=np.full((3, 2), 1e6))),
        ("tool_mm", lambda: ballbar.volume(campaign, tool_mm=np.zeros(2))),
        ("source", lambda: ballbar.volume(anything(3))),
        ("source", lambda: ballbar.compensate(anything(3), "csv")),
        ("control", lambda: ballbar.compensate(campaign, "abacus")),
        ("points", lambda: ballbar.compensate(campaign, "fanuc", points=1)),
        ("tables", lambda: ballbar.compensate(campaign, "siemens", tables=63)),
        ("step_mm", lambda: ballbar.compensate(campaign, "csv", step_mm=0.0)),
        ("unit_um", lambda: ballbar.compensate(campaign, "fanuc", unit_um=np.inf)),
        ("at_mm", lambda: ballbar.compensate(campaign, "csv", at_mm=np.full(3, 1e6))),
        ("at_mm", lambda: ballbar.compensate(campaign, "csv", at_mm=np.full(3, np.nan))),
        ("tool_mm", lambda: ballbar.compensate(campaign, "csv", tool_mm=np.zeros((3, 1)))),
        ("values", lambda: campaign[0].problem().residuals(np.zeros(3))),
        ("values", lambda: campaign[0].problem().jacobian(np.full_like(campaign[0].problem().values_at_rest, np.nan))),
    ]
    for argument, call in calls:
        assert refused(call).argument == argument


def test_runs_that_cannot_be_identified(plane: ballbar.Test) -> None:
    (run,) = ballbar.simulate(plane, seed=1).runs
    time_s, deviation_um = run.time_s, run.deviation_um
    # A program that is none, one that never engages the bar, a log of something else.
    assert refused(lambda: ballbar.align(plane, [ballbar.Run("G01 Q(", time_s, deviation_um)])).line == 1
    refused(lambda: ballbar.align(plane, [ballbar.Run(PROGRAM, time_s, deviation_um)]))
    noise = 300.0 * np.sin(0.37 * np.arange(time_s.size) ** 1.1)
    error = refused(lambda: ballbar.identify(plane, [ballbar.Run(run.program, time_s, noise)]))
    assert error.kind in {"mismatch", "undetermined"}
    error = refused(lambda: ballbar.identify(plane, [run], terms=["EXX1", "EXX1@Q"]))
    assert error.kind == "input"
    error = refused(lambda: ballbar.identify(plane, [run], terms=["EXX1", "EXw", "EXt"]))
    assert error.kind == "undetermined" and "EX" in error.what
    refused(lambda: ballbar.identify(plane))
    refused(lambda: ballbar.simulate(plane, hide=["gremlins:amplitude_um=1"]))
    refused(lambda: ballbar.simulate(plane, scenario={"gremlins": 1}))
    assert len(refused(lambda: ballbar.simulate(plane, scenario="nowhere.toml")).what) > 0


def test_a_fault_inside_is_the_same_exception(capfd: pytest.CaptureFixture[str]) -> None:
    error = refused(ballbar._ballbar._panic)
    assert error.kind == "internal" and "asked for" in error.what
    capfd.readouterr()


def test_an_error_comes_home_from_a_worker() -> None:
    error = refused(lambda: ballbar.Machine.parse("name = 1"))
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is ballbar.Error
    assert (str(again), again.line, again.hint) == (str(error), error.line, error.hint)
