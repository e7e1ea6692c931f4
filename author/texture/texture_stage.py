# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""From [[texture]] to the layer `texture` of each tool's field.

A table that names a place, and every table of a painted organ, is scaled by a mask: 0 to 1 on a quadratic B-spline
lattice as fine as the amplitudes', whose coefficients are the place or the paint at the closest point of the surface.
So a border is as wide as three of its cells, and force is continuous across it.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate.author.errors import UNREADABLE, InputError
from palpate.author.scene import Scene
from palpate.author.texture.texture_rules import FACTORS
from palpate.author.texture.texture_table import FINEST, WAVES
from palpate.author.texture.texture_table import Texture as Table
from palpate.fields.field_error import FieldError
from palpate.fields.lattice import BLOCK_EDGE, Lattice
from palpate.fields.response_field import ResponseField
from palpate.fields.texture import (
    HEIGHT_SHARE,
    MASK_LIMIT,
    WAVE_LIMIT,
    DeviceLimits,
    Texture,
    Waves,
    grating,
    joined,
    noise,
    profile,
)
from palpate.fields.texture_layout import texture_bytes

if TYPE_CHECKING:
    from palpate.author.organ_stage import OrganMesh

__all__ = ["HEIGHT_OVER_DEPTH", "scene_limits", "textures_of", "with_texture"]

HEIGHT_OVER_DEPTH = 0.125
"""Largest sum of heights over the depth of the shallowest tool: half of its depth then feels all of them."""


