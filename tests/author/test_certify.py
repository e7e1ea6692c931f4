# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Devices held against a field: the bounds, and the hum where they are broken."""

import json

import pytest
import synthetic_field

from palpate.author.certify import certify
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
    assert just["met"] and just["share"] == 1.0 and not short["met"]
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
    assert not short["met"] and 0.0 < short["share"] < 1.0 and "dry friction" in short["sentence"]
    assert certify(field, rate=1000, damping=100.0, quantum=1e-4, dry_friction=0.51e-4 * sigma)["met"]


def test_the_share_grows_with_the_damping(field):
    shares = [certify(field, rate=1000, damping=b)["share"] for b in (0.0, 0.05, 0.2, 1e3)]
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
    assert "without adding energy" in capsys.readouterr().out


@pytest.mark.parametrize("wrong", [{"rate": 0}, {"damping": -1}, {"mass": 0}, {"delay": float("nan")}])
def test_a_device_that_cannot_be_is_refused(field, wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        certify(field, **({"rate": 1000, "damping": 0.1} | wrong))
