# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The certificate of a device as a picture of the surface that an .rfield knows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from palpate.author.errors import InputError, InputProblem, PalpateError
from palpate.author.haptic_device import HapticDevice

__all__ = ["certify_map", "require_picture"]


def require_picture(file: Path, option: str = "--map") -> None:
    """Raises InputError where `file`, given by `option`, can be no picture."""
    if file.suffix.lower() != ".png":
        raise InputError(InputProblem("", option, str(file), "is no picture", "a file that ends in .png"))
    if not file.parent.is_dir():
        raise InputError(InputProblem("", option, str(file), "is in no folder", "a folder that is there"))


def certify_map(field: Path, device: HapticDevice, file: Path) -> dict[str, Any]:
    """Draws into the PNG `file` where `device` renders the .rfield `field` without a hum.

    Returns:
        file; stiffness_allowed (N/m, None where nothing limits it); share of the reach's area without a hum, None
        where the picture has no reach; stiffness_max on it (N/m).

    Raises:
        InputError: `file` is no PNG, or its folder does not exist.
        PalpateError: this machine cannot draw.
    """
    require_picture(file)
    from palpate.author.report.device_map import device_map
    from palpate.author.report.device_picture import device_picture
    from palpate.author.report.known_surface import known_surface
    from palpate.author.report.maps import reach_map
    from palpate.author.report.render import RenderFailure
    from palpate.fields.rfield_read import read_header, read_rfield

    data = field.read_bytes()
    ways = [read_rfield(data, way) for way in range(int(read_header(data)["way_count"]))]
    reach = reach_map(known_surface(ways[0]), ways[0])
    made = device_map(ways, reach, device)
    try:
        device_picture(file, ways[0].tool.name, reach, made, device)
    except RenderFailure as failure:
        raise PalpateError(
            f"{file} could not be drawn on this machine: {failure} palpate doctor names what is missing."
        ) from failure
    return {
        "file": str(file),
        "stiffness_allowed": made.allowed,
        "share": made.share,
        "stiffness_max": float(made.sigma.max(initial=0.0)),
    }
