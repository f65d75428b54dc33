"""Trials on a local cluster: bitwise those of one process, a killed worker loses nothing, none is done twice."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import sys
import threading
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import ballbar
import pyarrow.parquet
import pytest
from distributed import Client, LocalCluster

MACHINE = ballbar.Machine.builtin("vertical").text
TEST = """
name = "a plane"
machine = "machine.toml"
[ball_bar]
length_mm = 150.0
[[mounting]]
name = "A"
coincidence_mm = [11.0, 0.0, -198.0]
tool_ball_mm = [0.0, 0.0, -120.0]
[plan]
strategy = "xy"
feed_mm_min = 1000.0
dwell_s = 2.0
"""
TIMES = {"simulate_s", "identify_s", "diagnose_s"}


@pytest.fixture(scope="module")
def example(root: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("trials_on_dask", root / "python/examples/trials_on_dask.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # As a module that has a name, so that workers find its functions by it.
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def test_file(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    file = tmp_path / "test.toml"
    file.write_text(TEST)
    return file


def read(folder: Path) -> dict[tuple[str, int], dict[str, Any]]:
    found = {}
    for file in folder.rglob("*.parquet"):
        (text,) = pyarrow.parquet.read_table(file, columns=["json"], partitioning=None)["json"].to_pylist()
        result = json.loads(text)
        found[result["class"], result["index"]] = {k: v for k, v in result.items() if k not in TIMES}
    return found


def test_trials(example: ModuleType, test_file: Path, tmp_path: Path) -> None:
    folder = tmp_path / "results"
    given = [str(folder), "--test", str(test_file), "--repeats", "2"]
    count = 4
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            # The example goes to the workers as a user's script does: by its text.
            client.upload_file(example.__file__)
            killed = threading.Thread(target=kill_one_of, args=(client, folder), daemon=True)
            killed.start()
            arguments = example.parsed([*given, "--trials", str(count)])
            assert example.run(client, arguments) == count
            killed.join(60.0)
            assert not killed.is_alive()
            # Again with more: what is there stays as it is.
            before = {file: file.stat().st_mtime_ns for file in folder.rglob("*.parquet")}
            assert len(before) == count
            assert example.run(client, example.parsed([*given, "--trials", str(count + 1)])) == 1
            assert all(file.stat().st_mtime_ns == at for file, at in before.items())
    here = ballbar.Trials(1, test=test_file, repeats=2)
    results = read(folder)
    assert len(results) == count + 1
    for (kind, index), result in results.items():
        expected = {k: v for k, v in here.trial(kind, index).items() if k not in TIMES}
        assert json.dumps(result, sort_keys=True) == json.dumps(expected, sort_keys=True)


def kill_one_of(client: Client, folder: Path) -> None:
    """Kills a worker once the first trial is written."""
    while not any(folder.rglob("*.parquet")):
        time.sleep(0.02)
    processes = client.run(os.getpid)
    os.kill(next(iter(processes.values())), signal.SIGKILL)


def test_a_worker_without_the_file_says_so(example: ModuleType, tmp_path: Path) -> None:
    with pytest.raises(ballbar.Error) as raised:
        example.trials_of(1, str(tmp_path / "gone.toml"), "", None)
    assert raised.value.argument == "test" and "worker" in raised.value.what
