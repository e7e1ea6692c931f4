# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What people are shown of a press is what was solved: displacements, volumes, pressures, all on the patch's nodes."""

import numpy as np
import pytest

from palpate.fem_offline.deformed import deformation_gradients, deformed_patch, nodal_pressure
from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.press import press
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ

R, DEPTHS = 5e-3, np.array([0.5e-3, 1.0e-3])
CONTACT = np.array([1e-3, 2e-3, 0.0])


@pytest.fixture(scope="module", params=["near_field", "full"])
def pressed(request):
    """(site, record, what was watched) of a short press."""
    organ = block_organ((0.06, 0.06, 0.03), (6, 6, 3), {0: NeoHookean(5400.0, 0.48)})
    tool = Sphere(R)
    site = open_site(organ, CONTACT, tool, patch_size(tool, DEPTHS[-1], radius=0.012), request.param)
    seen = []
    record = press(site, tool, DEPTHS, watch=lambda depth, found: seen.append((depth, found)))
    return site, record, seen


def test_every_recorded_state_is_seen(pressed):
    _, record, seen = pressed
    assert [depth for depth, _ in seen] == list(record.depth[1:])
    assert [found.elastic.energy for _, found in seen] == list(record.energy[1:])


def test_the_surface_under_the_tool_lies_on_the_tool(pressed):
    site, _, seen = pressed
    depth, found = seen[-1]
    patch = deformed_patch(site, found.u, found.contact.traction)
    touched = np.flatnonzero(patch.pressure > 0.5 * patch.pressure.max())
    position = site.contact_point + (R - depth) * site.normal
    gap = np.linalg.norm(patch.nodes[touched] + patch.displacement[touched] - position, axis=1) - R
    assert len(touched) > 5
    assert np.abs(gap).max() < 0.03 * depth


def test_pressure_over_the_surface_is_what_the_tool_exerts(pressed):
    """Carried to nodes and integrated by another rule, so nearly; the force is less, as pressure leans inwards."""
    site, record, seen = pressed
    _, found = seen[-1]
    patch = deformed_patch(site, found.u, found.contact.traction)
    x = patch.nodes[patch.faces[:, :3]]
    area = 0.5 * np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1)
    total = float(area @ patch.pressure[patch.faces[:, 3:]].mean(axis=1))
    exerted = float(np.sum(site.surface.weight * np.linalg.norm(found.contact.traction, axis=2)))
    assert total == pytest.approx(exerted, rel=0.02)
    assert 0.9 < record.force[-1] / exerted < 1.0
    assert (patch.pressure >= 0.0).all()
    assert patch.pressure[np.linalg.norm(patch.nodes - site.contact_point, axis=1) > 2.0 * R].max() == 0.0


def test_nearly_incompressible_tissue_keeps_its_volume(pressed):
    site, _, seen = pressed
    patch = deformed_patch(site, seen[-1][1].u, seen[-1][1].contact.traction)
    assert patch.volume_ratio == pytest.approx(1.0, abs=0.1)
    assert len(patch.volume_ratio) == len(patch.tets) == len(patch.label)
    assert len(patch.displacement) == len(patch.nodes) == len(patch.pressure)


def test_a_linear_displacement_has_its_own_gradient():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    space = quadratic_space(points, np.array([[0, 1, 2, 3]]))
    G = np.array([[0.1, 0.2, 0.0], [0.0, -0.1, 0.3], [0.05, 0.0, 0.2]])
    F = deformation_gradients(space.corner_gradients, (space.nodes @ G.T)[space.elements])
    assert F[0] == pytest.approx(np.eye(3) + G, abs=1e-14)


def test_constant_traction_is_constant_at_the_nodes(pressed):
    site, _, _ = pressed
    traction = np.broadcast_to([0.0, 0.0, -7.0], (*site.surface.point_shape, 3))
    pressure = nodal_pressure(site.surface, traction, len(site.body.nodes))
    assert pressure[np.unique(site.surface.faces)] == pytest.approx(7.0)
