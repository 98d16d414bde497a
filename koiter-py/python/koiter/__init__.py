"""Thin shells: cloth, paper, cans and leaves.

A scene is made of the words of a scene file, runs step by step, and hands out NumPy arrays:

>>> import koiter
>>> scene = koiter.Scene(time={"end": 0.5, "dt": 0.01})
>>> cloth = scene.add_shell("cloth", mesh={"grid": {"size": [0.4, 0.4], "cells": [8, 8]}}, material="cotton")
>>> scene.add_constraint("corner", shell="cloth", select={"vertices": [0]})
>>> simulation = scene.start()
>>> steps = list(simulation.run(until=0.05))
>>> simulation.positions("cloth").shape
(81, 3)

Lengths are in metres, masses in kilograms, times in seconds; z is up.
"""

from . import mesh
from ._koiter import RunError, SceneError, Step, __version__, bending_models, materials
from .energy import energy
from .families import sweep
from .picture import Picture
from .result import Result
from .scene import Scene
from .simulation import Simulation
from .viewer import Page, show

__all__ = [
    "Page",
    "Picture",
    "Result",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "Step",
    "__version__",
    "bending_models",
    "energy",
    "materials",
    "mesh",
    "show",
    "sweep",
]
