# %% [markdown]
# # Comparing bending models
# A strip is rolled to a cylinder, whose bending energy is known: B κ² / 2 an area, with B = E h³ / 12 (1 − ν²). Which models converge to
# it, and on which meshes?

# %%
import numpy as np

import koiter

young, poisson, thickness, radius = 3e9, 0.38, 1e-4, 0.1
stiffness = young * thickness**3 / (12 * (1 - poisson**2))


def error(model, cells):
    flat, faces = koiter.mesh.generate(grid={"size": [0.1, 0.05], "cells": [2 * cells, cells], "diagonals": "checkerboard"})
    angle = flat[:, 0] / radius
    rolled = np.stack([radius * np.sin(angle), flat[:, 1], radius * np.cos(angle)], axis=1)
    shape = koiter.energy((rolled, faces), rest=flat, thickness=thickness, young=young, poisson=poisson, bending=model)
    return shape.bending / (stiffness / radius**2 / 2 * 0.1 * 0.05) - 1


# %%
errors = {}
for model in ["bac", "dcs", "ds-theta", "qb-cr", "dkt"]:
    errors[model] = [error(model, cells) for cells in (4, 8, 16)]
    print(f"{model:10}" + "".join(f"{100 * e:9.2f} %" for e in errors[model]))

# %% [markdown]
# Models with directors converge, here with the size of the triangles: a strip along the boundary, half a triangle wide, bears no bending.
# Those of single hinges do not; they are another material, that of the mesh.

# %%
for model in ["bac", "dcs", "dkt"]:
    assert abs(errors[model][2]) < 0.6 * abs(errors[model][1])
assert abs(errors["ds-theta"][2]) > abs(errors["ds-theta"][1]) > 1