def textures_of(scene: Scene) -> tuple[Texture, dict[str, Any]] | None:
    """The scene's texture without its masks and stiffness, and what a summary says of it; None where it has none.

    Raises:
        InputError: a profile cannot be read, heights are too large, or there are too many waves or masks.
    """
    if "texture" not in scene.effects:
        return None
    masks = _masks(scene)
    rows, waves = [], []
    for i, table in enumerate(scene.texture):
        own, left = _waves(scene, f"texture[{i}]", table)
        waves.append(replace(own, mask=masks[i]))
        rows.append(
            {
                "kind": table.kind,
                "waves": len(own.phase),
                "height_max": float(own.amplitude.sum()),
                "wavelength": [
                    float(1.0 / own.spatial_frequency.max()),
                    float(1.0 / own.spatial_frequency.min()),
                ],
                "masked": masks[i] >= 0,
                "left_out": left,
            }
        )
    height = float(sum(w.amplitude.sum() for w in waves))
    together = joined(waves)
    count = sum(-(-len(w.phase) // 4) for w in together)
    if count > WAVE_LIMIT // 4:
        what = f"makes {count} groups of four waves (those of one place share groups)"
        raise InputError(
            scene.problem("texture", None, what, f"at most {WAVE_LIMIT // 4}: fewer waves or places")
        )
    least = height / HEIGHT_SHARE
    fade = max([least, *(table.fade_depth for table in scene.texture if table.fade_depth is not None)])
    for i, table in enumerate(scene.texture):
        if table.fade_depth is not None and table.fade_depth < least * (1.0 - 1e-9):
            what = f"is too shallow for heights of {height:g} m together"
            raise InputError(
                scene.problem(f"texture[{i}].fade_depth", table.fade_depth, what, f"at least {least:g} m")
            )
    depth = min(scene.depth_max(tool) for tool in scene.tool)
    if fade > HEIGHT_OVER_DEPTH / HEIGHT_SHARE * depth:
        highest = int(np.argmax([row["height_max"] for row in rows]))
        what = f"makes heights of {height:g} m together, whole from {fade:g} m on, where a tool presses {depth:g} m"
        expected = f"at most {HEIGHT_OVER_DEPTH * depth:g} m together"
        raise InputError(
            scene.problem(f"texture[{highest}].amplitude", scene.texture[highest].amplitude, what, expected)
        )
    return Texture(together, fade, 0.0, scene_limits(scene)), {
        "fade_depth": fade,
        "height_max": height,
        "textures": rows,
    }


def with_texture(scene: Scene, field: ResponseField, mesh: OrganMesh) -> tuple[ResponseField, dict[str, Any]]:
    """`field` with the layer that the scene asks for, without any other texture; and its summary."""
    others = {name: data for name, data in field.layers.items() if name != "texture"}
    made = textures_of(scene)
    if made is None:
        return replace(field, layers=others), {}
    texture, told = made
    texture = replace(
        texture,
        stiffness=_stiffness(field),
        normal_force=float(np.max(field.nodes.normal_force)),
        masks=_lattice(scene, field, mesh),
    )
    data = texture_bytes(texture)
    return replace(field, layers={**others, "texture": data}), {
        **told,
        "stiffness": texture.stiffness,
        "normal_force": texture.normal_force,
        "bytes": len(data),
    }


def scene_limits(scene: Scene) -> DeviceLimits:
    """Of the scene's device; the least safety factors where it says none."""
    device = scene.device
    known = {} if device is None else {
        name: getattr(device, name) or 0.0
        for name in ("resolution", "force_resolution", "stiffness_max", "structural_frequency")
    }  # fmt: skip
    factors = {name: (getattr(device, name) if device else None) or least for name, least in FACTORS.items()}
    return DeviceLimits(**factors, **known)


def _waves(scene: Scene, key: str, table: Table) -> tuple[Waves, float]:
    """Those of a table, and the share of a profile's mean square that they leave out."""
    direction = table.direction or (1.0, 0.0, 0.0)
    if table.kind == "grating":
        frequency = table.spatial_frequency or 1.0 / (table.wavelength or 1.0)
        return grating(table.amplitude or 0.0, frequency, direction), 0.0
    count = table.waves or WAVES
    if table.kind == "noise":
        assert table.band is not None
        across = np.linalg.svd(np.array([direction]))[2][1:] if table.direction else np.eye(3)
        seed = 1 if table.seed is None else table.seed
        return noise(table.amplitude or 0.0, table.band, seed, count, across.tolist()), 0.0
    assert table.file is not None
    try:
        position, height = _profile(table.file)
        low, high = table.band or (0.0, FINEST)
        limits = scene_limits(scene)
        if limits.resolution > 0.0:
            high = min(
                high, (1.0 - 1e-9) / (max(limits.time_factor, limits.space_factor) * limits.resolution)
            )
        own, left = profile(position, height, direction, count, (low, high))
    except (FieldError, *UNREADABLE) as error:
        expected = "two columns or arrays, position and height, in m"
        raise InputError(
            scene.problem(f"{key}.file", str(table.file), f"is no profile ({error})", expected)
        ) from error
    if table.amplitude is not None:
        own = replace(own, amplitude=own.amplitude * table.amplitude / np.max(abs(height - height.mean())))
    return own, left


def _profile(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Position and height, (n,) m."""
    if file.suffix.lower() == ".npz":
        with np.load(file, allow_pickle=False) as arrays:
            return np.asarray(arrays["position"], float), np.asarray(arrays["height"], float)
    lines = file.read_text(encoding="utf-8").splitlines()
    body = (
        lines[1:] if lines and any(letter.isalpha() and letter not in "eE" for letter in lines[0]) else lines
    )
    if not any(line.strip() for line in body):
        raise ValueError("no rows of position and height")
    table = np.loadtxt(body, delimiter=",", ndmin=2)
    if table.shape[1] != 2:
        raise ValueError(f"{table.shape[1]} columns")
    return table[:, 0], table[:, 1]


def _masks(scene: Scene) -> list[int]:
    """The mask of each table; -1 where it is everywhere the same."""
    painted = scene.organ.paint is not None and scene.organ.paint.texture_amplitude is not None
    kinds: list[Any] = []
    found = []
    for table in scene.texture:
        place = tuple(getattr(table, name) for name in ("box", "sphere", "half_space", "surface"))
        if not painted and not table.is_given:
            found.append(-1)
            continue
        if place not in kinds:
            kinds.append(place)
        found.append(kinds.index(place))
    if len(kinds) > MASK_LIMIT:
        what = f"are at {len(kinds)} different places"
        raise InputError(scene.problem("texture", None, what, f"at most {MASK_LIMIT}"))
    return found


def _lattice(scene: Scene, field: ResponseField, mesh: OrganMesh) -> Lattice | None:
    """(blocks of the amplitudes) masks, 0 to 1."""
    rows = _masks(scene)
    count = max(rows, default=-1) + 1
    if count == 0:
        return None
    like = field.amplitudes
    place = np.argwhere(like.block_index >= 0)
    row = like.block_index[tuple(place.T)]
    offsets = np.stack(np.meshgrid(*[np.arange(BLOCK_EDGE)] * 3, indexing="ij"), axis=-1)
    at = BLOCK_EDGE * place[:, None, None, None, :] + offsets
    points = (like.origin + like.spacing * (at - 0.5)).reshape(-1, 3)
    surface, _, _ = mesh.distance.closest(points)
    paint = mesh.painted("texture_amplitude", surface)
    values = np.zeros((like.block_count, BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE, count))
    for mask in range(count):
        table = scene.texture[rows.index(mask)]
        inside = table.contains(surface).astype(float) if table.is_given else np.ones(len(points))
        own = inside if paint is None else inside * np.clip(paint, 0.0, 1.0)
        values[row, ..., mask] = own.reshape(len(place), *(BLOCK_EDGE,) * 3)
    return Lattice(
        like.origin, like.spacing, np.where(like.block_index >= 0, like.block_index, -1), np.float32(values)
    )


def _stiffness(field: ResponseField) -> float:
    """N/m; the largest slope of normal force over depth at the nodes."""
    nodes = field.nodes
    return float(np.max(np.diff(nodes.normal_force, axis=1) / np.diff(nodes.depth_knots)))
