"""The viewer in a notebook."""

from __future__ import annotations

import html
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from . import _koiter
from .result import Result


class Page:
    """The viewer with a result inside: a notebook shows it, :meth:`save` writes it as one HTML file that opens anywhere."""

    def __init__(self, text: str, height: int) -> None:
        self.text = text
        self.height = height

    def _repr_html_(self) -> str:
        frame = f'<iframe srcdoc="{html.escape(self.text)}" width="100%" height="{self.height}"'
        return f'{frame} style="border: 0" allow="fullscreen"></iframe>'

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page to a file."""
        Path(path).write_text(self.text, encoding="utf-8")

    def __repr__(self) -> str:
        return f"Page({len(self.text)} characters)"


def show(result: Result | str | os.PathLike[str], *, height: int = 600) -> Page:
    """The viewer with a result inside: turn it, play it, colour it, in a notebook or saved as a page.

    The page is made by ``koiter export --to html``: the program ``koiter`` must be on the path, or named by the environment variable
    ``KOITER_PROGRAM``. Raises :class:`koiter.SceneError` where it is not, or refuses.
    """
    folder = Path(result.path) if isinstance(result, Result) else Path(result)
    program = os.environ.get("KOITER_PROGRAM") or shutil.which("koiter")
    if program is None:
        raise _koiter.SceneError(
            "the viewer's page is made by the program koiter, which is not on the path\n"
            "  help: cargo install --path koiter-cli, or show a picture with result.show()"
        )
    with tempfile.TemporaryDirectory() as temporary:
        page = Path(temporary) / "page.html"
        command = [program, "export", str(folder), "--to", "html", "-o", str(page)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise _koiter.SceneError(done.stderr.strip())
        return Page(page.read_text(encoding="utf-8"), height)
