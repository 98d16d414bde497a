"""Families of runs, on processes of this machine and on a Dask cluster of which a worker dies."""

import csv
import os
import signal
import threading
import time

import pytest

import koiter


def test_all_combinations_are_run_once(hanging, tmp_path):
    vary = {"shell.cloth.bending": ["bac", "ds-theta"], "shell.cloth.thickness": [1e-3, 2e-3]}
    rows = koiter.sweep(hanging, vary, tmp_path, until=0.05)
    assert [(row["shell.cloth.bending"], row["shell.cloth.thickness"]) for row in rows] == [
        ("bac", 1e-3), ("bac", 2e-3), ("ds-theta", 1e-3), ("ds-theta", 2e-3),
    ]  # fmt: skip
    assert all(row["error"] == "" and row["steps"] == 5 and row["lowest"] < -0.001 for row in rows)
    assert len({row["lowest"] for row in rows}) == 4
    with (tmp_path / "table.csv").open() as file:
        assert [row["folder"] for row in csv.DictReader(file)] == [row["folder"] for row in rows]
    # Again: nothing is made anew.
    times = {path: path.stat().st_mtime_ns for path in tmp_path.glob("*/manifest.json")}
    assert koiter.sweep(hanging, vary, tmp_path, until=0.05) == rows
    assert times == {path: path.stat().st_mtime_ns for path in tmp_path.glob("*/manifest.json")}
    # Further: everything is.
    assert all(row["steps"] == 6 for row in koiter.sweep(hanging, vary, tmp_path, until=0.06))


class Here:
    """An executor in this process."""

    def submit(self, function, *arguments):
        value = function(*arguments)

        class Done:
            def result(self):
                return value

        return Done()


def test_runs_that_fail_stay_in_the_table(hanging, tmp_path):
    rows = koiter.sweep(hanging, {"shell.cloth.thickness": [1e-3, -1.0]}, tmp_path, executor=Here(), until=0.02)
    assert rows[0]["error"] == "" and "larger than 0" in rows[1]["error"]
    with pytest.raises(koiter.SceneError, match="no values"):
        koiter.sweep(hanging, {"shell.cloth.thickness": []}, tmp_path)
    with pytest.raises(koiter.SceneError, match="'thicknes'"):
        raise koiter.SceneError(koiter.sweep(hanging, {"shell.cloth.thicknes": [1]}, tmp_path, executor=Here())[0]["error"])


def test_a_scene_of_a_file_is_swept_too(hanging, tmp_path):
    (tmp_path / "scene.toml").write_text(hanging.text())
    rows = koiter.sweep(tmp_path / "scene.toml", {"gravity": [[0, 0, -1.62]]}, tmp_path / "out", executor=Here(), until=0.02)
    assert rows[0]["error"] == "" and rows[0]["steps"] == 2


def test_a_worker_of_a_dask_cluster_may_die(hanging, tmp_path):
    distributed = pytest.importorskip("distributed")
    killed = []

    def kill_one(cluster):
        """Kills the first worker that writes a result, while it does."""
        for _ in range(2000):
            pids = {worker.pid for worker in cluster.workers.values() if worker.pid}
            if pids and any(tmp_path.glob("*/frames/00001.bin")):
                os.kill(min(pids), signal.SIGKILL)
                killed.append(min(pids))
                return
            time.sleep(0.01)

    hanging["time"] = {"end": 1.5, "dt": 0.01}
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            killer = threading.Thread(target=kill_one, args=(cluster,))
            killer.start()
            rows = koiter.sweep(hanging, {"shell.cloth.thickness": [1e-3, 2e-3, 3e-3]}, tmp_path, executor=client)
            killer.join()
    assert len(killed) == 1
    assert all(row["error"] == "" and row["steps"] == 150 for row in rows)
