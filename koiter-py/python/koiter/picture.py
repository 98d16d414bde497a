"""Pictures that notebooks show and files keep."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import _koiter


class Picture:
    """A PNG picture: a notebook shows it, :meth:`save` writes it."""

    def __init__(self, png: bytes) -> None:
        self.png = png

    def _repr_png_(self) -> bytes:
        return self.png

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the picture to a file."""
        Path(path).write_bytes(self.png)

    def __repr__(self) -> str:
        return f"Picture({len(self.png)} bytes)"


def of_parts(parts: Sequence[tuple[bool, Any, Any, Any]], **look: Any) -> Picture:
    """A picture of (is an obstacle, vertices, faces, values of the faces or None)."""
    ready = [(is_obstacle, v, f, None if values is None else list(values)) for is_obstacle, v, f, values in parts]
    return Picture(_koiter.picture(ready, **look))
