"""Scenes that run."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _koiter
from .picture import Picture, of_parts

if TYPE_CHECKING:
    import scipy.sparse


class Simulation(_koiter.Simulation):
    """A running scene; ``koiter.Scene.start`` and :meth:`from_file` make one."""

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Simulation:
        """The scene of a file, with ``overrides`` as ``--set`` has them."""
        path = Path(path)
        return cls(path.read_text(encoding="utf-8"), name=str(path), overrides=list(overrides), folder=path.parent)

    def run(
        self,
        until: float | None = None,
        callback: Callable[[Simulation], Any] | None = None,
        out: str | os.PathLike[str] | None = None,
    ) -> Iterator[_koiter.Step]:
        """Steps to the scene's end, or up to a time [s], one a turn of the loop.

        ``callback`` is called after each step with the simulation, which it may read and change; if it returns ``False`` the run
        ends there. ``out`` is a folder for the result, as ``koiter run`` writes it: :class:`koiter.Result` reads it, also while the
        run goes on. It begins with the present state; what an earlier result there held is replaced.
        """
        if out is None:
            yield from self._steps(until, callback)
            return
        # Where `until` says the end, how many steps it takes is known when they are taken.
        self.begin_recording(Path(out), self.num_steps)
        ended = False
        try:
            for step in self._steps(until, None):
                ended = not self._goes_on(until)
                self.record(step, ended)
                yield step
                if callback is not None and callback(self) is False:
                    return
        finally:
            self.end_recording(not ended)

    def _steps(
        self, until: float | None, callback: Callable[[Simulation], Any] | None
    ) -> Iterator[_koiter.Step]:
        while self._goes_on(until):
            yield self.step()
            if callback is not None and callback(self) is False:
                return

    def _goes_on(self, until: float | None) -> bool:
        if self.has_ended:
            return False
        # Times are sums of steps: a share of a step decides no step more.
        return self.step_count < self.num_steps if until is None else self.time < until * (1 - 1e-9)

    def hessian(self) -> scipy.sparse.csc_array:
        """Hessian of the elastic energies by all unknowns, in the order of :meth:`gradient`; needs SciPy."""
        from scipy import sparse

        values, rows, starts = self.hessian_lower()
        size = len(starts) - 1
        lower = sparse.csc_array((values, rows.astype(np.int32), starts.astype(np.int32)), shape=(size, size))
        return (lower + sparse.tril(lower, -1).T).tocsc()

    def show(
        self, camera: str = "iso", size: tuple[int, int] = (800, 500), color: str | None = None
    ) -> Picture:
        """A picture of the present state, which a notebook shows; ``color`` is a face field, such as ``"strain"``."""
        parts = []
        for name, is_obstacle, vertices, faces in self.parts():
            values = None if color is None or is_obstacle else self._field(name, color)
            parts.append((is_obstacle, vertices, faces, values))
        return of_parts(parts, camera=camera, size=size, caption=f"t = {self.time:.3g} s", field=color)

    def _field(self, shell: str, name: str) -> np.ndarray:
        fields = self.face_fields(shell)
        if name not in fields:
            raise _koiter.SceneError(f"there is no field '{name}'; there are: {', '.join(fields)}")
        return fields[name]
