"""Result folders of runs."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import _koiter
from .picture import Picture, of_parts


@dataclass(frozen=True)
class Part:
    """A shell or an obstacle of a result: where its vertices and faces are among those of all parts."""

    name: str
    is_obstacle: bool
    vertices: slice
    faces: slice


class Result(_koiter.Result):
    """A result folder: ``len(result)`` frames, ``result[-1].positions``, ``result.times``, ``result.stats``, ``result.probes``."""

    @property
    def parts(self) -> dict[str, Part]:
        """Shells and obstacles by name."""
        return {
            name: Part(name, is_obstacle, slice(*vertices), slice(*faces))
            for name, is_obstacle, vertices, faces in self.part_ranges()
        }

    @property
    def stats(self) -> list[dict[str, Any]]:
        """The figures of every step: iterations, energies [J], seconds by part, contacts."""
        return [json.loads(line) for line in self.stats_lines()]

    @property
    def summary(self) -> dict[str, Any] | None:
        """The figures of the whole run; ``None`` while it goes on."""
        text = self.summary_text()
        return None if text is None else json.loads(text)

    @property
    def probes(self) -> dict[str, np.ndarray]:
        """The probes by column, with ``time``; empty if the scene has none."""
        path = Path(self.path) / "probes.csv"
        if not path.exists():
            return {}
        with path.open(newline="", encoding="utf-8") as file:
            heading, *rows = csv.reader(file)
        # A run that goes on may be in the middle of its last row.
        whole = [row for row in rows if len(row) == len(heading)]
        columns = np.array(whole, dtype=float).reshape(len(whole), len(heading)).T
        return dict(zip(heading, columns, strict=True))

    def show(
        self, frame: int = -1, camera: str = "iso", size: tuple[int, int] = (800, 500), color: str | None = None
    ) -> Picture:
        """A picture of a frame, which a notebook shows; ``color`` is a face field that the run wrote."""
        shown = self[frame]
        if color is not None and color not in shown.face_fields:
            names = ", ".join(shown.face_fields)
            raise _koiter.SceneError(f"the result has no field '{color}'; it has: {names}")
        faces, parts = self.faces, []
        for part in self.parts.values():
            values = None if color is None or part.is_obstacle else shown.face_fields[color][part.faces]
            own = faces[part.faces] - part.vertices.start
            parts.append((part.is_obstacle, shown.positions[part.vertices], own, values))
        return of_parts(parts, camera=camera, size=size, caption=f"t = {shown.time:.3g} s", field=color)
