# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from palpate.fem_offline.contact import Unilateral, contact_surface
from palpate.fem_offline.elastic_support import elastic_support
from palpate.fem_offline.equilibrium import equilibrate
from palpate.fem_offline.errors import SupportError
from palpate.fem_offline.material import Linear, NeoHookean
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Pose, Sphere
from palpate.fem_offline.verification.blocks import block_organ

SIZE = np.array([0.05, 0.05, 0.025])
SOFT = NeoHookean(5400.0, 0.48)
TOOL = Sphere(5e-3)
PLACE = np.array([2e-3, 1e-3, 0.0])
DEPTH = 1e-3


def nothing(points):
    return np.zeros(len(points), bool)


def on_springs(stiffness, material=SOFT):
    """A block whose base stands on springs of `stiffness` Pa/m and on nothing else."""
    organ = block_organ(tuple(SIZE), (5, 5, 3), {0: material})
    base = organ.held
    return replace(organ, held=nothing, elastic=lambda x: np.where(base(x), stiffness, 0.0))


def rest(organ):
    """Linear stiffness with the springs, and nodes."""
    everything = np.ones(len(organ.tets), bool)
    return (organ.rest_stiffness(everything) + organ.spring_stiffness(everything)).tocsc(), organ.space.nodes


def top_load(organ, traction):
    """(N, 3) N; nodal forces of a traction (n, 3) Pa of points on the top face."""
    on_top = (organ.points[organ.faces][:, :, 2] > -1e-9).all(axis=1)
    surface = contact_surface(organ.space.nodes, organ.space.face_nodes(organ.faces[on_top]))
    at = traction(surface.rest.reshape(-1, 3)).reshape(*surface.point_shape, 3)
    return surface.nodal(at, organ.space.node_count)


def test_a_column_on_springs_gives_way_by_both_compliances():
    """nu = 0 under uniform pressure p: u_z = -p/k - p (z + L)/E, exactly."""
    k, E, p = 2e5, 5400.0, 10.0
    organ = on_springs(k, NeoHookean(E, 0.0))
    K, X = rest(organ)
    u = spsolve(K, top_load(organ, lambda x: np.tile([0, 0, -p], (len(x), 1))).ravel()).reshape(-1, 3)
    expected = -p / k - p * (X[:, 2] + SIZE[2]) / E
    assert u[:, 2] == pytest.approx(expected, rel=1e-9)
    assert np.abs(u[:, :2]).max() < 1e-9 * np.abs(expected).max()


def test_a_stiff_block_sinks_by_force_over_stiffness_and_area_and_tilts_by_moment_over_second_moment():
    """Rigid limit: F = k A w,  M = k I theta with I = a b^3 / 12."""
    k, p = 2e5, 10.0
    organ = on_springs(k, NeoHookean(5.4e9, 0.3))
    K, X = rest(organ)
    load = top_load(organ, lambda x: np.stack([0 * x[:, 0], 0 * x[:, 0], -p * (1 + x[:, 0] / SIZE[0])], 1))
    u = spsolve(K, load.ravel()).reshape(-1, 3)
    slope, sink = np.polyfit(X[:, 0], u[:, 2], 1)
    moment = p / SIZE[0] * SIZE[1] * SIZE[0] ** 3 / 12
    turning = k * (SIZE[1] * SIZE[0] ** 3 / 12)
    # a tilted block also moves the base along x: springs act there in all directions, at half a height's arm each
    assert sink == pytest.approx(-p / k, rel=1e-5)
    assert slope == pytest.approx(-moment / turning, rel=1e-4)


