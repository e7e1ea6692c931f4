# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Writes the golden .rfield of today's layout version and what every golden file has to say.

    PYTHONPATH=tests/fields python tests/golden/regenerate.py

v<version>.rfield: a small plane, since version 2 touched in three ways, cooked by the palpate of that version and never
again: files of a version that has a successor are not touched.  v<version>.json: version, layout hash, header size,
sha256 of the file, and at some places depth (m), energy (J), gradient (N), friction stiffness (N/m) and coefficient of
each way, straight from the definitions (tests/fields/rfield_evaluation.py), which share no code with either reader's.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

import numpy as np
import synthetic_field
from rfield_evaluation import evaluate

from palpate.fields.rfield_layout import LAYOUT_HASH, VERSION
from palpate.fields.rfield_read import read_header, read_rfield

HERE = Path(__file__).parent
PLACES = np.array([[x, y, z] for x in (-4e-3, 2e-3, 5e-3) for y in (-1e-3, 3e-3) for z in (1e-3, 3.7e-3)])
"""(12, 3) m; in contact in every way, on both sides of the step in stiffness and on it."""


def said(path: Path) -> dict:
    """What the .json beside an .rfield holds."""
    data = path.read_bytes()
    header = read_header(data)
    ways = []
    for way in range(int(header["way_count"])):
        found = evaluate(read_rfield(data, way), PLACES)
        ways.append({name: getattr(found, name).tolist() for name in found._fields if name != "normal"})
    return {
        "version": int(header["version"]),
        "layout_hash": f"{int(header['layout_hash']):016x}",
        "header_size": int(header["header_size"]),
        "sha256": hashlib.sha256(data).hexdigest(),
        "field_hash": header["field_hash"].decode(),
        "way_cosine": header["way_cosine"][: int(header["way_count"])].tolist(),
        "places": PLACES.tolist(),
        "ways": ways,
    }


def main() -> None:
    path = HERE / f"v{VERSION}.rfield"
    if path.exists() and int(read_header(path)["layout_hash"]) != LAYOUT_HASH:
        sys.exit(f"{path} has another layout of version {VERSION}: give the new layout a new version")
    path.write_bytes(synthetic_field.three_ways(synthetic_field.small_plane()))
    path.with_suffix(".json").write_text(json.dumps(said(path), indent=1) + "\n")
    print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
