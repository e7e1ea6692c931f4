# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about one press into a block as good as a half space: force, energy, reaction, discretisation.

All go the way that every press of the product goes: carve, refine, condense, press.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import PressRecord, press
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification import hertz, sneddon
from palpate.fem_offline.verification.blocks import half_space
from palpate.fem_offline.verification.row import Row, against

__all__ = [
    "POISSON",
    "energy_rows",
    "force_rows",
    "hertz_share",
    "large_indentation_rows",
    "poisson_rows",
    "press_half_space",
    "refinement_row",
]

RADIUS = 5e-3
PLACE = np.array([1.3e-3, 0.7e-3, 0.0])
"""Off the mesh's planes of symmetry, where everything is easier than it should be."""
POISSON = (0.0, 0.3, 0.45, 0.499)
"""Poisson's ratios pressed against Hertz, beside the 0.48 of `force_rows`."""


@dataclass(frozen=True)
class HalfSpacePress:
    """A press and the half space it was made in."""

    record: PressRecord
    material: NeoHookean

    @property
    def effective_modulus(self) -> float:
        return hertz.effective_modulus(self.material.youngs_modulus, self.material.poissons_ratio)


def press_half_space(
    depths: np.ndarray, poissons_ratio: float = 0.48, refinement: float = 1.0
) -> HalfSpacePress:
    """Press a 5 mm sphere to `depths` (m, rising), on a mesh made for the deepest.

    Raises:
        RuntimeError: the press did not converge.
    """
    material, tool = NeoHookean(5400.0, poissons_ratio), Sphere(RADIUS)
    size = patch_size(tool, float(depths[-1]), radius=14e-3, refinement=refinement)
    site = open_site(half_space(material), PLACE, tool, size)
    record = press(site, tool, depths)
    if not record.converged:
        raise RuntimeError(record.reason)
    return HalfSpacePress(record, material)


def force_rows(pressed: HalfSpacePress) -> Iterator[Row]:
    """Hertz at the first depth, Sneddon's sphere at the second."""
    depth, force = pressed.record.depth, pressed.record.force
    note = "finite strain takes 0.15 d/R off (Zhang 2014), the block's size adds less than a/h"
    expected = hertz.sphere_force(pressed.effective_modulus, RADIUS, depth[1])
    yield against(
        f"Hertz, d/R = {depth[1] / RADIUS:.3g}", "Hertz 1882", float(force[1]), float(expected), 0.03, note
    )
    expected = sneddon.sphere_force(pressed.effective_modulus, RADIUS, depth[2])
    name = f"Sneddon's sphere, d/R = {depth[2] / RADIUS:.3g}"
    yield against(name, "Sneddon 1965", float(force[2]), float(expected), 0.03, note)


def hertz_share(poissons_ratio: float) -> float:
    """Depth over radius at which Hertz may be asked for: the more compressible, the shallower (`poisson_rows`)."""
    return 0.003 if poissons_ratio < 0.2 else 0.0125


def poisson_rows(ratios: tuple[float, ...] = POISSON) -> Iterator[Row]:
    """Hertz at small depths, whatever Poisson's ratio.

    So shallow because Hertz lets the surface move along the normal only.  A compressible one also moves inwards under
    the ball, by some (1 - 2 nu) a/R of the contact's radius, which takes it deeper into the ball: at nu = 0 the force
    is 1.032 of Hertz at d/R = 0.0125, 1.019 at 0.003.
    """
    for nu in ratios:
        share = hertz_share(nu)
        pressed = press_half_space(RADIUS * np.array([share]), poissons_ratio=nu)
        expected = hertz.sphere_force(pressed.effective_modulus, RADIUS, pressed.record.depth[1])
        name = f"Hertz, d/R = {share:g}, nu = {nu:g}"
        note = f"{pressed.record.newton_steps} Newton steps"
        yield against(name, "Hertz 1882", float(pressed.record.force[1]), float(expected), 0.03, note)


def large_indentation_rows(pressed: HalfSpacePress) -> Iterator[Row]:
    """Every state of a press at nu near 0.5 against the law of large indentation."""
    record = pressed.record
    note = "the law is for nu = 0.5"
    for depth, force in zip(record.depth[1:], record.force[1:], strict=True):
        expected = hertz.sphere_force(pressed.effective_modulus, RADIUS, depth)
        expected *= hertz.large_indentation_factor(RADIUS, depth)
        name = f"large indentation, d/R = {depth / RADIUS:.3g}, nu = {pressed.material.poissons_ratio:g}"
        yield against(name, "Zhang et al. 2014", force, expected, 0.03, note)


def energy_rows(record: PressRecord) -> Iterator[Row]:
    """Action and reaction, force as the energy's slope, energy as the force's work."""
    worst = int(np.argmax(record.reaction_error))
    name, reference = "action and reaction", "support forces, computed on their own side"
    yield Row(name, reference, float(record.reaction_error[worst]), float(record.reaction_error[worst]), 1e-8)
    depth, force, energy = record.depth[1:], record.force[1:], record.energy[1:]
    # W ~ d^(5/2) near touch: ln W over ln d is nearly straight, and dW/dd = W/d dlnW/dlnd
    slope = energy / depth * CubicSpline(np.log(depth), np.log(energy))(np.log(depth), 1)
    off = np.abs(slope / force - 1.0)[1:-1]
    k = 1 + int(np.argmax(off))
    name, reference = "dW/dd = f, worst of the inner depths", "spline through ln W over ln d"
    yield Row(name, reference, float(slope[k] / force[k]), float(off[k - 1]), 0.01)
    # f ~ d^n between neighbours (d^1.5 up to the first) integrates to (f2 d2 - f1 d1) / (n + 1)
    n = np.diff(np.log(force)) / np.diff(np.log(depth))
    work = float(force[0] * depth[0] / 2.5 + np.sum(np.diff(force * depth) / (n + 1.0)))
    yield against("stored energy", "work of the force", float(energy[-1]), work, 0.01)


def refinement_row(coarse: PressRecord, fine: PressRecord, refinement: float) -> Row:
    """Deepest force on the default mesh against a finer one."""
    name = f"default mesh against one {refinement:g} times as fine"
    return against(name, "the same press, refined", float(coarse.force[-1]), float(fine.force[-1]), 0.005)
