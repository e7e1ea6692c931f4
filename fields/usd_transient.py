# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layer `transient` of a response field in USD: one prim below the response, only where the scene asked for it.

/<organ>/Response/Transient     PalpateTransientAPI
"""

from __future__ import annotations

import numpy as np
from pxr import Sdf, Usd

from palpate.fields.field_error import FieldError
from palpate.fields.transient_layout import (
    LIMITS,
    TransientLayerError,
    read_transient_layer,
    transient_layer,
)
from palpate.fields.usd_layer import author_schema, child, schema_values

__all__ = ["author_transient", "read_usd_transient"]

API = "PalpateTransientAPI"


def author_transient(response: Sdf.PrimSpec, layers: dict[str, bytes]) -> None:
    """Below the response prim, where `layers` has the effect."""
    if "transient" not in layers:
        return
    read = read_transient_layer(layers["transient"])
    arrays = {
        "velocity": read.velocity,
        "sample_count": read.force.shape[1],
        "force": read.force.ravel(),
    }
    author_schema(child(response, "Transient", "Scope"), API, read.numbers | arrays)


def read_usd_transient(response: Usd.Prim) -> dict[str, bytes]:
    """What `author_transient` was given; empty where the field has no such effect.  Raises FieldError."""
    prim = response.GetChild("Transient")
    if not prim:
        return {}
    v = schema_values(prim, API)
    numbers = {key: float(v[key]) for key in LIMITS if key != "rate"}
    try:
        force = np.reshape(v["force"], (len(v["velocity"]), int(v["sample_count"])))
        return {"transient": transient_layer(float(v["rate"]), v["velocity"], force, **numbers)}
    except (ValueError, TransientLayerError) as error:
        raise FieldError(f"{prim.GetPath()}: {error}") from error
