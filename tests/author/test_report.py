# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The report of an asset: one offline page whose numbers are those of its JSON twin.

The asset is an ellipsoid whose response is known exactly (known_organ.py): held-out "FEM" forces are that truth,
rendered forces are what the field says, so that the errors in the report are real ones.
"""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from known_organ import DEPTH, RADIUS, KnownOrgan, field_of

from palpate.author.certify import certify
from palpate.author.command_line import main
from palpate.author.console import plain
from palpate.author.device_profiles import PROFILES, profile_named
from palpate.author.haptic_device import HapticDevice
from palpate.author.report import write_report
from palpate.author.report.contents import contents
from palpate.author.report.estimate import ErrorEstimate
from palpate.author.report.gather import gather
from palpate.author.report.maps import reach_map
from palpate.author.report.numbers import percent
from palpate.author.report.on_reach import on_reach
from palpate.author.report.organ_figure import organ_figure
from palpate.fields.cook import write_rfield
from palpate.fields.interpolation import evaluate
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.response_field import ResponseField
from palpate.fields.usd_read import read_field, read_organ
from palpate.fields.usd_write import add_tool, write_asset

ORGAN = KnownOrgan()
TOOL = "ball"
NODES, POINTS, SEED, TOLERANCE, FLOOR = 14, 9, 7, 0.035, 0.05
REASON = "Newton stopped <early> & was not forced on"


def organ_geometry() -> OrganGeometry:
    """The ellipsoid: a sphere's triangles stretched, each with the centre a tet; reach: a cap of 2 cm."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    vertices, triangles = np.asarray(ball.vertices) * ORGAN.semi_axes, np.asarray(ball.faces, np.int32)
    points = np.concatenate([vertices, [[0.0, 0.0, 0.0]]])
    tets = np.concatenate([np.full((len(triangles), 1), len(vertices), np.int32), triangles], axis=1)
    centre = vertices[triangles].mean(axis=1)
    reach = (np.linalg.norm(centre[:, :2], axis=1) < 20e-3) & (centre[:, 2] > 0)
    held = np.flatnonzero(points[:, 2] < -0.02).astype(np.int32)
    return OrganGeometry(
        "ellipsoid", vertices, triangles, points, tets, (Support("below", held),), ("tissue",),
        np.zeros(len(tets), np.int32), np.flatnonzero(reach).astype(np.int32),
        {"model": "neo_hookean", "youngs_modulus": 5.4e3, "poissons_ratio": 0.48},
        provenance={"source": "closed form", "hash": "ab" * 32},
    )  # fmt: skip


def validation(field: ResponseField) -> dict[str, Any]:
    """POINTS presses as author/held_out.py writes them; the last one stopped half way."""
    rng = np.random.default_rng(SEED)
    presses = []
    for number, c in enumerate(ORGAN.cap_points(POINTS, rng, 18e-3)):
        failed = number == POINTS - 1
        n = ORGAN.normal(c[None])[0]
        depth = DEPTH * np.arange(1, 6 if failed else 11) / 10
        q = c + (RADIUS - depth)[:, None] * n
        fem, said = ORGAN.force(q), evaluate(field, q).force
        f = fem @ n
        miss = said - fem
        aside = np.linalg.norm(miss - (miss @ n)[:, None] * n, axis=1) / f
        judged = f >= FLOOR * f[-1]
        moves = [] if failed else [
            {"depth": DEPTH, "move": [1e-3, 0.0, 0.0], "fem_force": fem[-1].tolist(),
             "rendered_force": said[-1].tolist(), "error": 0.01 * (number + 1)}
        ]  # fmt: skip
        presses.append(
            {
                "contact_point": c.tolist(), "normal": n.tolist(), "converged": not failed,
                "reason": REASON if failed else "", "hash": f"{number:02d}" * 32, "fidelity": "full", "seconds": 100.0,
                "depth": depth.tolist(), "fem_force": fem.tolist(), "rendered_force": said.tolist(),
                "force_error": [float(e) if ok else None for e, ok in zip(np.abs(miss @ n) / f, judged, strict=True)],
                "lateral_error": [float(e) if ok else None for e, ok in zip(aside, judged, strict=True)],
                "status": [0] * len(depth), "moves": moves,
            }
        )  # fmt: skip

    def spread(values: list[float | None]) -> dict[str, float]:
        known = [value for value in values if value is not None]
        p50, p95 = np.percentile(known, [50, 95])
        return {"p50": float(p50), "p95": float(p95), "max": max(known)}

    force = spread([e for press in presses for e in press["force_error"]])
    return {
        "tool": TOOL, "seed": SEED, "fidelity": "full", "tolerance": TOLERANCE, "met": False, "floor": FLOOR,
        "points": POINTS, "failed": 1, "seconds": 900.0, "force_error": force,
        "lateral_error": spread([e for press in presses for e in press["lateral_error"]]),
        "stuck_error": spread([move["error"] for press in presses for move in press["moves"]]),
        "far_field_error": {"p50": 0.002, "p95": 0.006, "max": 0.0085}, "presses": presses,
    }  # fmt: skip


