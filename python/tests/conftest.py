"""What the tests share."""

from __future__ import annotations

import os
from pathlib import Path

# Matrices are small here: threads of the linear algebra wait for each other ten times as long as one of them computes.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import ballbar
import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def plane() -> ballbar.Test:
    """A circle in XY, the fastest test there is."""
    return a_test()


@pytest.fixture(scope="session")
def campaign(plane: ballbar.Test) -> ballbar.Campaign:
    return ballbar.identify(plane, ballbar.simulate(plane, seed=7, repeats=2).runs)


def a_test(
    machine: str = "vertical",
    strategy: str = "xy",
    *,
    coincidence_mm: tuple[float, float, float] = (11.0, 0.0, -198.0),
    bar_mm: float = 150.0,
    feed_mm_min: float = 1500.0,
    rate_hz: float = 30.0,
    **identify: object,
) -> ballbar.Test:
    """A test of a dictionary."""
    return ballbar.Test.of(
        {
            "name": f"{machine} {strategy}",
            "ball_bar": {"length_mm": bar_mm},
            "log": {"sample_rate_hz": rate_hz},
            "mounting": [
                {"name": "A", "coincidence_mm": coincidence_mm, "tool_ball_mm": (0.0, 0.0, -120.0)}
            ],
            "plan": {"strategy": strategy, "feed_mm_min": feed_mm_min, "dwell_s": 2.0},
            "identify": dict(identify),
        },
        ballbar.Machine.builtin(machine),
    )
