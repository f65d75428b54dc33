"""The page of examples: its code runs, and says what the page says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_page(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = root / "docs" / "python.md"
    text = page.read_text()
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for block in BLOCK.finditer(text):
        # Lines of errors are those of the page.
        before = text[: block.start(1)].count("\n")
        exec(compile("\n" * before + block[1], page, "exec"), names)  # noqa: S102
    # Strategies: the sphere leaves less open.
    assert names["table"]["3d6"][3] < names["table"]["xy"][3]
    assert names["table"]["xy"][0] < names["table"]["3d6"][0]
    # The own effect: found within its uncertainty, and far beyond it.
    error = names["found_um"] - names["HIDDEN_UM"]
    assert abs(error) < 4.0 * names["sigma_um"]
    assert names["HIDDEN_UM"] > 10.0 * names["sigma_um"]
    (found,) = names["diagnosis"].effects
    assert found.startswith("cyclic:on=EXX,")
    assert (tmp_path / "residual.png").read_bytes().startswith(b"\x89PNG")
    from scipy.io import loadmat

    loaded = loadmat(tmp_path / "campaign.mat")
    assert loaded["covariance"].shape == (len(names["fit"].names),) * 2
    assert loaded["position_mm"].shape[1] == 3
