# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Two rigid tools pressed into one organ at once: what each feels beside what it feels alone.

A response field knows one contact.  A second one pushes down the tissue under the first, which therefore meets less of
it: on an elastic half space of plane-strain modulus E* a load P at distance L lowers the surface by

    w(L) = P / (pi E* L)                                       (Boussinesq 1885; Johnson, Contact Mechanics, eq. 3.22b)

so that two loads P at distance L, each law P = P_1(d), give P = P_1(d - w) in the first order: for Hertz' ball of
contact radius a, P = 4/3 E* a d, the share of force that is missing is about

    3/2 w / d = 2 a / (pi L)

Both contacts are solved on one mesh with all tissue nonlinear, together and one at a time, so that the difference holds
no error of meshing.  Frictionless, hence the order in which they go in does not matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fem_offline.body import patch_space
from palpate.fem_offline.clearance import why_not_placed
from palpate.fem_offline.contact import contact_surface
from palpate.fem_offline.equilibrium import Equilibrium, EquilibriumError
from palpate.fem_offline.errors import ToolError
from palpate.fem_offline.far_field import condense, interface_nodes
from palpate.fem_offline.footprint import Footprint
from palpate.fem_offline.full_body import FullBody
from palpate.fem_offline.ladder import DEFAULT_SETTINGS, Ladder, PressSettings, reaction_error
from palpate.fem_offline.organ import Organ
from palpate.fem_offline.patch import PatchSize, carve, refine
from palpate.fem_offline.pose import Pose, ToolDistance, tilted
from palpate.fem_offline.site import Site
from palpate.fem_offline.surroundings import surroundings
from palpate.fem_offline.tool import Tool

__all__ = ["TwoContacts", "press_two"]

LIFTED = 1.0
"""m; how far a tool that is not there is lifted."""


@dataclass(frozen=True)
class TwoContacts:
    """What two tools feel, K depths, the same for both.

    Attributes:
        contact_point, normal: (2, 3) m, (2, 3); on the smooth surface.
        depth: (K,) m.
        together: (2, K, 3) N on each tool, both pressed.
        alone: (2, K, 3) N on each tool, the other one away.
        residual: largest |r| / |f| of any state.  reaction_error: largest action against reaction.
    """

    contact_point: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    together: np.ndarray
    alone: np.ndarray
    residual: float
    reaction_error: float

    @property
    def distance(self) -> float:
        """m between the contact points."""
        return float(np.linalg.norm(self.contact_point[1] - self.contact_point[0]))

    @property
    def normal_error(self) -> np.ndarray:
        """(2, K) what a field of one contact says too much, as a share of the normal force with both pressed."""
        f, f_1 = (np.einsum("tki,ti->tk", force, self.normal) for force in (self.together, self.alone))
        return (f_1 - f) / f

    @property
    def lateral_error(self) -> np.ndarray:
        """(2, K) lateral force that a field of one contact misses, as a share of that normal force."""
        miss = self.alone - self.together
        along = np.einsum("tki,ti->tk", miss, self.normal)
        aside = miss - along[:, :, None] * self.normal[:, None]
        return np.linalg.norm(aside, axis=2) / np.einsum("tki,ti->tk", self.together, self.normal)


@dataclass(frozen=True)
class _Both:
    """Two tools as one: each is what the points nearer to its own contact point see.

    The pose is the first tool's; the second is as deep as the first.  Attributes as in Tool.

    Attributes:
        sites: of each contact point alone.  pressed: which of them is there.
    """

    tool: Tool
    centre: np.ndarray
    normal: np.ndarray
    pressed: tuple[bool, bool]

    def poses(self, pose: Pose) -> tuple[Pose, Pose]:
        depth = self._offset(0) - float((pose.position - self.centre[0]) @ self.normal[0])
        found = []
        for k in (0, 1):
            height = self._offset(k) - depth if self.pressed[k] else LIFTED
            found.append(Pose(self.centre[k] + height * self.normal[k], tilted(self.normal[k])))
        return found[0], found[1]

    def _offset(self, k: int) -> float:
        return self.tool.offset_along(-self.normal[k] @ tilted(self.normal[k]))

    def second(self, points: np.ndarray) -> np.ndarray:
        """(n,) bool; points (n, 3) m that are nearer to the second contact."""
        away = np.linalg.norm(points[:, None] - self.centre, axis=2)
        return away[:, 1] < away[:, 0]

    def distance(self, points: np.ndarray, pose: Pose) -> ToolDistance:
        first, second = (self.tool.distance(points, each) for each in self.poses(pose))
        where = self.second(points)
        return ToolDistance(
            np.where(where, second.gap, first.gap),
            np.where(where[:, None], second.normal, first.normal),
            np.where(where[:, None, None], second.curvature, first.curvature),
        )

    def offset_along(self, direction: np.ndarray) -> float:
        return self.tool.offset_along(direction)

    def contact_size(self, depth: float, rotation: np.ndarray | None = None) -> float:
        return self.tool.contact_size(depth, rotation)

    def contact_extent(self, depth: float, rotation: np.ndarray | None = None) -> float:
        return self.tool.contact_extent(depth, rotation)

    def footprint(self, depth: float, rotation: np.ndarray | None = None) -> Footprint:
        return self.tool.footprint(depth, rotation)

    def hash(self) -> str:
        return self.tool.hash()


