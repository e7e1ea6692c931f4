# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Devices held against a field: the bounds, and the hum where they are broken."""

import json

import numpy as np
import pytest
import synthetic_field

from palpate.author.certify import FORCE_FLOOR, certify
from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.fields.cook import cook
from palpate.runtime import Field


@pytest.fixture(scope="module")
def field(tmp_path_factory):
    path = tmp_path_factory.mktemp("certify") / "plane.rfield"
    path.write_bytes(cook(synthetic_field.FIELDS["plane"]()))
    return path


@pytest.mark.parametrize("delay", [0.0, 5e-4])
def test_the_bound_is_stiffness_times_half_a_period_and_the_delay(field, delay):
    sigma = Field.open(field).info.stiffness_max
    bound = sigma * (0.5e-3 + delay)
    just, short = (certify(field, rate=1000, damping=x * bound, delay=delay) for x in (1.001, 0.999))
    assert just["met"] and just["sampling_share"] == 1.0 and not short["met"]
    assert just["damping_needed"] == pytest.approx(bound)


def test_the_rate_that_is_named_is_enough_and_a_slower_one_is_not(field):
    needed = certify(field, rate=1000, damping=0.05, delay=1e-5)["rate_needed"]
    assert certify(field, rate=1.001 * needed, damping=0.05, delay=1e-5)["met"]
    short = certify(field, rate=0.999 * needed, damping=0.05, delay=1e-5)
    assert not short["met"] and "kHz" in short["sentence"]


def test_no_rate_helps_against_too_long_a_delay(field):
    result = certify(field, rate=1000, damping=0.05, delay=5e-4)
    assert result["rate_needed"] is None and "less delay" in result["sentence"] and not result["met"]


def test_coarse_encoders_need_dry_friction(field):
    sigma = Field.open(field).info.stiffness_max
    short = certify(field, rate=1000, damping=100.0, quantum=1e-4, dry_friction=0.3e-4 * sigma)
    assert not short["met"] and 0.0 < short["sampling_share"] < 1.0 and "dry friction" in short["sentence"]
    assert certify(field, rate=1000, damping=100.0, quantum=1e-4, dry_friction=0.51e-4 * sigma)["met"]


def test_the_share_grows_with_the_damping(field):
    shares = [certify(field, rate=1000, damping=b)["sampling_share"] for b in (0.0, 0.05, 0.2, 1e3)]
    assert shares == sorted(shares) and shares[0] == 0.0 < shares[1] < shares[2] <= shares[3] == 1.0


@pytest.mark.parametrize("delay", [0.0, 1e-3])
def test_simulated_devices_hum_below_the_bound_and_rest_above(field, delay):
    rows = certify(field, rate=250, damping=0.5, delay=delay, simulate=True)["simulated"]
    assert {round(row["damping_over_bound"], 9) for row in rows} > {0.7, 1.5, 3.0}
    for row in rows:
        if row["damping_over_bound"] <= 0.7:
            assert not row["rests"] and row["speed_late"] > row["speed_early"] > 1e-3, row
        if row["damping_over_bound"] >= 1.5:
            assert row["rests"], row


