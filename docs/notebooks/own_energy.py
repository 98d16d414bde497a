# %% [markdown]
# # An energy of your own
# A text is enough: its gradient and Hessian follow by themselves. Here a balloon is blown up by a pressure that works on its volume.

# %%
import numpy as np

import koiter


def balloon(pressure):
    scene = koiter.Scene(time={"end": 1.0, "dt": 1.0}, integrator="quasi-static", gravity=[0, 0, 0], contact={"enabled": False})
    rubber = {"young": 1e6, "poisson": 0.4, "density": 1000.0}
    scene.add_shell("ball", {"icosphere": {"radius": 0.1, "subdivisions": 2}}, rubber, thickness=1e-3, rest="mesh")
    scene.add_constraint("held", shell="ball", select={"vertices": [0, 1, 2]})
    scene.add_energy("air", shell="ball", on="shell", energy="-p * volume", parameters={"p": pressure})
    return scene


# %% [markdown]
# The stress in a thin ball is p r / 2h, so it grows by about p r (1 − ν) / (2 E h).

# %%
pressure = 200.0
simulation = balloon(pressure).start()
before = simulation.positions("ball")
for step in simulation.run():
    assert step.converged
after = simulation.positions("ball")
middle = after.mean(axis=0)
grown = np.linalg.norm(after - middle, axis=1).mean() / np.linalg.norm(before - before.mean(axis=0), axis=1).mean() - 1
expected = pressure * 0.1 * (1 - 0.4) / (2 * 1e6 * 1e-3)
print(f"it grew by {100 * grown:.2f} %, theory says {100 * expected:.2f} %")
assert abs(grown / expected - 1) < 0.1
