# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The eleven samples of the paper's study as scenes: blocks that a flat tip of 10 mm radius feels with their stiffness.

A rigid flat punch of radius a on a half space takes K = 2 a E / (1 - nu^2) (Sneddon 1965), on this block BLOCK times
that, which gives E of the wood, the foam and the eight renderings, whose transients stand in [tool.transient].  Wood on
foam is a board on a column of foam, K = E A / h.  The paper has stiffnesses only; sizes are this project's.  Limits:
right for small depths; the tip's rounded edge is left out of K, and wood of 70 kN/m gives way less than a device can
tell.
"""

from __future__ import annotations

from pathlib import Path

from palpate.author.transients.assessment import identified, recorded_library
from palpate.author.transients.library_file import write_library
from palpate.author.transients.samples import FIRM, PULSE, SAMPLES, SINUSOID, SOFT, Rendering
from palpate.author.transients.stylus import Stylus

__all__ = ["BLOCK", "STIFFNESS", "TIP", "punch_modulus", "write_sample_scenes"]

TIP = 10e-3
"""m, radius of the flat tip."""
SIZE = (0.12, 0.12, 0.06)
"""m, of the block; its base lies on z = 0."""
BLOCK = 1.17
"""Stiffness of the block over a half space's, by linear elasticity, 9,473 nodes, edges of 2.5 mm below the tip."""
BOARD = (0.06, 0.06, 0.01)
"""m, of the wood on foam; the foam below has the same cross section."""
STIFFNESS = {"wood": 70_000.0, "wood_on_foam": 350.0, "foam": 220.0}
"""N/m (the paper, table 1)."""
NU, FOAM_NU = 0.45, 0.2


def punch_modulus(stiffness: float, nu: float = NU) -> float:
    """Pa: E of the block that a flat tip feels as `stiffness` N/m."""
    return stiffness * (1.0 - nu**2) / (2.0 * TIP * BLOCK)


def write_sample_scenes(folder: Path, stylus: Stylus | None = None) -> list[Path]:
    """Writes a scene for each sample, their two surfaces, and the libraries beside 680 and 340 N/m; the scenes' paths.

    Raises OSError where a file cannot be written.
    """
    import trimesh

    folder.mkdir(parents=True, exist_ok=True)
    for name, size in (("block", SIZE), ("column", (*BOARD[:2], SIZE[2]))):
        box = trimesh.creation.box(size)
        box.apply_translation((0.0, 0.0, 0.5 * size[2]))
        box.export(folder / f"{name}.stl")
    stylus = stylus or Stylus()
    model = identified(stylus)
    for stiffness in (FIRM, SOFT):
        library = recorded_library(stylus, model, stiffness=stiffness)
        write_library(folder / _library(stiffness), library, stiffness)
    paths = []
    for name, sample in SAMPLES.items():
        path = folder / f"{name}.toml"
        path.write_text(_scene(name, sample if isinstance(sample, Rendering) else None))
        paths.append(path)
    return paths


def _library(stiffness: float) -> str:
    return f"wood_on_foam_beside_{stiffness:.0f}.npz"


def _scene(name: str, rendering: Rendering | None) -> str:
    transient = _transient(rendering) if rendering is not None else ""
    effects = '["response", "transient"]' if transient else '["response"]'
    surface, region = "block", ""
    if name == "wood_on_foam":
        height = SIZE[2] - BOARD[2]
        modulus, nu = STIFFNESS[name] * height / (BOARD[0] * BOARD[1]), FOAM_NU
        surface = "column"
        region = (
            f'\n[[organ.region]]\nname = "board"\nbox = {{ min = [-1.0, -1.0, {height:g}], max = [1.0, 1.0, 1.0] }}\n'
            f"{_material(punch_modulus(STIFFNESS['wood']), NU, 'material = ')}"
        )
    else:
        stiffness = rendering.stiffness if rendering is not None else STIFFNESS[name]
        nu = FOAM_NU if name == "foam" else NU
        modulus = punch_modulus(stiffness, nu)
    return (
        f'[scene]\nname = "{name}"\neffects = {effects}\n\n'
        f'[organ]\nsurface = "{surface}.stl"\nmesh_size = "12 mm"\n'
        f"{_material(modulus, nu, 'material = ')}{region}\n"
        "[[organ.support]]\nbox = { min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.001] }\n\n"
        f'[reach]\nsphere = {{ center = [0.0, 0.0, {SIZE[2]:g}], radius = "8 mm" }}\ndepth_max = "5 mm"\n\n'
        f'[[tool]]\nname = "tip"\nshape = "flat_punch"\nradius = "{1e3 * TIP:g} mm"\nedge_radius = "1 mm"\n{transient}'
    )


def _material(modulus: float, nu: float, key: str) -> str:
    return f'{key}{{ model = "neo_hookean", youngs_modulus = "{modulus / 1e3:.6g} kPa", poissons_ratio = {nu:g} }}\n'


def _transient(rendering: Rendering) -> str:
    limits = 'force_short = "8.5 N"\nforce_steady = "1.4 N"\n'
    if rendering.transient == "none":
        return ""
    if rendering.transient == "library":
        own = f'shape = "library"\nlibrary = "{_library(rendering.stiffness)}"\n'
    elif rendering.transient == "pulse":
        own = f'shape = "pulse"\namplitude = "{PULSE[0]:g} N s/m"\nduration = "{1e3 * PULSE[1]:g} ms"\n'
    else:
        own = (
            f'shape = "decaying_sinusoid"\namplitude = "{SINUSOID[0]:g} N s/m"\nfrequency = "{SINUSOID[1]:g} Hz"\n'
            f'duration = "{1e3 * SINUSOID[2]:g} ms"\n'
        )
    return f"\n[tool.transient]\n{own}{limits}"
