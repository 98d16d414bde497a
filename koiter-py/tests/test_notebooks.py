"""The notebooks of the manual, run from beginning to end."""

import os
import runpy
from pathlib import Path

import pytest

NOTEBOOKS = Path(os.environ.get("KOITER_NOTEBOOKS", Path(__file__).parents[2] / "docs" / "notebooks"))


@pytest.mark.parametrize("path", sorted(NOTEBOOKS.glob("*.py")), ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path))


def test_there_are_notebooks():
    assert len(list(NOTEBOOKS.glob("*.py"))) >= 4
