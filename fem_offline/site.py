# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A place that can be pressed: refined patch, condensed far field, and the faces that may touch.

What does not depend on the tool (which tetrahedra are carved, the far field) is shared by every tool that presses
there; the refinement follows the tool's contact radius.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from palpate.fem_offline.body import Body, patch_space
from palpate.fem_offline.contact import ContactSurface, contact_surface
from palpate.fem_offline.far_field import FarField, condense, interface_nodes
from palpate.fem_offline.far_modes import FarModes, far_modes
from palpate.fem_offline.full_body import FullBody
from palpate.fem_offline.green import LOAD_SPACING, GreenBlock
from palpate.fem_offline.linear_body import LinearBody
from palpate.fem_offline.near_body import NearBody
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.patch import Patch, PatchSize, carve, refine
from palpate.fem_offline.quadratic_space import EDGES
from palpate.fem_offline.surroundings import Surroundings, surroundings
from palpate.fem_offline.tool import Pose, Tool, tangents, tilted

__all__ = ["FIDELITIES", "FarFieldStore", "Site", "far_field_key", "open_site", "patch_size"]

FIDELITIES = ("linear", "near_field", "full")

COARSEST = 8e-3
"""m; edges of a patch, unless its finest are above half of that: a tool of a metre is not meshed by the millimetre."""

COARSEST_SHARE = 0.4
"""Of the radius of a patch that was widened, for its coarsest edges; COARSEST has it of the usual 20 mm."""

NARROWEST = 1.2
"""Least radius of a patch over the mean edge of the organ's tetrahedra that it replaces.  With 0.64 (tools of 3 mm in
tetrahedra of 10 mm) forces are off by 2 to 10 %, with 0.8 by 0.8 %, with 0.97 by 0.6 %, and the near field's estimate
sees none of it; with 1.2 by 0.1 %."""

Kept = TypeVar("Kept", FarField, FarModes, GreenBlock)
FarFieldStore = Callable[[type[Kept], str, Callable[[], Kept]], Kept]
"""Returns what is kept under a class and a key, making it when it is not kept yet."""


@dataclass(frozen=True)
class Site:
    """A place on an organ and a way of touching it, ready for one tool.

    Attributes:
        contact_point: (3,) m on the smooth surface.  normal: (3,) outward.
        body: linear, near or full.
        surface: faces that may touch.
        patch: the refined mesh.
        youngs_modulus: Pa; of the tissue at the contact.
        fidelity: linear, near_field or full.
        rotation: (3, 3) of the tool, see `pose`.
        thickness: m of tissue below the contact point, along -normal.
        surroundings: the rest of the organ's surface, which the tool must not touch.
    """

    contact_point: np.ndarray
    normal: np.ndarray
    body: Body
    surface: ContactSurface
    patch: Patch
    youngs_modulus: float
    fidelity: str
    rotation: np.ndarray
    thickness: float
    surroundings: Surroundings

    def pose(self, tool: Tool, depth: float) -> Pose:
        """The tool `depth` (m) deep: c + (rho - d) n, rho as far as the turned tool reaches towards the tissue."""
        offset = tool.offset_along(-self.normal @ self.rotation)
        return Pose(self.contact_point + (offset - depth) * self.normal, self.rotation)

    def contact_size(self, tool: Tool, depth: float) -> float:
        """m; radius of the tool's contact, or half its width, as it is held here."""
        frame = np.stack([*tangents(self.normal), self.normal])
        return tool.contact_size(depth, frame @ self.rotation)


def patch_size(
    tool: Tool, depth_max: float, radius: float = 20e-3, refinement: float = 1.0, tilt: float = 0.0
) -> PatchSize:
    """Edge lengths for a tool: h = 0.33 a around the contact, a its radius or half its width at the deepest state.

    Edges grow by 0.5 per metre outside.  On a block (sphere of 5 mm, 5 mm deep) this is within 0.4 % of h = 0.22 a
    growing by 0.3, at every depth from 0.1 R on and a quarter of the unknowns.  A growth of 0.8 costs as little in
    force, but noise in the energy between neighbouring presses: -dW/dx then missed the lateral reaction by 0.4 % of the
    normal force, with 0.5 by 0.2 %.

    Args:
        depth_max: m.
        radius: m; of the carved patch, more where the contact is wide.
        refinement: divides every edge length (2: twice as fine).
        tilt: rad, as in `open_site`.
    """
    found = tool.footprint(depth_max, tilted(np.array([0.0, 0.0, 1.0]), tilt))
    finest = 0.33 * found.size
    return PatchSize(
        radius=max(radius, 3.5 * found.size, 2.0 * found.extent),
        finest=finest / refinement,
        core=found.size,
        growth=0.5,
        coarsest=max(COARSEST, 2.0 * finest) / refinement,
        extent=1.4 * found.extent,
        spine=found.spine,
        rim=found.edge,
        rim_finest=float(np.clip(found.edge_radius, 0.1 * found.size, finest)) / refinement,
    )


