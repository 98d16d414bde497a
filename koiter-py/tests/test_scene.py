import numpy as np
import pytest

import koiter
from koiter import toml


def test_values_are_written_as_toml_reads_them():
    tomllib = pytest.importorskip("tomllib")
    keys = {"a": 1e-7, "b": 3, "c": [0.0, -9.81], "d": {"x y": True}, "e": 'say "hi"\n\x7f', "f": np.arange(3.0), "g": 1e22}
    lists = {"shell": [{"name": "one", "n": np.int64(4)}, {"name": "two"}], "probe": []}
    read = tomllib.loads(toml.document(keys, lists))
    assert read == {
        "a": 1e-7, "b": 3, "c": [0.0, -9.81], "d": {"x y": True}, "e": 'say "hi"\n\x7f', "f": [0.0, 1.0, 2.0], "g": 1e22,
        "shell": [{"name": "one", "n": 4}, {"name": "two"}],
    }  # fmt: skip


def test_what_no_scene_can_hold_is_refused():
    with pytest.raises(TypeError, match="NoneType"):
        toml.value(None)
    with pytest.raises(ValueError, match="there is no list 'shels'"):
        koiter.Scene().add("shels", "a")


def test_mistakes_say_what_where_and_what_to_do(hanging):
    hanging.add_constraint("edge", shell="cloht", select={"vertices": [1]})
    with pytest.raises(koiter.SceneError) as error:
        hanging.start()
    assert "cloht" in str(error.value) and "at constraint.edge.shell" in str(error.value)


def test_an_unknown_key_names_the_nearest():
    scene = koiter.Scene(time={"end": 1.0, "dt": 0.1}, gravitty=[0, 0, 0])
    with pytest.raises(koiter.SceneError, match="gravity"):
        scene.start()


def test_arrays_are_meshes_and_faulty_ones_are_refused(hanging):
    vertices, faces = koiter.mesh.generate(grid={"size": [0.4, 0.4], "cells": [6, 6]})
    scene = koiter.Scene(time={"end": 0.2, "dt": 0.01})
    scene.add_shell("cloth", (vertices, faces), "cotton", thickness=1e-3)
    scene.add_constraint("corners", shell="cloth", select={"vertices": [0, 6]})
    one, other = scene.start(), hanging.start()
    list(one.run(until=0.05)), list(other.run(until=0.05))
    assert np.array_equal(one.positions("cloth"), other.positions("cloth"))
    assert np.array_equal(one.faces("cloth"), faces)
    for broken, message in [
        ((vertices, faces - 1), "a face uses vertex -1"),
        ((vertices, faces + 5), "vertices"),
        ((vertices[:, :2], faces), r"shape \(n, 3\)"),
        ((np.full_like(vertices, np.nan), faces), "(?i)nan|finite"),
    ]:
        scene = koiter.Scene(time={"end": 0.2, "dt": 0.01})
        scene.add_shell("cloth", broken, "cotton")
        with pytest.raises(koiter.SceneError, match=message):
            scene.start()
