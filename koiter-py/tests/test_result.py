"""Results of the command line, read from Python: `KOITER_PROGRAM` says where the program is."""

import os
import subprocess

import numpy as np
import pytest

import koiter

PROGRAM = os.environ.get("KOITER_PROGRAM")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="KOITER_PROGRAM does not name the program koiter")


@needs_program
def test_a_run_of_the_program_and_of_python_are_the_same(hanging, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(hanging.text())
    subprocess.run([PROGRAM, "run", scene, "--out", tmp_path / "out", "--no-film", "--quiet"], check=True)
    result = koiter.Result(tmp_path / "out")
    simulation = koiter.Simulation.from_file(scene)
    list(simulation.run())
    assert np.array_equal(result[-1].positions, simulation.positions("cloth"))
    assert result[-1].time == pytest.approx(0.2) and len(result.times) == len(result)
    assert result.stats[-1]["step"] == 20 and result.summary["converged"]
    assert result.probes["lowest"][-1] == simulation.probes["lowest"]
    assert result.parts["cloth"].vertices == slice(0, 49)
    assert result.show(size=(64, 48), color="strain").png.startswith(b"\x89PNG")
    with pytest.raises(IndexError, match="there is no frame 99"):
        result[99]


def test_what_is_no_result_is_refused(tmp_path):
    with pytest.raises(koiter.SceneError):
        koiter.Result(tmp_path)
