# %% [markdown]
# # A drape
# A square of cotton falls on a ball. Run the cells in Jupyter or an editor that knows `# %%` cells, or the whole as a script.

# %%
import koiter

scene = koiter.Scene(time={"end": 0.3, "dt": 0.01}, contact={"d_hat": 2e-3})
vertices, faces = koiter.mesh.generate(grid={"size": [0.5, 0.5], "cells": [14, 14]})
scene.add_shell("cloth", (vertices + [0, 0, 0.3], faces), "cotton", thickness=1e-3)
scene.add_obstacle("ball", sphere={"radius": 0.12}, translate=[0, 0, 0.15], friction=0.3)

# %% [markdown]
# Steps come one a turn of the loop; what they tell is in `help(koiter.Step)`.

# %%
simulation = scene.start()
heights = []
for step in simulation.run():
    heights.append(simulation.positions("cloth")[:, 2].min())
    assert step.min_gap > 0
print(f"after {step.time:.2f} s the lowest point is at {heights[-1]:.3f} m")
assert heights[-1] < 0.25 < heights[0]

# %% [markdown]
# A picture, coloured by a field of the faces.

# %%
simulation.show(color="strain")
