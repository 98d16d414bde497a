"""Runs of Python that write result folders, as the program does."""

import os
import subprocess

import numpy as np
import pytest

import koiter

PROGRAM = os.environ.get("KOITER_PROGRAM")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="KOITER_PROGRAM does not name the program koiter")


@needs_program
def test_a_result_of_python_is_that_of_the_program(hanging, tmp_path):
    hanging["output"] = {"every_steps": 3}
    (tmp_path / "scene.toml").write_text(hanging.text())
    run = [PROGRAM, "run", tmp_path / "scene.toml", "--out", tmp_path / "program", "--no-film", "--quiet"]
    subprocess.run(run, check=True)
    theirs, ours = koiter.Result(tmp_path / "program"), hanging.run(tmp_path / "python")
    names = [sorted(path.name for path in (tmp_path / folder / "frames").iterdir()) for folder in ("program", "python")]
    assert names[0] == names[1]
    for name in ["topology.bin", "rest.bin", "probes.csv", *(f"frames/{name}" for name in names[0])]:
        assert (tmp_path / "program" / name).read_bytes() == (tmp_path / "python" / name).read_bytes(), name
    for one, other in zip(theirs.stats, ours.stats, strict=True):
        assert {**one, "seconds": 0} == {**other, "seconds": 0}
    left_out = {"seconds": 0, "seconds_by_part": 0, "peak_memory_bytes": 0}
    assert {**theirs.summary, **left_out} == {**ours.summary, **left_out}
    audited = subprocess.run([PROGRAM, "check", "--result", tmp_path / "python"], capture_output=True, text=True, check=False)
    assert audited.returncode == 0, audited.stderr


def test_a_run_that_ends_early_leaves_a_whole_result(hanging, tmp_path):
    hanging["output"] = {"every_steps": 10}
    result = hanging.run(tmp_path, callback=lambda simulation: simulation.step_count < 4)
    assert [frame.step for frame in (result[0], result[-1])] == [0, 4]
    assert result.summary["interrupted"] and len(result.stats) == 4
    with pytest.raises(ZeroDivisionError):
        hanging.run(tmp_path, callback=lambda simulation: 1 / (simulation.step_count - 2))
    assert result.summary["steps"] == 2
    # A loop that is left is an end too.
    for step in hanging.start().run(out=tmp_path):
        if step.step == 3:
            break
    assert koiter.Result(tmp_path)[-1].step == 3


def test_a_run_up_to_a_time_is_no_interruption(hanging, tmp_path):
    result = hanging.run(tmp_path, until=0.05)
    assert not result.summary["interrupted"]
    assert result.summary["steps"] == 5 and result[-1].time == pytest.approx(0.05)


def test_only_one_writes_to_a_folder_and_other_folders_are_left_alone(hanging, tmp_path):
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(koiter.SceneError, match="not empty and not a Koiter result"):
        hanging.run(tmp_path)
    out = tmp_path / "out"
    first = hanging.start().run(out=out)
    next(first)
    with pytest.raises(koiter.SceneError, match="another run is writing"):
        next(hanging.start().run(out=out))
    first.close()
    simulation = hanging.start()
    with pytest.raises(koiter.SceneError, match="begin_recording"):
        simulation.end_recording(False)


def test_an_energy_as_a_text_acts(hanging, tmp_path):
    free = hanging.run(tmp_path)[-1].positions
    hanging.add_energy("updraught", shell="cloth", on="vertex", density="-lift * z", parameters={"lift": 1.0})
    lifted = hanging.run(tmp_path)[-1].positions
    assert np.mean(lifted[:, 2] - free[:, 2]) > 1e-3
    hanging.add_energy("wrong", shell="cloth", on="vertex", density="z +")
    with pytest.raises(koiter.SceneError, match="energy.wrong.density"):
        hanging.start()


@needs_program
def test_a_notebook_shows_the_viewer(hanging, tmp_path):
    try:
        page = koiter.show(hanging.run(tmp_path / "out", until=0.02))
    except koiter.SceneError as error:
        assert "built without the viewer" in str(error)
        return
    assert "<iframe srcdoc=" in page._repr_html_()
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text().lstrip().lower().startswith("<!doctype html")
    with pytest.raises(koiter.SceneError, match="not a Koiter result"):
        koiter.show(tmp_path)


def test_errors_end_in_their_code(hanging):
    hanging.add_obstacle("ball", sphere={"radius": -1.0})
    with pytest.raises(koiter.SceneError) as error:
        hanging.start()
    assert str(error.value).endswith("code: scene-out-of-range")


def test_ctrl_c_ends_a_run_after_its_step(hanging, tmp_path):
    import signal

    hanging["output"] = {"every_steps": 100}
    simulation = hanging.start()
    # Tests that run in the background are started with Ctrl-C ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            for step in simulation.run(out=tmp_path):
                if step.step == 2:
                    signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert koiter.Result(tmp_path).summary["interrupted"]