def far_field_key(organ: Organ, *parts: np.ndarray) -> str:
    """Hex digest of everything that a far field depends on; no tool in it."""
    digest = hashlib.sha256(organ.hash.encode())
    for part in parts:
        digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()


def open_site(
    organ: Organ,
    near_point: np.ndarray,
    tool: Tool,
    size: PatchSize,
    fidelity: str = "near_field",
    store: FarFieldStore = lambda kind, key, make: make(),
    tilt: float = 0.0,
) -> Site:
    """Carve, refine and condense around a surface point.

    A patch that is narrow beside the organ's tetrahedra is widened to NARROWEST of their edges.

    Args:
        near_point: (3,) m; projected to the smooth surface.
        fidelity: one of FIDELITIES.
        store: keeps far fields between sites, tools and runs.
        tilt: rad between the tool's axis and the surface normal, leaning towards the first tangent (pose.py).

    Raises:
        PatchError: the patch could not be meshed.
        SupportError: nothing holds the organ.
        ValueError: an unknown fidelity.
    """
    if fidelity not in FIDELITIES:
        raise ValueError(f"fidelity is {fidelity!r}; it must be one of {', '.join(FIDELITIES)}")
    organ.require_support()
    points, normals = organ.project(np.asarray(near_point, float)[None])
    centre, normal = points[0], normals[0]
    carved = carve(organ, centre, size.radius)
    least = NARROWEST * _mean_edge(organ, carved)
    if size.radius < least:
        size = replace(size, radius=least, coarsest=max(size.coarsest, COARSEST_SHARE * least))
        carved = carve(organ, centre, least)
    patch = refine(organ, carved, centre, size)
    space, held = patch_space(organ, patch)
    shared = interface_nodes(organ, patch, space)
    loose = ~np.isin(shared[1], organ.held_nodes)
    held = np.union1d(held, shared[0][~loose])
    interface, at_organ = shared[0][loose], shared[1][loose]
    # what follows the far field cannot be pressed; a tool that gets there is told (surroundings.py)
    inner = ~np.isin(space.face_nodes(patch.outer_faces), interface).any(axis=1)
    may_touch = _may_touch(patch, centre, normal, size) & inner
    faces = space.face_nodes(patch.outer_faces[may_touch])
    fraction = organ.fractions_of(patch.points, patch.tets, patch.label)
    tissue = organ.tissue(space, fraction, space.face_nodes(patch.outer_faces))
    body: Body
    # a patch that is the whole organ leaves nothing outside to be linear
    if fidelity != "full" or bool(carved.all()):
        modes = _modes(organ, carved, at_organ, centre, size.radius, store)
        body = (LinearBody if fidelity == "linear" else NearBody)(tissue, held, interface, modes, faces)
    else:
        key = far_field_key(organ, np.packbits(carved))
        far = store(FarField, key, lambda: condense(organ, carved, at_organ))
        body = FullBody(tissue, held, organ, patch, shared, far, faces)
    surface = contact_surface(space.nodes, faces)
    label = patch.label[np.argmin(np.linalg.norm(patch.points[patch.tets].mean(axis=1) - centre, axis=1))]
    return Site(
        centre,
        normal,
        body,
        surface,
        patch,
        organ.material[int(label)].youngs_modulus * organ.scale_at(centre),
        fidelity,
        tilted(normal, tilt),
        organ.thickness(centre, normal),
        surroundings(organ, patch, space.face_nodes(patch.outer_faces[~may_touch]), space.nodes),
    )


def _mean_edge(organ: Organ, carved: np.ndarray) -> float:
    corners = organ.points[organ.tets[carved]]
    return float(np.mean([np.linalg.norm(corners[:, a] - corners[:, b], axis=1) for a, b in EDGES]))


def _modes(
    organ: Organ,
    carved: np.ndarray,
    organ_nodes: np.ndarray,
    centre: np.ndarray,
    radius: float,
    store: FarFieldStore,
) -> FarModes:
    def green(cell: tuple[int, int, int], seen: float, make: Callable[[], GreenBlock]) -> GreenBlock:
        return store(GreenBlock, far_field_key(organ, np.array(cell), np.array([LOAD_SPACING, seen])), make)

    key = far_field_key(organ, np.packbits(carved), centre, np.array([radius]))
    return store(FarModes, key, lambda: far_modes(organ, carved, organ_nodes, centre, radius, green))


def _may_touch(patch: Patch, centre: np.ndarray, normal: np.ndarray, size: PatchSize) -> np.ndarray:
    """(B,) bool of the patch's outer faces."""
    x = patch.points[patch.outer_faces]
    outward = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    near = np.linalg.norm(x.mean(axis=1) - centre, axis=1) < size.extent + 3.0 * size.finest
    # The other face of a thin lobe is near as well; it looks the other way and cannot be touched from here.
    return near & (outward @ normal > 0.0)
