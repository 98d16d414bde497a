"""Scenes made in Python, of the words of a scene file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import toml
from .result import Result
from .simulation import Simulation

Arrays = tuple[Any, Any]
"""Vertices of shape (n, 3) [m] and faces of shape (m, 3)."""

_LISTS = (
    "phase", "shell", "double_layer", "obstacle", "constraint", "symmetry", "load", "heat_source", "process", "energy", "probe",
)  # fmt: skip


def arrays(mesh: Arrays) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces as the compiled half takes them."""
    vertices, faces = mesh
    return np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(faces, dtype=np.int64)


class Scene:
    """A scene: top-level keys of a scene file as keyword arguments, such as ``time``, ``gravity``, ``integrator``, ``contact``.

    ``folder`` is where mesh files are looked for. What a scene file can say, this can: every keyword argument has the name it
    has there, tables are dicts. Mistakes raise :class:`koiter.SceneError` when the scene starts.
    """

    def __init__(self, *, folder: str | os.PathLike[str] = ".", **keys: Any) -> None:
        self._keys: dict[str, Any] = dict(keys)
        self._lists: dict[str, list[dict[str, Any]]] = {name: [] for name in _LISTS}
        self._meshes: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self._folder = Path(folder)

    def __setitem__(self, key: str, item: Any) -> None:
        """Sets a top-level key: ``scene["gravity"] = [0, 0, -1.62]``."""
        self._keys[key] = item

    def __getitem__(self, key: str) -> Any:
        return self._keys[key]

    def add(self, kind: str, name: str | None = None, **keys: Any) -> None:
        """Adds a table to a list of the scene: ``scene.add("load", "wind", shell="flag", pressure=3.0)`` is a ``[[load]]``."""
        if kind not in self._lists:
            raise ValueError(f"there is no list '{kind}' in a scene; there are: {', '.join(self._lists)}")
        self._lists[kind].append({} if name is None else {"name": name})
        self._lists[kind][-1].update(keys)

    def add_shell(
        self,
        name: str,
        mesh: Mapping[str, Any] | Arrays,
        material: str | Mapping[str, Any],
        *,
        rest_mesh: Mapping[str, Any] | Arrays | None = None,
        **keys: Any,
    ) -> None:
        """Adds a ``[[shell]]``. ``mesh`` is (vertices, faces), or what a scene file has: ``{"disc": {...}}``, ``{"file": "a.obj"}``."""
        if rest_mesh is not None:
            keys["rest_mesh"] = self._mesh(f"<rest of {name}>", rest_mesh)
        self.add("shell", name, mesh=self._mesh(f"<{name}>", mesh), material=material, **keys)

    def add_obstacle(self, name: str, *, mesh: Mapping[str, Any] | Arrays | None = None, **keys: Any) -> None:
        """Adds an ``[[obstacle]]``: ``sphere={"radius": 0.1}``, ``plane=...``, ``box=...``, or a mesh."""
        if mesh is not None:
            keys["mesh"] = self._mesh(f"<{name}>", mesh)
        self.add("obstacle", name, **keys)

    def add_constraint(self, name: str, *, shell: str, **keys: Any) -> None:
        """Adds a ``[[constraint]]``; vertices by ``select={"vertices": [...]}``, a box, a boundary."""
        self.add("constraint", name, shell=shell, **keys)

    def add_load(self, name: str, **keys: Any) -> None:
        """Adds a ``[[load]]``."""
        self.add("load", name, **keys)

    def add_probe(self, name: str, quantity: str, **keys: Any) -> None:
        """Adds a ``[[probe]]``; ``simulation.probes`` has its values."""
        self.add("probe", name, quantity=quantity, **keys)

    def add_energy(self, name: str, *, shell: str, on: str, **keys: Any) -> None:
        """Adds an ``[[energy]]``: a text of the quantities of what it is ``on``, a vertex, edge, hinge, face or the whole shell.

        The text is a ``density`` by rest area, an ``energy`` of each, a ``dissipation`` or a ``dissipation_density``, its numbers are
        ``parameters``: ``scene.add_energy("air", shell="ball", on="shell", energy="-p * volume", parameters={"p": 100.0})``.
        Derivatives follow by themselves.
        """
        self.add("energy", name, shell=shell, on=on, **keys)

    def _mesh(self, name: str, mesh: Mapping[str, Any] | Arrays) -> dict[str, Any]:
        if isinstance(mesh, Mapping):
            return dict(mesh)
        self._meshes[name] = arrays(mesh)
        return {"file": name}

    def text(self) -> str:
        """The scene as a scene file; meshes that are arrays appear as files of the names in angle brackets."""
        return toml.document(self._keys, self._lists)

    def start(self, overrides: Sequence[str] = ()) -> Simulation:
        """Checks the scene and sets it up; ``overrides`` as ``--set`` has them: ``["shell.cloth.bending=dcs"]``."""
        return Simulation(
            self.text(), name="<scene>", overrides=list(overrides), meshes=self._meshes, folder=self._folder
        )

    def run(
        self,
        out: str | os.PathLike[str],
        *,
        until: float | None = None,
        overrides: Sequence[str] = (),
        callback: Callable[[Simulation], Any] | None = None,
    ) -> Result:
        """Runs the scene to its end, or up to a time [s], into a result folder as ``koiter run`` writes it, and opens that.

        ``callback`` and ``overrides`` as in :meth:`start` and :meth:`koiter.Simulation.run`. Steps that did not converge make no
        exception: ``result.summary["converged"]`` tells.
        """
        for _ in self.start(overrides).run(until, callback, out):
            pass
        return Result(out)
