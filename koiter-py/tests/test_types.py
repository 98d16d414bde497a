"""The stubs against the compiled module, and the package against its own types."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import koiter

pytest.importorskip("mypy")


PACKAGE = Path(koiter.__file__).parent
CONFIGURATION = str(Path(__file__).parents[2] / "pyproject.toml")


def run(*words):
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    done = subprocess.run([sys.executable, "-m", *words], capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_that_of_the_module():
    # Classes of Rust have slots and docstrings that no stub repeats.
    run("mypy.stubtest", "koiter._koiter", "--ignore-missing-stub")


def test_the_package_keeps_its_types(tmp_path):
    run("mypy", "--config-file", CONFIGURATION, "--cache-dir", str(tmp_path), str(PACKAGE))


def test_what_people_write_is_typed(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import koiter\n"
        "scene = koiter.Scene(time={'end': 1.0, 'dt': 0.1})\n"
        "scene.add_shell('cloth', {'grid': {'size': [1, 1], 'cells': [2, 2]}}, 'cotton')\n"
        "for step in scene.start().run():\n"
        "    total: float = step.energies['membrane'] + step.min_gap\n"
        "height: float = scene.run('out')[-1].positions[:, 2].min()\n"
    )
    run("mypy", "--config-file", CONFIGURATION, "--cache-dir", str(tmp_path), str(script))
