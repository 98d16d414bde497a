import numpy as np
import pytest

import koiter

PAPER = {"thickness": 1e-4, "young": 3e9, "poisson": 0.38}


def cylinder_panel(radius, nx=24, ny=6):
    """A flat strip 0.2 m by 0.05 m, and the same rolled to an arc of a radius."""
    flat, faces = koiter.mesh.generate(grid={"size": [0.2, 0.05], "cells": [nx, ny]})
    angle = flat[:, 0] / radius
    rolled = np.column_stack([radius * np.sin(angle), flat[:, 1], radius * (1 - np.cos(angle))])
    return flat, rolled, faces


def test_a_sphere_that_wants_to_be_flat_has_the_energy_of_plate_theory():
    radius = 0.1
    sphere = koiter.mesh.generate(icosphere={"radius": radius, "subdivisions": 3})
    shape = koiter.energy(sphere, **PAPER)
    rigidity = PAPER["young"] * PAPER["thickness"] ** 3 / (12 * (1 - PAPER["poisson"] ** 2))
    # Half D (κ₁² + κ₂² + 2ν κ₁ κ₂) an area; BAC converges with the square of the edge, here 15 mm on a radius of 100 mm.
    exact = rigidity * (1 + PAPER["poisson"]) / radius**2 * 4 * np.pi * radius**2
    assert shape.bending == pytest.approx(exact, rel=0.02)
    # Strains of round-off, squared.
    assert shape.membrane < 1e-24


def test_every_model_has_an_energy_with_its_gradient():
    flat, rolled, faces = cylinder_panel(0.1, nx=8, ny=2)
    along = np.random.default_rng(0).standard_normal(flat.shape)
    names = [model["name"] for model in koiter.bending_models() if model["name"] not in ("none", "ds-2nd")]
    assert "bac" in names and len(names) == 12
    for name in names:
        # Directors held at zero, so that both differences are taken at the same.
        eps = 1e-7
        at = lambda t: koiter.energy((rolled + t * along, faces), rest=flat, bending=name, directors="zero", **PAPER)  # noqa: E731
        total = lambda t: at(t).membrane + at(t).bending  # noqa: E731
        here = at(0.0)
        slope = np.sum((here.membrane_gradient + here.bending_gradient) * along)
        if here.directors.size == 0:
            assert slope == pytest.approx((total(eps) - total(-eps)) / (2 * eps), rel=1e-5)
        assert here.bending > 0


def test_wrong_input_is_refused():
    flat, rolled, faces = cylinder_panel(0.1, nx=4, ny=1)
    with pytest.raises(koiter.SceneError, match="did you mean 'bac'"):
        koiter.energy((rolled, faces), bending="bca", **PAPER)
    with pytest.raises(koiter.SceneError, match="thickness must be larger"):
        koiter.energy((rolled, faces), **{**PAPER, "thickness": 0.0})
    with pytest.raises(koiter.SceneError, match="rest has 3 positions"):
        koiter.energy((rolled, faces), rest=flat[:3], **PAPER)
    with pytest.raises(koiter.SceneError, match="minimise"):
        koiter.energy((rolled, faces), directors="best", **PAPER)


def test_materials_have_their_source():
    cotton = koiter.materials()["cotton"]
    assert cotton["young"] == 1e6 and cotton["source"]
