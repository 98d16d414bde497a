"""Families of runs: all combinations of some values, on the cores of this machine or on a cluster."""

from __future__ import annotations

import csv
import itertools
import json
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from . import _koiter, toml
from .result import Result
from .scene import Scene
from .simulation import Simulation

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor

Row = dict[str, Any]


class Future(Protocol):
    """What an executor gives for a task."""

    def result(self) -> Any:
        """What the task returned; raises what it raised."""


class Executor(Protocol):
    """Who runs tasks: ``concurrent.futures`` executors, a Dask ``Client``, or anything with this method."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Future:
        """Begins a task."""


def sweep(
    scene: Scene | str | os.PathLike[str],
    vary: Mapping[str, Iterable[Any]],
    out: str | os.PathLike[str],
    *,
    executor: Executor | None = None,
    overrides: Sequence[str] = (),
    until: float | None = None,
    retries: int = 2,
) -> list[Row]:
    """Runs a scene, or the scene of a file, with every combination of the values of some keys, and returns a row a run.

    ``vary`` has values by dotted key: ``{"shell.cloth.bending": ["bac", "dcs"], "shell.cloth.thickness": [1e-3, 2e-3]}``. Every run
    writes a result folder into ``out``, beside ``table.csv``, whose rows are those returned: the values, ``folder``, ``error`` (empty
    where all went well), and figures of the summary with the last values of the probes.

    ``executor`` has ``submit(function, *arguments)`` whose futures have ``result()``: a ``concurrent.futures`` executor, a Dask
    ``Client`` (its workers must see ``out``), or a few lines around Ray. Without one, processes of this machine run one a core, each on
    one thread. A run whose process dies is begun again, ``retries`` times; one that fails stays in the table with its error. The same
    call again makes only the runs that are not finished.
    """
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    keys = list(vary)
    tasks = []
    for number, values in enumerate(itertools.product(*vary.values())):
        given = [*overrides, *(f"{key}={toml.value(value)}" for key, value in zip(keys, values, strict=True))]
        words = "_".join(re.sub(r"[^\w.+-]+", "-", str(value))[:24] for value in values)
        tasks.append((scene, given, str(folder / f"{number:03}_{words}"), until))
    if not tasks:
        raise _koiter.SceneError("there is nothing to run: a key has no values")
    figures = _on(executor, tasks, retries)
    rows = []
    for values, task, found in zip(itertools.product(*vary.values()), tasks, figures, strict=True):
        rows.append({**dict(zip(keys, values, strict=True)), "folder": Path(task[2]).name, **found})
    _write(folder / "table.csv", rows)
    return rows


def _on(executor: Executor | None, tasks: Sequence[tuple[Any, ...]], retries: int) -> list[Row]:
    """What the tasks return, in their order; those whose process died are begun again."""
    found: list[Row | None] = [None] * len(tasks)
    died = ""
    for _ in range(1 + retries):
        left = [index for index, row in enumerate(found) if row is None]
        if not left:
            break
        own = _processes() if executor is None else None
        futures = [(index, (own or executor).submit(run_one, *tasks[index])) for index in left]  # type: ignore[union-attr]
        for index, future in futures:
            try:
                found[index] = future.result()
            # Every executor has exceptions of its own for workers that are gone; those of runs are in their rows.
            except Exception as error:
                died = f"{type(error).__name__}: {error}"
        if own is not None:
            own.shutdown()
    return [row if row is not None else {"error": f"its process died: {died}"} for row in found]


def _processes() -> ProcessPoolExecutor:
    # Here: importing koiter should not take the time that these do.
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    # Forked, a process would have locks of threads that it has not.
    return ProcessPoolExecutor(mp_context=multiprocessing.get_context("spawn"), initializer=_on_one_thread)


def _on_one_thread() -> None:
    os.environ["RAYON_NUM_THREADS"] = "1"


def run_one(scene: Scene | str | os.PathLike[str], overrides: list[str], out: str, until: float | None) -> Row:
    """One run of a family, in whichever process: its figures, or its error."""
    try:
        simulation = scene.start(overrides) if isinstance(scene, Scene) else Simulation.from_file(scene, overrides)
        if not _is_finished(Path(out), simulation.scene_text, until):
            for _ in simulation.run(until, out=out):
                pass
            (Path(out) / "until.json").write_text(json.dumps(until), encoding="utf-8")
    except (_koiter.SceneError, _koiter.RunError) as error:
        return {"error": str(error)}
    return {"error": "", **_figures(Result(out).summary or {})}


def _is_finished(out: Path, scene_text: str, until: float | None) -> bool:
    """Whether an earlier call made this very run to its end."""
    mark = out / "until.json"
    if not mark.exists() or json.loads(mark.read_text(encoding="utf-8")) != until:
        return False
    result = Result(out)
    return result.scene_text == scene_text and result.summary is not None and not result.summary["interrupted"]


def _figures(summary: Mapping[str, Any]) -> Row:
    kept = ("converged", "steps", "newton_iterations", "seconds", "min_gap", "intersections", "faces")
    row = {key: summary.get(key) for key in kept}
    for name, value in (summary.get("probes") or {}).items():
        values = value if isinstance(value, list) else [value]
        names = [name] if len(values) == 1 else [f"{name}.{axis}" for axis in "xyz"[: len(values)]]
        row.update(zip(names, values, strict=True))
    return row


def _write(path: Path, rows: Sequence[Row]) -> None:
    columns = list(dict.fromkeys(column for row in rows for column in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
