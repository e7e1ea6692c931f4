# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A drag at constant speed has its line at k v, is drawn, and is refused by name where there is none."""

import dataclasses
import json

import numpy as np
import pytest
from PIL import Image
from synthetic_field import ball, small_plane, synthetic_field
from typer.testing import CliRunner

from palpate.author.command_line import app
from palpate.author.report.texture_part import draw_texture, texture_row
from palpate.author.texture.drag import drag
from palpate.fields.cook import cook
from palpate.fields.texture import DeviceLimits, Texture, grating
from palpate.fields.texture_layout import texture_bytes


def textured(field, wavelength: float, direction=(1.0, 0.0, 0.0), limits: DeviceLimits | None = None):
    texture = Texture((grating(20e-6, 1.0 / wavelength, direction),), 0.2e-3, 300.0, limits or DeviceLimits())
    return dataclasses.replace(field, layers={"texture": texture_bytes(texture)})


@pytest.mark.parametrize(("wavelength", "direction"), [(0.8e-3, (1, 0, 0)), (0.5e-3, (0.6, 0.8, 0.0))])
def test_the_line_is_at_k_v_on_a_plane(wavelength, direction):
    dragged = drag(cook(textured(small_plane(), wavelength, direction)))
    assert dragged is not None and dragged.expected == pytest.approx(20e-3 / wavelength)
    assert dragged.line == pytest.approx(dragged.expected, rel=0.01)


def test_the_line_is_at_k_v_around_a_ball():
    edge = 24e-3
    organ = synthetic_field(
        ball(12e-3), low=(-edge,) * 3, high=(edge,) * 3, geometry_spacing=3e-3, amplitude_spacing=6e-3
    )
    dragged = drag(cook(textured(organ, 1e-3)))
    assert dragged is not None
    assert dragged.line == pytest.approx(dragged.expected, rel=0.01)


def test_the_speed_stays_below_what_the_limits_fade():
    limits = DeviceLimits(structural_frequency=10.0)  # Hz
    dragged = drag(cook(textured(small_plane(), 0.8e-3, limits=limits)))
    assert dragged is not None and dragged.expected == pytest.approx(5.0)
    assert dragged.line == pytest.approx(5.0, rel=0.01)
    assert np.ptp(dragged.force - dragged.plain) > 1e-3


def test_the_report_tells_and_draws_it(tmp_path):
    field = textured(small_plane(), 0.8e-3)
    row = texture_row(field)
    assert row is not None and row["wavelength"] == pytest.approx([0.8e-3, 0.8e-3])
    (picture,) = draw_texture(tmp_path, field, row, "")
    assert picture["file"] == row["picture"] == "texture.png"
    assert row["drag"]["line"] == pytest.approx(row["drag"]["expected"], rel=0.01)
    with Image.open(tmp_path / "texture.png") as drawn:
        assert np.asarray(drawn.convert("RGB")).std() > 10.0
    assert texture_row(small_plane()) is None


def test_certify_draws_it_or_says_that_there_is_none(tmp_path):
    for name, field in (("plain", small_plane()), ("textured", textured(small_plane(), 0.8e-3))):
        (tmp_path / f"{name}.rfield").write_bytes(cook(field))
    asked = ["--damping", "5", "--rate", "4000", "--json", "--drag", str(tmp_path / "drag.png")]
    made = CliRunner().invoke(app, ["certify", str(tmp_path / "textured.rfield"), *asked])
    told = json.loads(made.stdout)["texture"]["drag"]
    assert abs(told["line_error"]) < 0.01 and (tmp_path / "drag.png").is_file()
    (judged,) = json.loads(made.stdout)["texture"]["waves"]
    assert judged["force"] == pytest.approx(
        20e-6 * 300.0
    )  # along the normal: this field knows no normal force
    textured_file = str(tmp_path / "textured.rfield")
    under = CliRunner().invoke(app, ["certify", textured_file, *asked[:-2], "--normal-force", "0.5"])
    (judged,) = json.loads(under.stdout)["texture"]["waves"]
    assert judged["force"] == pytest.approx(20e-6 * 2.0 * np.pi / 0.8e-3 * 0.5)
    wrong = CliRunner().invoke(app, ["certify", textured_file, *asked, "--normal-force", "-1"])
    assert wrong.exit_code == 2 and "--normal-force" in wrong.output
    refused = CliRunner().invoke(app, ["certify", str(tmp_path / "plain.rfield"), *asked])
    assert refused.exit_code == 2 and "--drag" in refused.output
