import pytest

import koiter


@pytest.fixture
def hanging():
    """A small sheet of cotton held by two corners."""
    scene = koiter.Scene(time={"end": 0.2, "dt": 0.01})
    mesh = {"grid": {"size": [0.4, 0.4], "cells": [6, 6]}}
    scene.add_shell("cloth", mesh, "cotton", thickness=1e-3)
    scene.add_constraint("corners", shell="cloth", select={"vertices": [0, 6]})
    scene.add_probe("lowest", "lowest", shell="cloth")
    return scene
