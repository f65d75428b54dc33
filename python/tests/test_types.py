"""What the types and docstrings say is what there is."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import ballbar
import ballbar._ballbar
import pytest

STUB = Path(ballbar.__file__).with_name("_ballbar.pyi")


def documented() -> Iterator[tuple[str, str, str]]:
    """Name, docstring of the stub and docstring of what is there."""
    for node in ast.parse(STUB.read_text()).body:
        if not isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            continue
        there = getattr(ballbar._ballbar, node.name)
        yield node.name, ast.get_docstring(node) or "", inspect.getdoc(there) or ""
        for inner in node.body if isinstance(node, ast.ClassDef) else []:
            if isinstance(inner, ast.FunctionDef) and ast.get_docstring(inner):
                member = getattr(there, inner.name)
                yield f"{node.name}.{inner.name}", ast.get_docstring(inner) or "", inspect.getdoc(member) or ""


def test_docstrings_are_those_of_the_stub() -> None:
    wrong = [name for name, stub, there in documented() if stub != there or not there]
    assert not wrong


@pytest.mark.parametrize(
    "command",
    [
        ["mypy.stubtest", "ballbar"],
        ["mypy", "--strict", "--disable-error-code=import-untyped", "--allow-untyped-calls", str(Path(__file__).parent)],
    ],
    ids=["stubtest", "mypy"],
)
def test_types(command: list[str], tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *command], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
