# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layer `texture` of a response field in USD: one prim below the response, only where the scene asked for it.

/<organ>/Response/Texture           PalpateTextureAPI
/<organ>/Response/Texture/Masks     PalpateLatticeAPI, where a mask scales some of it
"""

from __future__ import annotations

import numpy as np
from pxr import Sdf, Usd

from palpate.fields.field_error import FieldError
from palpate.fields.lattice import BLOCK_EDGE, Lattice
from palpate.fields.texture import DeviceLimits, Texture, Waves
from palpate.fields.texture_layout import LIMITS, read_texture, texture_bytes
from palpate.fields.usd_layer import author_schema, child, schema_values
from palpate.fields.usd_schema.attributes import APIS

__all__ = ["author_texture", "read_usd_texture"]

API = "PalpateTextureAPI"


def author_texture(response: Sdf.PrimSpec, layers: dict[str, bytes]) -> None:
    """Below the response prim, where `layers` has the effect."""
    if "texture" not in layers:
        return
    texture = read_texture(layers["texture"])
    prim = child(response, "Texture", "Scope")
    author_schema(
        prim,
        API,
        {
            "vector": np.concatenate([w.vector for w in texture.waves]).ravel(),
            "phase": np.concatenate([w.phase for w in texture.waves]),
            "amplitude": np.concatenate([w.amplitude for w in texture.waves]),
            "mask": np.concatenate([np.full(len(w.phase), w.mask, np.int32) for w in texture.waves]),
            "fade_depth": texture.fade_depth,
            "stiffness": texture.stiffness,
            "normal_force": texture.normal_force,
            **{name: getattr(texture.limits, name) for name in LIMITS},
        },
    )
    if texture.masks is not None:
        lattice = texture.masks
        author_schema(
            child(prim, "Masks", "Scope"),
            "PalpateLatticeAPI",
            {
                "origin": lattice.origin,
                "spacing": lattice.spacing,
                "block_shape": lattice.block_index.shape,
                "block_index": lattice.block_index.reshape(-1),
                "channels": [f"mask_{c}" for c in range(lattice.channel_count)],
                "coefficients": lattice.coefficients.reshape(-1),
            },
        )


def read_usd_texture(response: Usd.Prim) -> dict[str, bytes]:
    """What `author_texture` was given; empty where the field has no such effect.  Raises FieldError."""
    prim = response.GetChild("Texture")
    if not prim:
        return {}
    force = prim.GetAttribute(APIS[API].attributes["normal_force"].name)
    v = schema_values(prim, API, () if force and force.HasAuthoredValue() else ("normal_force",))
    try:
        vector = np.reshape(v["vector"], (len(v["phase"]), 3))
        waves = []
        for mask in dict.fromkeys(int(m) for m in v["mask"]):
            own = v["mask"] == mask
            waves.append(Waves(vector[own], v["phase"][own], v["amplitude"][own], mask))
        limits = DeviceLimits(**{name: float(v[name]) for name in LIMITS})
        texture = Texture(
            tuple(waves),
            float(v["fade_depth"]),
            float(v["stiffness"]),
            limits,
            _masks(prim),
            float(v.get("normal_force", 0.0)),
        )
        return {"texture": texture_bytes(texture)}
    except (ValueError, IndexError) as error:
        raise FieldError(f"{prim.GetPath()}: counts and values do not go together ({error})") from error


def _masks(prim: Usd.Prim) -> Lattice | None:
    masks = prim.GetChild("Masks")
    if not masks:
        return None
    v = schema_values(masks, "PalpateLatticeAPI")
    shape = (-1, BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE, len(v["channels"]))
    index = np.reshape(v["block_index"], tuple(int(n) for n in v["block_shape"]))
    return Lattice(v["origin"], float(v["spacing"]), index, np.reshape(v["coefficients"], shape))
