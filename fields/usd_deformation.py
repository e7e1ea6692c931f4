# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The layer `deformation` of a response field in USD: one prim below the response, only where the scene asked for it.

/<organ>/Response/Deformation     PalpateDeformationAPI
"""

from __future__ import annotations

import numpy as np
from pxr import Sdf, Usd

from palpate.fields.deformation import COMPONENTS, Deformation, ToolGap
from palpate.fields.deformation_layout import deformation_bytes, read_deformation
from palpate.fields.field_error import FieldError
from palpate.fields.usd_layer import author_schema, child, schema_values

__all__ = ["author_deformation", "read_usd_deformation"]

API = "PalpateDeformationAPI"
SHARED = ("depth_end", "scale", "radius", "normal_length", "length", "node", "normal", "mean")


def author_deformation(response: Sdf.PrimSpec, layers: dict[str, bytes]) -> None:
    """Below the response prim, where `layers` has the effect."""
    if "deformation" not in layers:
        return
    model = read_deformation(layers["deformation"])
    depth_count, radial_count = model.stuck.shape[:2]
    author_schema(
        child(response, "Deformation", "Scope"),
        API,
        {name: getattr(model, name) for name in SHARED}
        | {f"table_{h}": table.ravel() for h, table in enumerate(model.tables)}
        | {
            "rank": np.array(model.ranks, np.int32),
            "radial_count": radial_count,
            "depth_count": depth_count,
            "weight": model.weight.ravel(),
            "stuck": model.stuck.ravel(),
            "gap_step": model.gap.step,
            "gap_count": np.array(model.gap.value.shape, np.int32),
            "gap": model.gap.value.ravel(),
            "error_names": sorted(model.error),
            "error_values": [model.error[name] for name in sorted(model.error)],
        },
    )


def read_usd_deformation(response: Usd.Prim) -> dict[str, bytes]:
    """What `author_deformation` was given; empty where the field has no such effect.  Raises FieldError."""
    prim = response.GetChild("Deformation")
    if not prim:
        return {}
    v = schema_values(prim, API)
    rank = [int(r) for r in v["rank"]]
    J, K, N = int(v["radial_count"]), int(v["depth_count"]), len(v["node"])
    try:
        tables = [np.reshape(v[f"table_{h}"], (rank[h], K, J, COMPONENTS[h])).astype(float) for h in range(3)]
        model = Deformation(
            tables=(tables[0], tables[1], tables[2]),
            stuck=np.reshape(v["stuck"], (K, J, COMPONENTS[3])).astype(float),
            weight=np.reshape(v["weight"], (N, rank[0] + 3 * rank[1] + 6 * rank[2])),
            gap=ToolGap(v["gap_step"], np.reshape(v["gap"], tuple(v["gap_count"])).astype(float)),
            error=dict(zip(map(str, v["error_names"]), map(float, v["error_values"]), strict=True)),
            depth_end=v["depth_end"],
            scale=v["scale"],
            radius=v["radius"],
            normal_length=v["normal_length"],
            length=tuple(float(x) for x in v["length"]),  # type: ignore[arg-type]
            node=np.reshape(v["node"], (N, 3)),
            normal=np.reshape(v["normal"], (N, 3)),
            mean=np.asarray(v["mean"], float),
        )
    except ValueError as error:
        raise FieldError(f"{prim.GetPath()}: counts and values do not go together ({error})") from error
    return {"deformation": deformation_bytes(model)}