@dataclass(frozen=True)
class _BothSizes(PatchSize):
    """Edges as fine as either contact asks."""

    centres: tuple[np.ndarray, ...] = ()

    def on(self, organ: Organ, centre: np.ndarray, normal: np.ndarray):
        each = [super(_BothSizes, self).on(organ, c, organ.project(c[None])[1][0]) for c in self.centres]
        return lambda points: np.minimum(*(edge_length(points) for edge_length in each))


def press_two(
    organ: Organ,
    points: np.ndarray,
    tool: Tool,
    depths: np.ndarray,
    size: PatchSize,
    settings: PressSettings = DEFAULT_SETTINGS,
) -> TwoContacts:
    """Press `tool` at two places, together and one at a time.

    Args:
        points: (2, 3) m; projected to the smooth surface.
        depths: (K,) m, rising, positive.
        size: of the patch around each, from `patch_size`.

    Raises:
        PatchError: the patch could not be meshed.
        EquilibriumError: a state did not converge, or action and reaction differ.
        ValueError: the two contacts would overlap.
        ToolError: a tool is in the tissue before it is pressed.
    """
    centre, normal = organ.project(np.asarray(points, float))
    if np.linalg.norm(centre[1] - centre[0]) < 2.0 * size.extent:
        raise ValueError(
            f"the contacts are {1e3 * np.linalg.norm(centre[1] - centre[0]):.1f} mm apart and would overlap; "
            f"more than {2e3 * size.extent:.1f} mm"
        )
    site = _site(organ, centre, normal, size)
    near_second = _Both(tool, centre, normal, (True, True)).second(site.surface.rest.reshape(-1, 3))
    of = [share.reshape(site.surface.point_shape) for share in (~near_second, near_second)]
    forces = np.zeros((3, 2, len(depths), 3))
    residual = reaction = 0.0
    for case, pressed in enumerate(((True, True), (True, False), (False, True))):
        both = _Both(tool, centre, normal, pressed)
        reason = why_not_placed(site, both, float(depths[-1]))
        if reason:
            raise ToolError(reason, "two contacts", "flatter places")
        ladder = Ladder.above(site, both, settings, float(depths[-1]))
        for at, depth in enumerate(depths):
            found = ladder.go_to(float(depth))
            residual = max(residual, found.residual)
            # moments are taken about the pose's own position, whichever tool they come from
            reaction = max(reaction, reaction_error(site, found, ladder.contact.pose))
            forces[case, :, at] = [_force(site, found, share) for share in of]
    if reaction > settings.reaction_tolerance:
        raise EquilibriumError(f"action and reaction differ by {reaction:.1e}")
    alone = np.stack([forces[1, 0], forces[2, 1]])
    return TwoContacts(centre, normal, np.asarray(depths, float), forces[0], alone, residual, reaction)


def _site(organ: Organ, centre: np.ndarray, normal: np.ndarray, size: PatchSize) -> Site:
    """Both patches, refined, with everything else nonlinear too; contact point and normal are the first's."""
    organ.require_support()
    carved = carve(organ, centre[0], size.radius) | carve(organ, centre[1], size.radius)
    values = {name: getattr(size, name) for name in size.__dataclass_fields__}
    patch = refine(organ, carved, centre[0], _BothSizes(**values, centres=tuple(centre)))
    space, held = patch_space(organ, patch)
    shared = interface_nodes(organ, patch, space)
    loose = ~np.isin(shared[1], organ.held_nodes)
    held = np.union1d(held, shared[0][~loose])
    interface, at_organ = shared[0][loose], shared[1][loose]
    x = patch.points[patch.outer_faces]
    outward = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    inner = ~np.isin(space.face_nodes(patch.outer_faces), interface).any(axis=1)
    away = np.linalg.norm(x.mean(axis=1)[:, None] - centre, axis=2)
    near = (away < size.extent + 3.0 * size.finest) & (outward @ normal.T > 0.0)
    may_touch = near.any(axis=1) & inner
    faces = space.face_nodes(patch.outer_faces[may_touch])
    fraction = organ.fractions_of(patch.points, patch.tets, patch.label)
    tissue = organ.tissue(space, fraction, space.face_nodes(patch.outer_faces))
    body = FullBody(tissue, held, organ, patch, shared, condense(organ, carved, at_organ), faces)
    tets = patch.points[patch.tets].mean(axis=1)
    label = patch.label[np.argmin(np.linalg.norm(tets - centre[0], axis=1))]
    return Site(
        centre[0],
        normal[0],
        body,
        contact_surface(space.nodes, faces),
        patch,
        organ.material[int(label)].youngs_modulus * organ.scale_at(centre[0]),
        "full",
        tilted(normal[0]),
        organ.thickness(centre[0], normal[0]),
        surroundings(organ, patch, space.face_nodes(patch.outer_faces[~may_touch]), space.nodes),
    )


def _force(site: Site, found: Equilibrium, share: np.ndarray) -> np.ndarray:
    """(3,) N on the tool that carries the points (B, Q) of `share`."""
    load = np.where(share, site.surface.weight, 0.0)[:, :, None] * found.contact.traction
    return -load.sum(axis=(0, 1))
