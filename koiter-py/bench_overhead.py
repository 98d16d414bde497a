"""What the binding costs: the share of a loop over steps that is not spent in them.

Usage: python koiter-py/bench_overhead.py [STEPS]

A sheet of some thousand triangles hangs by two corners for 1000 steps; after each the positions and energies are read, as a
callback would. Printed are the seconds of the loop, those within steps, and the share of the rest in per cent.
"""

import sys
import time

start = time.perf_counter()
import koiter  # noqa: E402

imported = time.perf_counter() - start


def main(num_steps: int) -> None:
    scene = koiter.Scene(time={"end": 1e-3 * num_steps, "dt": 1e-3}, contact={"enabled": False})
    mesh = {"grid": {"size": [0.4, 0.4], "cells": [22, 22], "diagonals": "checkerboard"}}
    scene.add_shell("cloth", mesh, "cotton", thickness=1e-3)
    scene.add_constraint("corners", shell="cloth", select={"vertices": [0, 22]})
    simulation = scene.start()
    within = 0.0
    start = time.perf_counter()
    for step in simulation.run():
        within += step.wall_seconds
        simulation.positions("cloth")[:, 2].min()
        sum(step.energies.values())
    loop = time.perf_counter() - start
    faces = len(simulation.faces("cloth"))
    print(f"import {1e3 * imported:.0f} ms; {simulation.step_count} steps of {faces} triangles: {loop:.2f} s, {within:.2f} s within steps")
    print(f"binding: {100 * (loop - within) / loop:.2f} %, {1e6 * (loop - within) / simulation.step_count:.0f} µs a step")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
