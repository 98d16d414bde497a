# %% [markdown]
# # Reading results
# `scene.run` writes the same folder as `koiter run`; either is read as arrays.

# %%
import tempfile

import numpy as np

import koiter

scene = koiter.Scene(time={"end": 0.3, "dt": 0.01}, output={"every_steps": 5})
scene.add_shell("flag", {"grid": {"size": [0.3, 0.2], "cells": [9, 6]}}, "cotton", thickness=1e-3)
scene.add_constraint("pole", shell="flag", select={"box": {"min": [-1, -1, -1], "max": [-0.149, 1, 1]}})
scene.add_probe("lowest", "lowest", shell="flag")
folder = tempfile.TemporaryDirectory()
result = scene.run(folder.name)

# %% [markdown]
# Frames are read when they are asked for; parts say which vertices are whose.

# %%
print(result, len(result), "frames at", np.round(result.times, 2))
flag = result.parts["flag"]
tips = np.array([frame.positions[flag.vertices][:, 2].min() for frame in result])
assert tips[-1] < tips[0]

# %% [markdown]
# Figures of every step, probes of every step, and the sums of the run.

# %%
iterations = [step["newton_iterations"] for step in result.stats]
kinetic = np.array([step["energies"]["kinetic"] for step in result.stats])
assert len(iterations) == 30 and kinetic.max() > 0
assert result.probes["lowest"][-1] == tips[-1]
print(result.summary["newton_iterations"], "Newton iterations,", "converged" if result.summary["converged"] else "not converged")

# %%
result.show(color="strain")
