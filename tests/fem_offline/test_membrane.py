# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from palpate.fem_offline.contact import Unilateral
from palpate.fem_offline.equilibrium import equilibrate
from palpate.fem_offline.material import (
    Linear,
    MooneyRivlin,
    NeoHookean,
    Ogden,
    VerondaWestmann,
    Yeoh,
)
from palpate.fem_offline.membrane import Capsule, Membrane
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Pose, Sphere
from palpate.fem_offline.verification.blocks import block_organ
from palpate.fem_offline.verification.covered_half_space import covered_rows, stiffening
from palpate.fem_offline.verification.homogeneous import plane_stress
from palpate.fem_offline.verification.sheet import LENGTH, THICKNESS, Sheet, sheet_rows

ROWS = list(sheet_rows())
MODELS = [
    NeoHookean(5.4e5, 0.45),
    MooneyRivlin(6e4, 3e4, 0.48),
    Yeoh(9e4, 3e4, 1e4, 0.3),
    VerondaWestmann(2e4, 5.0, 0.49),
    Ogden((1e5, 8e4), (6.0, -2.0), 0.4),
    Ogden((1.8e5,), (1.2,), 0.2),
]
SOFT = NeoHookean(5400.0, 0.48)
STIFF = NeoHookean(5.4e5, 0.48)
TOOL = Sphere(5e-3)


@pytest.mark.parametrize("row", ROWS, ids=[row.name for row in ROWS])
def test_verification_row(row):
    assert row.met, f"error {row.error:.1e}, bar {row.bar:.0e}"


@pytest.mark.parametrize("material", MODELS, ids=lambda m: type(m).__name__)
@pytest.mark.parametrize("stretch", [(1.4, 1.1), (1.3, 0.7)])
def test_every_model_is_in_plane_stress(material, stretch):
    """Against the model's principal stresses with P_33 = 0, in NumPy alone."""
    expected = plane_stress(material, stretch)
    one = Sheet(material)
    u = one.stretched(np.diag(stretch) - np.eye(2))
    stress, energy = one.mean_stress(u)
    assert one.membrane.state(u).thickness == pytest.approx(expected.F[2, 2], rel=1e-9)
    assert energy == pytest.approx(expected.psi, rel=1e-8)
    assert stress == pytest.approx(expected.P[:2, :2], abs=1e-8 * np.abs(expected.P).max())


@pytest.mark.parametrize("material", [*MODELS, Linear(5.4e5, 0.4)], ids=lambda m: type(m).__name__)
def test_tangent_of_every_model_is_the_slope_of_its_force(material):
    one, random = Sheet(material), np.random.default_rng(1)
    u, v = 3e-4 * random.standard_normal((2, *one.membrane.nodes.shape))
    h = 1e-4  # of v

    def force(t):
        return one.membrane.state(u + t * v).force.ravel()

    slope = (8.0 * (force(h) - force(-h)) - (force(2 * h) - force(-2 * h))) / (12.0 * h)
    product = one.stiffness(u) @ v.ravel()
    assert np.linalg.norm(slope - product) < 1e-7 * np.linalg.norm(product)


def test_a_linear_displacement_leaves_no_force_inside_an_irregular_sheet():
    one = Sheet(STIFF)
    force = one.membrane.state(one.stretched(np.array([[0.1, 0.05], [-0.02, 0.07]]))).force
    low, high = one.plane.min(axis=0), one.plane.max(axis=0)
    inside = np.all((one.plane > low + 1e-9) & (one.plane < high - 1e-9), axis=1)
    assert np.abs(force[inside]).max() < 1e-12 * np.abs(force[~inside]).max() * len(force)


def test_rest_is_free_of_force_and_rigid_motions_meet_none():
    one = Sheet(STIFF)
    scale = STIFF.youngs_modulus * THICKNESS * LENGTH
    assert np.abs(one.membrane.state(np.zeros_like(one.membrane.nodes)).force).max() < 1e-13 * scale
    K = one.stiffness(np.zeros_like(one.membrane.nodes)).toarray()
    values = np.linalg.eigvalsh(K)
    # a flat sheet at rest resists in its plane alone: N normal displacements and three motions in the plane are free
    assert np.count_nonzero(values < 1e-9 * values[-1]) == len(one.plane) + 3


def test_energy_and_force_are_proportional_to_thickness():
    thin, thick = Sheet(STIFF), Sheet(STIFF, 3 * THICKNESS)
    u = thin.stretched(np.array([[0.1, 0.05], [-0.02, 0.07]]))
    a, b = thin.membrane.state(u), thick.membrane.state(u)
    assert b.energy == pytest.approx(3 * a.energy, rel=1e-12)
    assert b.force == pytest.approx(3 * a.force, rel=1e-12, abs=1e-15)