def test_the_command_prints_one_json_object_and_its_exit_code_is_the_verdict(field, capsys):
    assert main(["certify", str(field), "--rate", "1000", "--damping", "0.01", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["met"] is False
    assert main(["certify", str(field), "--rate", "1000", "--damping", "100"]) == 0
    assert "Nothing that this device renders" in capsys.readouterr().out


NUMBERS = """
[device]
damping = "0.2 N s/m"
friction = "0.05 N"
resolution = 2e-5
max_force = "0.3 N"
rate = "4 kHz"
"""


def certified(capsys, *arguments) -> dict:
    assert main(["certify", *map(str, arguments), "--json"]) in (0, 1)
    return json.loads(capsys.readouterr().out)


def test_a_scenes_device_is_certified_as_if_its_numbers_were_options(field, write_scene, capsys):
    scene = write_scene(NUMBERS)
    options = "--rate 4000 --damping 0.2 --dry-friction 0.05 --quantum 2e-5".split()
    by_scene, by_options = certified(capsys, field, "--scene", scene), certified(capsys, field, *options)
    assert by_scene["device"] == by_options["device"] | {"max_force": 0.3} and by_scene["rate"] == 4000.0
    assert by_scene["device"]["assumed"] == ["no computation delay (--delay)"]
    for key in ("met", "rate_needed", "damping_needed", "dry_friction_needed", "sampling_share", "sentence"):
        assert by_scene[key] == by_options[key]
    assert by_options["force_share"] is None and 0.0 < by_scene["force_share"] < 1.0
    with_force = certified(capsys, field, *options, "--max-force", "0.3")
    assert with_force["force_share"] == by_scene["force_share"]


def test_an_option_replaces_the_scenes_number(field, write_scene, capsys):
    device = certified(capsys, field, "--scene", write_scene(NUMBERS), "--damping", 0.7, "--delay", "1e-5")[
        "device"
    ]
    assert (device["damping"], device["delay"], device["friction"]) == (0.7, 1e-5, 0.05)
    assert device["assumed"] == []


def test_a_device_without_a_profile_is_refused_by_name_and_with_a_damping_is_certified(
    field, write_scene, capsys
):
    scene = write_scene('[device]\nprofile = "our own"\nrate = "2 kHz"\n')
    assert main(["certify", str(field), "--scene", str(scene)]) == 2
    told = capsys.readouterr().err
    assert '"our own"' in told and "--damping in N s/m" in told and "not guessed" in told
    result = certified(capsys, field, "--scene", scene, "--damping", 0.5)
    assert (result["device"]["name"], result["rate"]) == ("our own", 2000.0)
    assert len(result["device"]["assumed"]) == 3


def test_a_profile_s_damping_is_what_its_published_stiffness_asks_and_says_so(field, write_scene, capsys):
    scene = write_scene('[device]\nprofile = "Omega.6"\nrate = "2 kHz"\n')
    by_scene = certified(capsys, field, "--scene", scene)["device"]
    by_name = certified(capsys, field, "--device", "omega.6", "--rate", 2000)["device"]
    assert (by_scene["damping"], by_scene["max_force"]) == (2.5, 12.0)  # 5000 N/m held for 1 ms
    assert by_name | {"name": "Omega.6"} == by_scene
    assert "5000 N/m that CHAI3D allows omega.6 were steady at 1 kHz" in by_scene["assumed"][0]
    measured = certified(capsys, field, "--device", "omega.6", "--rate", 2000, "--damping", 0.5)["device"]
    assert measured["damping"] == 0.5 and "CHAI3D" not in str(measured["assumed"])


def test_a_weaker_device_needs_a_faster_loop(field, capsys):
    needed = [
        certified(capsys, field, "--device", name, "--rate", 1000)["rate_needed"]
        for name in ("omega.3", "Falcon", "PHANTOM Omni", "Touch")
    ]
    assert needed == sorted(needed) and needed[-1] == pytest.approx(12.5 * needed[0])


def test_a_device_that_nobody_knows_is_refused_with_those_that_are_known(field, capsys):
    assert main(["certify", str(field), "--device", "omega.9", "--rate", "1000"]) == 2
    told = capsys.readouterr().err
    assert "omega.9" in told and "omega.3" in told and "Touch" in told


def test_a_scene_without_a_device_and_no_device_at_all_are_told_apart(field, write_scene, capsys):
    assert main(["certify", str(field), "--scene", str(write_scene())]) == 2
    assert "a table [device], or no --scene" in capsys.readouterr().err
    assert main(["certify", str(field)]) == 2
    told = capsys.readouterr().err
    assert "--damping" in told and "--rate" in told and "--scene" in told


def test_friction_hides_an_axial_responses_gain_where_it_exceeds_the_push_along_the_surface(field):
    result = certify(field, rate=1000, damping=0.1)
    assert 0.0 < result["sliding_share"] < 1.0 and result["friction_needed"] > 0.1  # the field's own mu
    opened = Field.open(field)
    flat = opened.sample([[-4e-3, 0.0, 3e-3]])[0]  # before the step: no push
    assert abs(flat["force"][0]) < 1e-9
    edge = opened.sample([[1.5e-3, 0.0, 1e-3]])[0]
    assert edge["normal_force"] > result["sliding_floor"]
    assert abs(edge["force"][0]) / edge["normal_force"] <= result["friction_needed"] * 1.05
    worst = opened.sample([result["friction_needed_at"]])[0]
    along = worst["force"] - (worst["force"] @ worst["normal"]) * worst["normal"]
    assert np.linalg.norm(along) / worst["normal_force"] == pytest.approx(result["friction_needed"])


def test_sliding_is_judged_above_a_share_of_the_deepest_force_as_held_out_errors_are(tmp_path, monkeypatch):
    from palpate.author.held_out import FLOOR

    assert FORCE_FLOOR == FLOOR
    path = tmp_path / "fading.rfield"  # |t| / f_n has no bound where the field ends
    path.write_bytes(cook(synthetic_field.synthetic_field(amplitude=lambda q: synthetic_field.step(q, 1e-9))))
    judged = certify(path, rate=1000, damping=0.1)
    monkeypatch.setattr("palpate.author.certify.FORCE_FLOOR", 0.0)
    everywhere = certify(path, rate=1000, damping=0.1)
    assert everywhere["sliding_judged"] == 1.0 > judged["sliding_judged"] > 0.3
    assert everywhere["friction_needed"] > 20.0 > 5.0 > judged["friction_needed"]
    assert everywhere["sampling_share"] == judged["sampling_share"]


@pytest.mark.parametrize(
    "wrong", [{"max_force": 0}, {"rate": 0}, {"damping": -1}, {"mass": 0}, {"delay": float("nan")}]
)
def test_a_device_that_cannot_be_is_refused(field, wrong):
    with pytest.raises(InputError, match=next(iter(wrong)).replace("_", "-")):
        certify(field, **({"rate": 1000, "damping": 0.1} | wrong))


def test_an_asset_s_folder_is_told_which_of_its_files_is_meant(field):
    with pytest.raises(InputError, match=r"is a folder; expected an \.rfield, such as .*plane\.rfield"):
        certify(field.parent, rate=1000, damping=0.1)
    with pytest.raises(InputError, match=r"does not exist; expected an \.rfield"):
        certify(field.parent / "none.rfield", rate=1000, damping=0.1)


def test_a_field_that_nothing_touches_gets_no_verdict(field, monkeypatch):
    monkeypatch.setattr("palpate.author.certify.PLACES", 1)  # the one place drawn lies outside contact
    with pytest.raises(InputError, match="none of 1 places in contact"):
        certify(field, rate=1000, damping=100.0)
