"""Blind trials on Dask: one Parquet file for each trial, and none that is there is computed again.

On this machine, two workers:

    python trials_on_dask.py results --trials 200 --class single

On a cluster whose scheduler and workers run (``dask scheduler``, ``dask worker``), with the package on each of them:

    python trials_on_dask.py results --trials 20000 --scheduler tcp://head:8786

A worker that dies loses the trial that it was at, and another does it; where this program dies, the next call goes on. All
together: ``pandas.read_parquet("results")``.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pyarrow
import pyarrow.parquet
from distributed import Client, LocalCluster, as_completed

import ballbar


@cache
def trials_of(seed: int, test: str | None, text: str | None, repeats: int | None) -> ballbar.Trials:
    """What a worker makes ready once."""
    if test is None:
        return ballbar.Trials(seed)
    if not Path(test).exists():
        raise ballbar.Error(
            "a worker does not have the test file", argument="test", file=test, hint="put it where all workers see it"
        )
    if Path(test).read_text(encoding="utf-8") != text:
        raise ballbar.Error(
            "a worker has another test file", argument="test", file=test, hint="put the same where all workers see it"
        )
    return ballbar.Trials(seed, test=test, repeats=repeats)


def trial(of: tuple[int, str | None, str | None, int | None], kind: str, index: int) -> dict[str, Any]:
    """One trial, on a worker."""
    return trials_of(*of).trial(kind, index)


def written(folder: Path, seed: int, kind: str, index: int) -> Path:
    return folder / f"seed={seed}" / f"class={kind}" / f"{index:06}.parquet"


def write(file: Path, result: dict[str, Any]) -> None:
    """The numbers as columns, all of it as JSON; the file is there whole or not at all."""
    row = {
        "index": result["index"],
        "size_um": result["size_um"],
        "verdict": result["verdict"],
        "hidden": [one["effect"] for one in result["hidden"]],
        "found": [one["text"] for one in result["found"]],
        "failure": result["failure"],
        "seconds": result["simulate_s"] + result["identify_s"] + result["diagnose_s"],
        "json": json.dumps(result, sort_keys=True),
    }
    strings = pyarrow.list_(pyarrow.string())
    types = {"hidden": strings, "found": strings, "failure": pyarrow.string()}
    columns = {name: pyarrow.array([value], types.get(name)) for name, value in row.items()}
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(f".{os.getpid()}.part")
    pyarrow.parquet.write_table(pyarrow.table(columns), part)
    part.replace(file)


def run(client: Client, arguments: argparse.Namespace) -> int:
    """Does what is not done yet; how many trials that was."""
    test = None if arguments.test is None else str(arguments.test.resolve())
    text = None if test is None else Path(test).read_text(encoding="utf-8")
    of = (arguments.seed, test, text, arguments.repeats)
    asked = [(kind, index) for kind in arguments.kinds for index in range(arguments.trials)]
    places = {one: written(arguments.folder, arguments.seed, *one) for one in asked}
    missing = [one for one in asked if not places[one].exists()]
    futures = {client.submit(trial, of, *one, pure=False, retries=2): one for one in missing}
    for future, result in as_completed(futures, with_results=True):
        write(places[futures[future]], result)
    return len(missing)


def parsed(given: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Blind trials on Dask")
    parser.add_argument("folder", type=Path, help="where the Parquet files go")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--trials", type=int, default=20, help="of each class")
    parser.add_argument("--class", dest="kinds", action="append", help="such as single; give it again for several")
    parser.add_argument("--test", type=Path, help="a test file that all workers see, instead of the built-in campaign")
    parser.add_argument("--repeats", type=int, help="how often the plan of the test is repeated")
    parser.add_argument("--scheduler", help="its address; without it, workers on this machine")
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args(given)
    arguments.kinds = arguments.kinds or ["single"]
    return arguments


def main(given: list[str]) -> None:
    arguments = parsed(given)
    if arguments.scheduler is None:
        # A trial takes one thread; processes, so that one that dies takes no other with it.
        cluster = LocalCluster(
            n_workers=arguments.workers, threads_per_worker=1, processes=True, dashboard_address=None
        )
        with cluster, Client(cluster) as client:
            done = run(client, arguments)
    else:
        with Client(arguments.scheduler) as client:
            done = run(client, arguments)
    print(f"{done} trials computed, in {arguments.folder}")


if __name__ == "__main__":
    main(sys.argv[1:])
