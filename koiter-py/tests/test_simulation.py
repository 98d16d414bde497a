import numpy as np
import pytest

import koiter


def test_steps_go_up_to_the_end_and_tell_what_they_took(hanging):
    simulation = hanging.start()
    steps = list(simulation.run())
    assert [step.step for step in steps] == list(range(1, 21))
    assert simulation.time == pytest.approx(0.2) and all(step.converged for step in steps)
    assert steps[-1].energies["gravity"] < steps[0].energies["gravity"]
    assert simulation.probes["lowest"] == simulation.positions("cloth")[:, 2].min()
    assert list(simulation.run()) == []


def test_a_callback_reads_changes_and_ends_a_run(hanging):
    simulation = hanging.start()

    def push(running):
        running.set_velocities("cloth", np.zeros((49, 3)))
        return running.step_count < 3

    assert len(list(simulation.run(callback=push))) == 3
    assert np.all(simulation.velocities("cloth") == 0)


def test_positions_can_be_set_but_not_to_a_crossing(hanging):
    hanging["contact"] = {"d_hat": 1e-3}
    hanging.add_obstacle("ball", sphere={"radius": 0.05}, translate=[0.0, 0.0, -0.2])
    simulation = hanging.start()
    before = simulation.positions("cloth")
    simulation.set_positions("cloth", before + [0.0, 0.0, 0.01])
    assert np.allclose(simulation.positions("cloth")[:, 2], before[:, 2] + 0.01)
    with pytest.raises(koiter.SceneError, match="touch or cross"):
        simulation.set_positions("cloth", before - [0.0, 0.0, 0.2])
    assert np.allclose(simulation.positions("cloth")[:, 2], before[:, 2] + 0.01)
    with pytest.raises(koiter.SceneError, match="49 vertices"):
        simulation.set_positions("cloth", before[:-1])
    with pytest.raises(koiter.SceneError):
        simulation.set_positions("cloth", before + np.inf)


def test_the_hessian_is_the_derivative_of_the_gradient(hanging):
    pytest.importorskip("scipy")
    rng = np.random.default_rng(1)
    simulation = hanging.start()
    start = simulation.positions("cloth") + 1e-3 * rng.standard_normal((49, 3))
    along, eps = rng.standard_normal((49, 3)), 1e-6

    def gradient(t):
        simulation.set_positions("cloth", start + t * along)
        return simulation.gradient()

    difference = (gradient(eps) - gradient(-eps)) / (2 * eps)
    simulation.set_positions("cloth", start)
    hessian = simulation.hessian()
    direction = np.zeros(hessian.shape[0])
    direction[: along.size] = along.ravel()
    error = np.linalg.norm(hessian @ direction - difference) / np.linalg.norm(difference)
    # Central differences: ε² by the third derivatives, and round-off over ε.
    assert error < 1e-6
    assert abs(hessian - hessian.T).max() == 0


def test_unknown_names_are_refused(hanging):
    simulation = hanging.start()
    with pytest.raises(koiter.SceneError, match="there are: cloth"):
        simulation.positions("sheet")
    with pytest.raises(koiter.SceneError, match="there are: strain"):
        simulation.show(color="stress")
    with pytest.raises(koiter.SceneError, match="larger than 0 s"):
        simulation.step(0.0)


def test_a_picture_is_a_png(hanging, tmp_path):
    picture = hanging.start().show(size=(64, 48), color="strain")
    picture.save(tmp_path / "start.png")
    assert (tmp_path / "start.png").read_bytes().startswith(b"\x89PNG")
    assert picture._repr_png_() == picture.png


def test_other_threads_go_on_while_a_step_runs(hanging):
    import threading

    simulation, ran = hanging.start(), []
    done = threading.Event()

    def count():
        while not done.wait(1e-4):
            ran.append(simulation is not None)

    other = threading.Thread(target=count)
    other.start()
    list(simulation.run())
    done.set()
    other.join()
    assert len(ran) > 1
