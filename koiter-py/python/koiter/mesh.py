"""Meshes as arrays: vertices of shape (n, 3) [m] and faces of shape (m, 3)."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import _koiter, toml


def read(path: str | os.PathLike[str]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of an OBJ, PLY, OFF or STL file."""
    return _koiter.read_mesh(path)


def generate(**shape: Any) -> tuple[np.ndarray, np.ndarray]:
    """A mesh as a scene file makes it: ``generate(disc={"radius": 0.1, "rings": 8})``; ``translate``, ``rotate``, ``scale`` too."""
    shell = {"name": "mesh", "mesh": shape, "material": "cotton"}
    return _koiter.generate_mesh(toml.document({"time": {"end": 1.0, "dt": 1.0}}, {"shell": [shell]}))