def test_springs_give_the_energy_the_force_and_the_reaction_of_their_stretch():
    """A rigid translation t: W = k A t^2 / 2, force of the ground -k A t, at the base's middle; k varies linearly."""
    organ = on_springs(3e5)
    slope = 0.4
    elastic = lambda x: organ.elastic(x) * (1.0 + slope * x[:, 0] / SIZE[0])  # noqa: E731
    springs = elastic_support(organ.space.nodes, organ.space.face_nodes(organ.faces), elastic)
    t = np.array([1e-3, -2e-3, 0.5e-3])
    u = np.tile(t, (organ.space.node_count, 1))
    area = SIZE[0] * SIZE[1]
    energy, force = springs.state(u)
    assert energy == pytest.approx(0.5 * 3e5 * area * t @ t, rel=1e-12)
    assert force.sum(axis=0) == pytest.approx(3e5 * area * t, rel=1e-12)
    centre = np.array([slope * SIZE[0] / 12.0, 0.0, -SIZE[2]])  # int x (1 + s x / a) dx / a
    assert springs.reaction(u)[:3] == pytest.approx(-3e5 * area * t, rel=1e-12)
    assert springs.reaction(u)[3:] == pytest.approx(np.cross(centre, -3e5 * area * t), rel=1e-9)
    assert springs.matrix(len(u)) @ u.ravel() == pytest.approx(force.ravel(), abs=1e-12)


def test_a_face_with_one_corner_off_the_support_has_no_springs():
    organ = on_springs(1e5)
    part = lambda x: np.where(x[:, 0] < 1e-9, organ.elastic(x), 0.0)  # noqa: E731
    springs = elastic_support(organ.space.nodes, organ.space.face_nodes(organ.faces), part)
    area = float(springs.surface.weight.sum())
    assert area == pytest.approx(0.4 * SIZE[0] * SIZE[1], rel=1e-12)  # cells end at -5 and 5 mm
    assert elastic_support(organ.space.nodes, springs.surface.faces, lambda x: np.zeros(len(x))) is None


SITE = patch_size(TOOL, DEPTH, radius=0.01)


def pressed(organ, size=SITE, fidelity="near_field"):
    """Site, tool position and frictionless equilibrium DEPTH deep."""
    site = open_site(organ, PLACE, TOOL, size, fidelity)
    position = site.contact_point + (TOOL.radius - DEPTH) * site.normal
    contact = Unilateral(site.surface, TOOL, 8e3 * site.youngs_modulus, Pose(position, np.eye(3)))
    return site, position, equilibrate(site.body, contact, np.zeros_like(site.body.nodes), 1e-10, 1e-6)


def test_springs_soften_and_stiff_ones_hold_like_a_fixed_support():
    bonded = block_organ(tuple(SIZE), (5, 5, 3), {0: SOFT})
    organs = [bonded, *(on_springs(k) for k in (1e10, 1e7, 1e5))]
    force = [pressed(organ)[2].contact.force[2] for organ in organs]
    assert force[0] > force[1] > force[2] > force[3]
    assert force[1] == pytest.approx(force[0], rel=1e-3)
    assert force[3] < 0.9 * force[0]


@pytest.mark.parametrize(
    "fidelity, material", [("near_field", SOFT), ("full", SOFT), ("near_field", Linear(5400.0, 0.4))]
)
def test_force_and_moment_of_the_ground_are_those_on_the_tool(fidelity, material):
    """Springs alone: under the base, behind the patch, and on the patch itself, 8 mm and more beside the tool."""
    organ = on_springs(1e6, material)
    both = replace(organ, elastic=lambda x: organ.elastic(x) + np.where(x[:, 0] < -6e-3, 1e5, 0.0))
    site, position, found = pressed(both, replace(SITE, radius=0.014), fidelity)
    assert site.body.tissue.springs is not None and not site.patch.carved.all()
    reaction = site.body.support_reaction(found.u, found.elastic)
    force = found.contact.force
    about_origin = found.contact.moment + np.cross(position, force)
    assert reaction[:3] == pytest.approx(force, abs=1e-8 * np.linalg.norm(force))
    assert reaction[3:] == pytest.approx(about_origin, abs=1e-8 * np.linalg.norm(force) * SIZE[0])


def test_an_organ_that_nothing_holds_is_refused():
    organ = on_springs(1e5)
    for elastic in (None, lambda x: np.zeros(len(x))):
        with pytest.raises(SupportError, match="nothing holds the organ"):
            open_site(replace(organ, elastic=elastic), PLACE, TOOL, SITE)