def test_a_sheet_crushed_to_nothing_has_infinite_energy():
    one = Sheet(STIFF)
    assert one.membrane.state(one.stretched(-np.eye(2))).energy == np.inf


@pytest.mark.parametrize("thickness", [0.0, -1e-4, np.nan, np.inf])
def test_a_capsule_without_thickness_is_refused(thickness):
    with pytest.raises(ValueError, match="thickness"):
        Capsule(thickness, STIFF)


def test_a_cover_on_a_half_space_goes_from_hertz_to_a_surface_that_cannot_slide():
    """kappa to 0: 1.  kappa to infinity: w = p (1 - nu) (1 - delta)/(mu k), Hertz with E*/(1 - delta)."""
    delta = (0.4 / 0.9) ** 2
    assert stiffening(0.1, 1e-4, 1.0) == pytest.approx((1.0, 1.0), abs=1e-3)
    assert stiffening(0.1, 1e5, 1.0) == pytest.approx((1.0, 1.0 / (1.0 - delta)), rel=1e-4)
    rising = [stiffening(0.1, k, 1.0)[1] for k in (0.01, 0.1, 1.0, 10.0, 100.0)]
    assert (np.diff(rising) > 0.0).all()
    assert [stiffening(0.5, k, 1.0)[1] for k in (0.1, 10.0)] == pytest.approx([1.0, 1.0], rel=1e-12)


@pytest.fixture(scope="module")
def bare():
    return block_organ((0.06, 0.06, 0.03), (6, 6, 3), {0: SOFT})


def pressed(organ, depth=1e-3):
    """Site, contact and equilibrium."""
    site = open_site(organ, np.array([2e-3, 1e-3, 0.0]), TOOL, patch_size(TOOL, 1.5e-3, radius=0.012))
    contact = Unilateral(site.surface, TOOL, 8e3 * site.youngs_modulus)
    return site, contact, at(site, contact, depth, np.zeros_like(site.body.nodes))


def at(site, contact, depth, start):
    contact.pose = Pose(site.contact_point + (TOOL.radius - depth) * site.normal, np.eye(3))
    return equilibrate(site.body, contact, start, 1e-10, 1e-6)


def test_force_rises_with_the_capsule_and_a_thin_one_is_none(bare):
    organs = [bare, *(replace(bare, capsule=Capsule(t, STIFF)) for t in (1e-9, 3e-5, 3e-4))]
    force = [pressed(organ)[2].contact.force[2] for organ in organs]
    assert force[1] == pytest.approx(force[0], rel=1e-5)
    assert force[1] < 0.98 * force[2] < 0.98**2 * force[3]


def test_under_a_capsule_force_is_the_energy_s_slope_and_the_supports_answer(bare):
    """Without multipliers the total W + Pi_c is a potential of the depth: its slope is the force."""
    site, contact, found = pressed(replace(bare, capsule=Capsule(2e-4, STIFF)))
    force = found.contact.force
    reaction = site.body.support_reaction(found.u, found.elastic)
    about_origin = found.contact.moment + np.cross(contact.pose.position, force)
    assert reaction[:3] == pytest.approx(force, abs=1e-8 * np.linalg.norm(force))
    assert reaction[3:] == pytest.approx(about_origin, abs=1e-8 * np.linalg.norm(force) * 0.06)
    h = 1e-5
    moved = [at(site, contact, 1e-3 + s * h, found.u) for s in (-1, 1)]
    total = [m.elastic.energy + m.contact.energy for m in moved]
    assert (total[1] - total[0]) / (2 * h) == pytest.approx(force[2], rel=2e-4)


def test_the_capsule_covers_patch_and_far_field_once(bare):
    """Patch and far field share their border's edges, not its faces."""
    covered = replace(bare, capsule=Capsule(2e-4, STIFF))
    site = open_site(
        covered, np.array([2e-3, 1e-3, 0.0]), TOOL, patch_size(TOOL, 1.5e-3, radius=0.012), "full"
    )
    area = 2 * 0.06 * 0.06 + 4 * 0.06 * 0.03
    assert site.body.tissue.capsule.area.sum() == pytest.approx(area, rel=1e-9)
    skin = Membrane(covered.space.nodes, covered.surface_of(~site.patch.carved), covered.capsule)
    assert site.body.patch_tissue.capsule.area.sum() + skin.area.sum() == pytest.approx(area, rel=1e-9)


@pytest.mark.slow
def test_a_sphere_on_a_covered_half_space():
    for row in covered_rows():
        assert row.met, f"{row.name}: error {row.error:.1e}, bar {row.bar:.0e}"
