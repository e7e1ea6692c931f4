# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A device's certificate as a map: which places hum, on a surface that the field itself knows."""

import json

import numpy as np
import pytest
import synthetic_field
from matplotlib.image import imread

from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.haptic_device import HapticDevice
from palpate.author.report.device_map import device_map, stiffness_allowed
from palpate.author.report.known_surface import known_surface
from palpate.author.report.maps import reach_map
from palpate.fields.cook import cook
from palpate.fields.interpolation import evaluate
from palpate.fields.largest_stiffness import largest_stiffness
from palpate.fields.rfield_read import read_rfield


@pytest.fixture(scope="module")
def data():
    return cook(synthetic_field.FIELDS["plane"]())  # soft for x < 0, six times as stiff for x > 5 mm


@pytest.fixture(scope="module")
def field(data):
    return read_rfield(data)


@pytest.fixture(scope="module")
def reach(field):
    return reach_map(known_surface(field), field)


def device(allowed: float) -> HapticDevice:
    return HapticDevice("", rate=1000.0, damping=0.5e-3 * allowed)


def test_the_surface_that_a_field_knows_is_the_organs_and_faces_outward(field, reach):
    organ = known_surface(field)
    assert np.abs(organ.vertices[:, 2]).max() < 2e-6  # the half space z < 0; 1 um a count
    a, b, c = (organ.vertices[organ.triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()
    assert len(organ.reach_triangles) and reach.unstored_share == 0.0
    assert np.abs(reach.feet[:, 2]).max() < 2e-6


def test_a_ball_organ_is_known_from_all_round():
    field = synthetic_field.synthetic_field(
        synthetic_field.ball(20e-3), lambda q: np.ones(q.shape[:-1]), (-30e-3,) * 3, (30e-3,) * 3
    )
    organ = known_surface(field)
    radius = np.linalg.norm(organ.vertices, axis=1)
    assert np.abs(radius - 20e-3).max() < 0.1e-3
    centre = organ.vertices[organ.triangles].mean(axis=1)
    assert centre.min(axis=0).max() < -15e-3 and centre.max(axis=0).min() > 15e-3


def test_the_largest_stiffness_of_a_place_is_between_its_own_slope_and_the_field_s_largest(field, reach):
    sigma = device_map([field], reach, device(100.0)).sigma
    along_normal = (reach.values["stiffness"] + reach.values["sticking_stiffness"]).max(axis=0)
    assert (sigma >= 0.99 * along_normal).all() and sigma.max() <= largest_stiffness(field)
    q = reach.feet + (field.tool.offset - reach.depths[-1]) * reach.normals
    assert (sigma >= evaluate(field, q).friction_stiffness).all()


def test_the_border_is_where_the_device_takes_no_more(field, reach):
    sigma = device_map([field], reach, device(100.0)).sigma
    soft, stiff = sigma[reach.vertices[:, 0] < -2e-3], sigma[reach.vertices[:, 0] > 7e-3]
    assert soft.max() < 0.5 * stiff.min()
    made = device_map([field], reach, device(0.5 * (soft.max() + stiff.min())))
    assert 0.3 < made.share < 0.8
    hums = made.sigma > made.allowed
    assert not hums[reach.vertices[:, 0] < -2e-3].any() and hums[reach.vertices[:, 0] > 7e-3].all()
    largest = largest_stiffness(field)
    assert device_map([field], reach, device(largest)).share == 1.0
    assert device_map([field], reach, device(0.0)).share < 0.05


def test_encoders_limit_the_stiffness_as_damping_does():
    assert stiffness_allowed(HapticDevice("", rate=500.0, damping=0.3, delay=1e-3)) == pytest.approx(150.0)
    coarse = HapticDevice("", rate=500.0, damping=0.3, resolution=1e-4, friction=0.002)
    assert stiffness_allowed(coarse) == pytest.approx(40.0)


def test_the_command_draws_green_and_red_where_they_belong(data, tmp_path, capsys, can_draw):
    path, picture = tmp_path / "plane.rfield", tmp_path / "map.png"
    path.write_bytes(data)
    arguments = ["certify", str(path), "--rate", "1000", "--damping", "0.25", "--map", str(picture), "--json"]
    assert main(arguments) == 1
    drawn = json.loads(capsys.readouterr().out)["map"]
    assert drawn["stiffness_allowed"] == pytest.approx(500.0) and 0.2 < drawn["share"] < 0.8
    red, green, _ = np.moveaxis(imread(picture)[120:900, 50:1150, :3], 2, 0)
    hums, steady = (red > 1.5 * green) & (red > 0.2), (green > 1.05 * red) & (green > 0.4)
    assert hums.mean() > 0.03 and steady.mean() > 0.03
    columns = np.arange(hums.shape[1])
    middle = [np.average(columns, weights=mask.mean(axis=0)) for mask in (steady, hums)]
    assert middle[0] < middle[1] - 100  # x to the right: soft and green on the left


@pytest.mark.parametrize("name", ["map.pdf", "nowhere/map.png"])
def test_a_map_that_cannot_be_written_is_refused_by_name(data, tmp_path, name):
    from palpate.author.certify_map import certify_map

    path = tmp_path / "plane.rfield"
    path.write_bytes(data)
    with pytest.raises(InputError, match="--map"):
        certify_map(path, device(100.0), tmp_path / name)
