# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A press that failed near a node is marked where it failed: in the field, the asset, its report and `inspect`.

The presses are a known organ's (known_organ.py); which of them fail is decided here.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from known_organ import DEPTH, RADIUS, KnownOrgan, geometry_of
from pxr import Sdf, Usd, UsdGeom
from test_report import organ_geometry

from palpate.author import field_stage
from palpate.author.command_line import main
from palpate.author.report import write_report
from palpate.author.tool_stage import ToolShape, reference_of, shape_of_reference
from palpate.fields.cook import write_rfield
from palpate.fields.field_error import FieldError
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
from palpate.fields.usd_write import write_asset

ORGAN = KnownOrgan()
REASON = "Newton did not converge at 2.5 mm"
BALL = ToolShape("sphere", (("radius", RADIUS),))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The field of 12 presses, two of which failed: one before it began, one half way down; and its asset."""
    rng = np.random.default_rng(2)
    places = ORGAN.cap_points(12, rng)

    def outcome(i):
        job = SimpleNamespace(contact_point=tuple(map(float, places[i])))
        return SimpleNamespace(job=job, key=f"{i:02d}" * 32, index=i)

    def press_arrays(scene, tool, outcome, mesh):
        press = replace(ORGAN.press(places[outcome.index], rng), hash=outcome.key)
        if outcome.index == 3:
            return None, "the patch has no good mesh"
        if outcome.index == 7:
            short = replace(press, depth=press.depth[:7], force=press.force[:7], energy=press.energy[:7])
            return replace(short, lateral=press.lateral[:1]), REASON
        return press, ""

    samples = SimpleNamespace(beyond=lambda mesh: ORGAN.reach)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(field_stage, "press_arrays", press_arrays)
        patch.setattr(
            field_stage, "knots_of", lambda scene, tool, presses: field_stage.uniform_knots(DEPTH, 13)
        )
        patch.setattr(field_stage, "shape_of", lambda scene, tool: BALL)
        patch.setattr(field_stage, "band_of_tool", lambda scene, tool: geometry_of(ORGAN).band)
        field, failures = field_stage.field_of(
            None, SimpleNamespace(name="ball"), None, samples, geometry_of(ORGAN), [outcome(i) for i in range(12)], {}
        )  # fmt: skip
    folder = tmp_path_factory.mktemp("failed") / "asset"
    asset = write_asset(folder, organ_geometry(), field)
    write_rfield(field, folder / "ball.rfield")
    return places, field, failures, asset


def test_the_field_remembers_where_and_why(made):
    places, field, failures, _ = made
    assert field.provenance["failed_presses"] == failures
    assert [one["reason"] for one in failures] == ["the patch has no good mesh", REASON]
    np.testing.assert_array_equal([one["contact_point"] for one in failures], places[[3, 7]])


def test_a_press_that_never_began_is_no_node_and_a_short_one_is_marked_as_far_as_it_came(made):
    places, _, _, asset = made
    nodes = read_field(asset, "ball").nodes
    assert nodes.node_count == 11
    gap = np.linalg.norm(nodes.position - places[3], axis=1).min()
    assert gap > 1e-3
    short = int(np.argmin(np.linalg.norm(nodes.position - places[7], axis=1)))
    assert nodes.depth_reached[short] == pytest.approx(0.6 * DEPTH)
    assert (np.delete(nodes.depth_reached, short) > 0.99 * DEPTH).all()


def test_the_asset_shows_them_as_points_that_any_host_can_read(made):
    places, _, _, asset = made
    stage = Usd.Stage.Open(str(asset))
    prim = stage.GetPrimAtPath("/ellipsoid/Response/FailedPresses")
    np.testing.assert_allclose(
        np.array(UsdGeom.Points(prim).GetPointsAttr().Get()), places[[3, 7]], atol=1e-8
    )
    reasons = UsdGeom.PrimvarsAPI(prim).GetPrimvar("palpate:failed:reason").Get()
    assert list(reasons) == ["the patch has no good mesh", REASON]
    assert asset_errors(asset) == []


def test_inspect_names_them(made, capfd):
    *_, asset = made
    assert main(["inspect", str(asset.parent), "--json"]) == 0
    (tool,) = json.loads(capfd.readouterr().out)["tools"]
    assert len(tool["failed_presses"]) == 2 and tool["extrapolated"] == 1
    assert main(["inspect", str(asset.parent)]) == 0
    told = capfd.readouterr().out
    assert REASON in told and "1 nodes are extrapolated" in told


def test_the_report_names_them_when_it_is_written_from_the_asset_alone(made, tmp_path, monkeypatch):
    *_, asset = made
    copy = shutil.copytree(asset.parent, tmp_path / "copy")
    monkeypatch.setattr("palpate.author.report.render.sys.executable", shutil.which("false"))
    page = write_report(copy, {}).read_text(encoding="utf-8")
    report = json.loads((copy / "report" / "report.json").read_text())
    assert [one["reason"] for one in report["tools"][0]["failures"]] == ["the patch has no good mesh", REASON]
    assert REASON in page and report["tools"][0]["nodes"]["extrapolated"] == 1


def test_a_tool_whose_hash_is_not_the_field_s_is_refused_by_name(made, tmp_path):
    *_, asset = made
    reference = reference_of("ball", BALL)
    assert shape_of_reference(reference) == BALL
    larger = replace(reference, parameters={"radius": 2 * RADIUS})
    with pytest.raises(
        FieldError, match=r"tool 'ball'.* hash to \w{12}, but the field was pressed with \w{12}"
    ):
        shape_of_reference(larger)
    copy = shutil.copytree(asset.parent, tmp_path / "copy")
    layer = Sdf.Layer.OpenAsAnonymous(str(copy / "fields" / "ball.usdc"))
    layer.GetAttributeAtPath("/ellipsoid/Response.palpate:tool:parameterValues").default = [2 * RADIUS]
    layer.Export(str(copy / "fields" / "ball.usdc"))
    with pytest.raises(FieldError, match="authored again, is right"):
        shape_of_reference(read_field(copy, "ball").tool)


def test_a_cooked_field_of_another_tool_is_found_beside_its_asset(made, tmp_path, capfd):
    _, field, _, asset = made
    copy = shutil.copytree(asset.parent, tmp_path / "copy")
    other = replace(field, tool=replace(field.tool, hash="12" * 32))
    write_rfield(other, copy / "ball.rfield")
    assert main(["inspect", str(copy)]) == 2
    told = capfd.readouterr().err
    assert "ball.rfield" in told and "another tool than the asset's" in told and "palpate cook" in told