SUMMARY = {
    "asset": "ellipsoid",
    "tools": [{"name": TOOL, "rfield": f"{TOOL}.rfield", "bytes": 254_321, "nodes": 40, "presses": 49, "failed": 2}],
    "seconds": 2711.0,
    "cpu_seconds": 5101.5,
    "tolerance_met": False,
    "stages": [{"name": "surface and tetrahedra", "seconds": 95.2}, {"name": "presses", "seconds": 2500.0}],
    "left_out": {"thinner than 15.0 mm": 12},
    "reach": {"places": 900, "pressable": 888, "spacing": 1e-3},
    "failures": [{"tool": TOOL, "contact_point": [0.0, 0.015, 0.0285], "reason": "the patch has no good mesh"}],
    "versions": {"palpate": "0.1.0"},
    "device": dataclasses.asdict(HapticDevice("toy", rate=200.0, damping=0.2, assumed=("no delay (--delay)",))),
    "bench": {
        "stick_ns": {"p50": 184.2, "p99": 210.0, "p999": 333.0, "max": 9001.0}, "free_ns": None, "load_ms": 1.23,
        "bytes": 254_321, "machine": "a test",
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def asset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An asset with its validation and its report."""
    folder = tmp_path_factory.mktemp("report") / "ellipsoid"
    field = field_of(ORGAN, NODES)
    write_asset(folder, organ_geometry(), field)
    (folder / "validation").mkdir()
    (folder / "validation" / f"{TOOL}.json").write_text(json.dumps(validation(field)))
    later = validation(field) | {"seed": 9, "points": 4}
    (folder / "validation" / f"{TOOL}-seed9-4.json").write_text(json.dumps(later))
    write_rfield(read_field(folder, TOOL), folder / f"{TOOL}.rfield")
    origins = {"seed": [field.nodes.press_hash[0]], "error": [field.nodes.press_hash[1]]}
    tools = [SUMMARY["tools"][0] | {"node_origins": origins}]
    write_report(folder, SUMMARY | {"tools": tools})
    return folder


@pytest.fixture(scope="module")
def html(asset: Path) -> str:
    return (asset / "report" / "index.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def report(asset: Path) -> dict[str, Any]:
    """The JSON twin; NaN and infinities are refused."""

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is not JSON")

    return json.loads((asset / "report" / "report.json").read_text(encoding="utf-8"), parse_constant=refuse)


class Page(HTMLParser):
    """Addresses that the page's elements load or lead to, its values by path, and its text outside of values."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.links: list[str] = []
        self.styles = ""
        self.values: list[list[str]] = []  # path, kind, text
        self.text = ""
        self.scripts: list[str] = []
        self._inside = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.loaded += [
            found[key] or "" for key in ("src", "srcset", "data", "poster", "action") if key in found
        ]
        if "href" in found:
            (self.links if tag == "a" else self.loaded).append(found["href"] or "")
        if tag in ("script", "style"):
            self._inside = tag
            if tag == "script":
                self.scripts.append("")
        elif "data-path" in found:
            self._inside = "value"
            self.values.append([found["data-path"] or "", found["data-kind"] or "", ""])

    def handle_endtag(self, tag: str) -> None:
        if tag in ("script", "style", "span"):
            self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside == "style":
            self.styles += data
        elif self._inside == "script":
            self.scripts[-1] += data
        elif self._inside == "value":
            self.values[-1][2] += data
        else:
            self.text += data


def at(report: dict[str, Any], path: str) -> Any:
    found: Any = report
    for key in path.split("/"):
        found = found[int(key)] if isinstance(found, list) else None if found is None else found.get(key)
    return found


def test_page_loads_nothing(asset: Path, html: str) -> None:
    page = Page(html)
    assert [address for address in page.loaded if not address.startswith("data:image/webp;base64,")] == []
    for word in ("@import", "url("):
        assert word not in page.styles
    for link in page.links:
        assert link.startswith("#") or (asset / "report" / link).is_file(), link


def test_plotly_is_embedded_once(html: str) -> None:
    scripts = Page(html).scripts
    assert sum("plotly.js v" in script for script in scripts) == 1
    assert html.count("</script>") == len(scripts)  # no figure closes its script early


def test_verdict_says_what_was_asked_and_reached(html: str, report: dict[str, Any]) -> None:
    error = report["tools"][0]["validation"]["force_error"]
    sentence = report["verdict"]["sentences"][0]
    for part in (
        "asked for 3.5 %",
        percent(error["p95"]),
        percent(error["max"]),
        f"{POINTS} held-out points",
    ):
        assert part in sentence
    assert report["verdict"]["state"] == "missed" and "1 held-out press failed or stopped early" in sentence
    line = report["verdict"]["line"]
    assert line.startswith("Not met: ball") and "\n" not in line
    assert "1 press that build the field and 1 press that judge it failed or stopped early" in line
    assert "12 of 900 sampled places were left out (thinner than 15.0 mm)" in line
    assert [line] == [text for path, _, text in Page(html).values if path == "verdict/line"]
    assert [sentence] == [text for path, _, text in Page(html).values if path == "tools/0/verdict/sentence"]


def test_every_held_out_press_is_in_the_twin(asset: Path, report: dict[str, Any]) -> None:
    stated = json.loads((asset / "validation" / f"{TOOL}.json").read_text())
    tool = report["tools"][0]
    assert tool["validation"] == stated
    assert [row["contact_point"] for row in tool["held_out"]] == [
        p["contact_point"] for p in stated["presses"]
    ]
    for row, press in zip(tool["held_out"], stated["presses"], strict=True):
        assert row["force_error_max"] == max(e for e in press["force_error"] if e is not None)
        fem, n = np.array(press["fem_force"]), np.array(press["normal"])
        lateral = np.linalg.norm(fem - (fem @ n)[:, None] * n, axis=1)
        drawn = np.hypot(row["curves"]["fem"]["along"], row["curves"]["fem"]["across"])
        np.testing.assert_allclose(drawn, lateral, rtol=1e-9, atol=1e-12)


SCALE = {"N s/m": 1, "cm²": 1e4, "%": 100, "mm": 1e3, "µm": 1e6, "N": 1, "N/m": 1, "s": 1, "min": 1 / 60, "h": 1 / 3600,
         "B": 1, "": 1,
         "KiB": 2.0**-10, "MiB": 2.0**-20, "ns": 1, "ms": 1, "Hz": 1}  # fmt: skip


def test_numbers_on_the_page_are_those_of_the_twin(html: str, report: dict[str, Any]) -> None:
    checked = 0
    for path, kind, text in Page(html).values:
        value = at(report, path)
        if value is None:
            assert text == "–", path
        elif kind in ("text", "short"):
            assert text == (str(value) if kind == "text" else value[:12]), path
        elif kind == "mm_vector":
            np.testing.assert_allclose(
                [float(x) for x in text.split(",")], 1e3 * np.array(value), atol=0.0501
            )
        else:
            number, _, unit = text.partition(" ")
            mantissa, _, exponent = number.partition("e")
            places = len(mantissa.partition(".")[2])
            half_unit = 0.5 * 10.0 ** (int(exponent or 0) - places)
            assert abs(float(number) - SCALE[unit] * value) <= half_unit * (1 + 1e-6), (path, text, value)
            checked += 1
    assert checked > 100


def test_no_number_stands_outside_of_the_twin(html: str) -> None:
    assert set(re.findall(r"[0-9.]+ %", Page(html).text)) <= {
        "99 %",
        "99.9 %",
        "1 %",
    }  # column heads, a limit


def test_failures_are_shown_with_their_reason(html: str, report: dict[str, Any]) -> None:
    page = Page(html)
    assert REASON in [text for _, _, text in page.values]  # escaped in the page, or it would have been parsed
    assert "the patch has no good mesh" in [text for _, _, text in page.values]
    assert not report["tools"][0]["held_out"][-1]["converged"]
    assert report["tools"][0]["judged"]["converged"] == POINTS - 1
    assert report["tools"][0]["judged"]["worst_places_missed"] == pytest.approx(0.95 ** (POINTS - 1))


def test_bench_and_sizes_reach_the_page(html: str, report: dict[str, Any]) -> None:
    values = {path: text for path, _, text in Page(html).values}
    assert values["tools/0/bench/stick_ns/p50"] == "184 ns"
    assert values["tools/0/rfield_bytes"] == "248 KiB"
    assert {file["path"] for file in report["files"]} >= {"ellipsoid.usda", "fields/ball.usdc"}


def test_the_page_stays_small(asset: Path) -> None:
    assert (asset / "report" / "index.html").stat().st_size < 8e6


def test_authors_see_maps_and_why_nodes_are_there(html: str, report: dict[str, Any]) -> None:
    maps = json.loads(re.findall(r'id="maps-1">(.*?)</script>', html, re.DOTALL)[0])
    kinds = {quantity["key"]: quantity for quantity in maps["quantities"]}
    assert {"stiffness", "normal_force", "lateral_push", "error"} <= set(kinds)
    assert "friction_coefficient" not in kinds  # 0.1 everywhere is no map, but stated
    assert kinds["error"]["ends"][0] == 0.0 and kinds["error"]["ends"][1] >= 100 * 2 * TOLERANCE
    nodes = report["tools"][0]["nodes"]
    assert sum(one["count"] for one in nodes["why"]) == NODES == len(nodes["rows"])
    assert {one["key"] for one in nodes["why"]} == {"seed", "error", "unknown"}
    assert report["tools"][0]["field"]["friction"]["max"] == pytest.approx(0.1, rel=1e-3)


def test_estimated_errors_are_small_at_nodes_and_judged_by_held_out_ones(
    asset: Path, report: dict[str, Any]
) -> None:
    field = read_field(asset, TOOL)
    estimate = ErrorEstimate(field)
    away = np.array([[0.024, 0.0, ORGAN.semi_axes[2]]])
    at_nodes = estimate.at(field.nodes.position, field.nodes.normal)
    assert at_nodes.max() < estimate.at(ORGAN.foot(away), ORGAN.normal(ORGAN.foot(away)))[0]
    told = report["tools"][0]["estimate"]
    rows = [row for row in report["tools"][0]["held_out"] if row["force_error_max"] is not None]
    below = [row["force_error_max"] <= row["estimate"] for row in rows]
    assert told["held_out_below"] == np.mean(below) and told["held_out"] == len(rows)


def test_engineers_see_every_device_as_certify_judges_it(asset: Path, report: dict[str, Any]) -> None:
    tool = report["tools"][0]
    assert [row["name"] for row in tool["devices"]] == [profile.name for profile in PROFILES]
    for row in (tool["devices"][0], tool["devices"][8]):
        damping = profile_named(row["name"]).damping
        said = certify(asset / f"{TOOL}.rfield", rate=1000.0, damping=damping)
        assert row["rate_needed"] == pytest.approx(said["rate_needed"], rel=1e-6)
        assert row["met"] == said["met"]


def test_engineers_see_bytes_and_limits(asset: Path, report: dict[str, Any]) -> None:
    tool = report["tools"][0]
    assert sum(row["bytes"] for row in tool["sections"]) == (asset / f"{TOOL}.rfield").stat().st_size
    limits = {row["name"]: row for row in tool["limits"]}
    assert (
        limits["Tick in contact, sticking, median"]["state"] == "beyond"
    )  # 184.2 ns where 180 are asked for
    assert limits["Tick in contact, sticking, 99.9th percentile"]["state"] == "within"
    assert limits["Tick in free space, median"]["state"] == "unknown"  # None was measured
    assert limits["Cooked file"]["state"] == "within"


def test_validators_see_protocol_worst_points_and_later_presses(html: str, report: dict[str, Any]) -> None:
    tool = report["tools"][0]
    assert "just-noticeable difference; measured at 2.5 to 10 N" in html and "They never become nodes" in html
    errors = [tool["held_out"][i]["force_error_max"] for i in tool["worst"]]
    assert errors == sorted(errors, reverse=True) and len(errors) == min(10, POINTS)
    assert [one["record"] for one in tool["fresh"]] == [f"{TOOL}-seed9-4.json"]
    pooled = [e for row in tool["validation"]["presses"] for e in row["force_error"] if e is not None]
    assert tool["judged"]["noticeable_share"] == np.mean(np.array(pooled) > 0.07)


def test_a_report_is_written_anew_from_what_is_kept(
    asset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = Path(shutil.copytree(asset, tmp_path / "copy"))
    monkeypatch.setattr("palpate.author.report.render.sys.executable", shutil.which("false"))
    (copy / "summary.json").write_text(json.dumps(SUMMARY))
    row = {"name": "Hertz", "reference": "half space", "value": 1.01, "error": 0.01, "bar": 0.03, "met": True}
    table = tmp_path / "verification.json"
    table.write_text(json.dumps({"rows": [row], "mechanics": "another text"}))
    (copy / "validation" / f"{TOOL}-ticks.json").write_text(json.dumps({"sha256": "of another file"}))
    assert (
        main(["report", str(copy), "--verification", str(table), "--json"]) == 1
    )  # the tolerance is not met
    said = json.loads(capsys.readouterr().out)
    assert said["verdict"]["line"].startswith("Not met: ball")
    twin = json.loads((copy / "report" / "report.json").read_text())
    assert twin["verification"]["met"] == twin["verification"]["count"] == 1
    assert twin["verification"]["same"] is None  # the asset does not say what pressed it
    assert any("tick times of ball are of another cooked field" in note for note in twin["notes"])
    assert main(["report", str(copy), "--verification", str(copy / "summary.json")]) == 2
    assert "is not what palpate verify --json prints" in capsys.readouterr().err
    assert main(["report", str(tmp_path / "nowhere")]) == 2


def test_maps_are_the_known_response(asset: Path) -> None:
    field = read_field(asset, TOOL)
    reach = reach_map(read_organ(asset), field)
    assert reach.unstored_share == 0.0 and len(reach.vertices) > 100
    foot = ORGAN.foot(reach.vertices)
    n = ORGAN.normal(foot)
    force = {
        d: np.sum(ORGAN.force(foot + (RADIUS - d) * n) * n, axis=1) for d in (3e-3, 3.01e-3, 2.99e-3, 5e-3)
    }
    assert_close(reach.values["normal_force"][4], force[5e-3], 0.03)
    assert_close(reach.values["stiffness"][2], (force[3.01e-3] - force[2.99e-3]) / 2e-5, 0.04)
    push = ORGAN.force(foot + (RADIUS - 5e-3) * n)
    push = np.linalg.norm(push - np.sum(push * n, axis=1)[:, None] * n, axis=1)
    assert np.quantile(np.abs(reach.values["lateral_push"][4] - push) / force[5e-3], 0.95) < 0.02


def assert_close(value: np.ndarray, truth: np.ndarray, share: float) -> None:
    """The field's own interpolation error is a few percent at most; a wrong place, depth or sign is far more."""
    assert np.quantile(np.abs(value / truth - 1.0), 0.95) < share


def test_large_meshes_are_decimated_and_keep_their_reach(asset: Path) -> None:
    organ, field = read_organ(asset), read_field(asset, TOOL)
    everything = dataclasses.replace(organ, reach_triangles=np.arange(len(organ.triangles), dtype=np.int32))
    reach = reach_map(everything, field, triangle_limit=2000)
    assert (
        len(reach.triangles) + len(reach.rest_triangles) <= 2500
    )  # asked for about 2000; splitting long edges adds some
    assert 0.5 < reach.unstored_share < 1.0  # the field knows the cap alone: the rest is drawn plain
    area = sum(
        trimesh.triangles.area(v[t]).sum()
        for v, t in ((reach.vertices, reach.triangles), (reach.rest_vertices, reach.rest_triangles))
    )
    assert area == pytest.approx(trimesh.triangles.area(organ.vertices[organ.triangles]).sum(), rel=0.02)


def test_extrapolated_and_derived_nodes_are_marked(asset: Path) -> None:
    sources = gather(asset, {})
    field = sources.fields[0]
    reached, pressed = field.nodes.depth_reached.copy(), field.nodes.pressed.copy()
    reached[0], pressed[1] = 0.6 * DEPTH, False
    nodes = dataclasses.replace(field.nodes, depth_reached=reached, pressed=pressed)
    changed = dataclasses.replace(sources, fields=[dataclasses.replace(field, nodes=nodes)])
    reaches = [on_reach(sources.organ, field, None)]
    tool = plain(contents(changed, reaches))["tools"][0]
    assert (tool["nodes"]["pressed"], tool["nodes"]["extrapolated"], tool["nodes"]["derived"]) == (
        NODES - 2,
        1,
        1,
    )
    drawn = {trace.name: trace for trace in organ_figure(field, reaches[0], tool).data}
    assert len(drawn["node: stopped early (1)"].x) == len(drawn["node: not pressed (1)"].x) == 1
    assert drawn["node: stopped early (1)"].marker.symbol != drawn[f"node ({NODES - 2})"].marker.symbol


def test_without_opengl_the_report_says_so(
    asset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = Path(shutil.copytree(asset, tmp_path / "copy"))
    monkeypatch.setattr("palpate.author.report.render.sys.executable", shutil.which("false"))
    page = write_report(copy, SUMMARY).read_text(encoding="utf-8")
    assert "organ.png, stiffness_map.png, error_map.png could not be drawn on this machine" in page
    assert [path.name for path in (copy / "report").glob("*.png")] == ["worst_curves.png"]


def test_without_validation_and_summary_nothing_is_claimed(
    asset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = Path(shutil.copytree(asset, tmp_path / "copy"))
    shutil.rmtree(copy / "validation")
    monkeypatch.setattr("palpate.author.report.render.sys.executable", shutil.which("false"))
    page = write_report(copy, {}).read_text(encoding="utf-8")
    assert "Not judged: ball was never compared" in page and "no held-out press has been compared" in page
    assert json.loads((copy / "report" / "report.json").read_text())["verdict"]["state"] == "unjudged"
    assert list((copy / "report").glob("*.png")) == []


def test_each_tool_has_its_section(asset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    copy = Path(shutil.copytree(asset, tmp_path / "copy"))
    field = read_field(copy, TOOL)
    add_tool(copy, dataclasses.replace(field, tool=dataclasses.replace(field.tool, name="other")))
    monkeypatch.setattr("palpate.author.report.render.sys.executable", shutil.which("false"))
    page = write_report(copy, SUMMARY).read_text(encoding="utf-8")
    assert page.count('<section class="tool"') == page.count("<option>") == 2
    assert page.count('class="figure organ"') == 2 and page.count("plotly.js v") == 1
    report = json.loads((copy / "report" / "report.json").read_text())
    assert [tool["verdict"]["state"] for tool in report["tools"]] == ["missed", "unjudged"]
    assert report["tools"][1]["failures"] == [] and report["tools"][1]["rfield_bytes"] is None


def test_a_scenes_device_is_held_against_each_tool(html: str, report: dict[str, Any]) -> None:
    tool = report["tools"][0]
    device, sigma = tool["device"], tool["field"]["stiffness_max"]
    assert device["stiffness_allowed"] == pytest.approx(0.2 / (0.5 / 200.0))
    assert device["rate_needed"] == pytest.approx(sigma / (2 * 0.2)) and device["rate_needed"] > 200
    assert not device["met"] and 0.0 < device["share"] < 1.0
    assert "The device hums" in html and "no delay (--delay)" in html


def test_pictures_exist(asset: Path, can_draw: None) -> None:
    made = {path.name: path.stat().st_size for path in (asset / "report").glob("*.png")}
    report = json.loads((asset / "report" / "report.json").read_text())
    assert not [note for note in report["notes"] if "could not be drawn" in note]
    assert set(made) == {
        "organ.png",
        "error_map.png",
        "stiffness_map.png",
        "worst_curves.png",
        "device_map.png",
    }
    assert min(made.values()) > 10_000


if __name__ == "__main__":  # python tests/author/test_report.py DIR: a report to look at
    import sys

    place = Path(sys.argv[1])
    shutil.rmtree(place, ignore_errors=True)
    made = field_of(ORGAN, NODES)
    write_asset(place, organ_geometry(), made)
    (place / "validation").mkdir()
    (place / "validation" / f"{TOOL}.json").write_text(json.dumps(validation(made)))
    print(write_report(place, SUMMARY))
