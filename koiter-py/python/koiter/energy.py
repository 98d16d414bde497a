"""The energies of a mesh under any bending model."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _koiter
from .scene import Arrays, arrays


def energy(
    mesh: Arrays,
    *,
    thickness: float,
    young: float,
    poisson: float,
    bending: str = "bac",
    rest: Any = None,
    rest_curvature: bool = False,
    directors: str = "minimise",
) -> _koiter.Shape:
    """Membrane and bending energy [J] of a deformed mesh, and their gradients [N].

    ``thickness`` [m], ``young`` [Pa]; ``rest`` has the rest positions of shape (n, 3) [m], else the mesh is unstretched; with
    ``rest_curvature`` the shell wants the curvature of its rest shape, else to be flat. ``directors`` are those of least bending
    energy ("minimise"), or the means of the faces' normals ("zero").

    Returns an object with ``membrane``, ``bending``, ``membrane_gradient``, ``bending_gradient`` of shape (n, 3),
    ``director_gradient`` and ``directors``. Raises :class:`koiter.SceneError` for a mesh or a number that is wrong.
    """
    vertices, faces = arrays(mesh)
    return _koiter.Shape(
        vertices,
        faces,
        thickness=thickness,
        young=young,
        poisson=poisson,
        bending=bending,
        rest=None if rest is None else np.ascontiguousarray(rest, dtype=np.float64),
        rest_curvature=rest_curvature,
        directors=directors,
    )
