# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a scene does not name is not solved, not stored and not evaluated: each effect, left out, takes its all with it.

The same organ is authored with and without the effect; presses are a law that is known (stand_in_solvers.py).
"""

from __future__ import annotations

import sys
import time
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import trimesh

sys.path.append(str(Path(__file__).parents[1] / "author"))
from stand_in_solvers import Inline, known_block

from palpate.author import pipeline, press_solve
from palpate.author.capabilities import CAPABILITIES
from palpate.author.press_jobs import PressJob
from palpate.author.report import write
from palpate.author.scene import load_scene
from palpate.fields.rfield_layout import LAYERS
from palpate.fields.rfield_read import read_header
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
from palpate.runtime import Field, Session

SCENE = """
[scene]
name = "cube"
effects = [{effects}]

[organ]
surface = "cube.stl"
mesh_size = "8 mm"

[[organ.support]]
box = {{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.001] }}

[[tool]]
name = "ball"
shape = "sphere"
radius = "5 mm"
friction = 0.1

[reach]
sphere = {{ center = [0.0, 0.0, 0.02], radius = "6 mm" }}
depth_max = "2 mm"

[accuracy]
held_out = 2
{more}
"""
TRANSIENT = """
[tool.transient]
shape = "decaying_sinusoid"
amplitude = "15.9 N s/m"
frequency = "66 Hz"
duration = "55 ms"
"""
ASKED_FOR = ("moves", "drag", "stiffness", "surface")
"""Of a press job: solves beyond those of the force."""
TICKS, TRIES = 4000, 15


@dataclass(frozen=True)
class Effect:
    """How a scene asks for an effect, and what it leaves.

    Attributes:
        more: further lines of the scene.
        asks: what jobs of presses have for it alone.
        usd: parts of names of prims and attributes that only the effect has.
        layer: its row in the .rfield's table of layers; "" where it has channels of the curves instead.
        slower: least ratio of a tick with it to one without; 0 where it is evaluated outside the tick.
        height: m, by which the surface differs at most.
    """

    more: str = ""
    asks: tuple[str, ...] = ()
    usd: tuple[str, ...] = ()
    layer: str = ""
    slower: float = 0.0
    height: float = 0.0


EFFECTS = {
    "deformation": Effect(
        asks=("surface",), usd=("/Deformation", "palpate:deformation:"), layer="deformation"
    ),
    "friction": Effect(
        asks=("moves", "stiffness"),
        usd=("StiffnessCurves", "FrictionCurves", "frictionStiffness", "frictionCoefficient"),
        slower=1.02,
    ),
    "transient": Effect(
        more=TRANSIENT, usd=("/Transient", "palpate:transient:"), layer="transient", slower=1.02
    ),
    "texture": Effect(
        more='[[texture]]\nkind = "grating"\namplitude = "20 um"\nwavelength = "1.2 mm"\ndirection = [1, 0, 0]\n',
        usd=("Response/Texture", "palpate:texture:"),
        layer="texture",
        slower=1.02,
        height=20e-6,
    ),
}
"""An effect that is built gets a row here."""


@dataclass
class Made:
    """An authored asset and the presses that made it."""

    folder: Path
    jobs: list[PressJob] = field(default_factory=list)

    @property
    def rfield(self) -> bytes:
        return (self.folder / "ball.rfield").read_bytes()


def made(folder: Path, effects: tuple[str, ...], more: str = "") -> Made:
    trimesh.creation.box((0.04, 0.04, 0.02)).apply_translation((0.0, 0.0, 0.01)).export(folder / "cube.stl")
    scene = folder / f"{'_'.join(effects)}.toml"
    scene.write_text(SCENE.format(effects=", ".join(f'"{effect}"' for effect in effects), more=more))
    found = Made(folder / scene.stem)
    if (folder / "work").is_dir():
        found.folder.mkdir()
        (found.folder / "work").mkdir()
        for kind in ("surface", "mesh"):  # the organ is the same
            (found.folder / "work" / kind).symlink_to(folder / "work" / kind)

    def solve(mesh, job, store, progress=None):
        found.jobs.append(job)
        return known_block(mesh, job, store)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(press_solve, "solve", solve)
        patch.setattr(pipeline, "_here", lambda *args: nullcontext(Inline()))
        patch.setattr(write, "pictures", lambda *args: ([], []))
        pipeline.author(load_scene(scene), found.folder)
    if not (folder / "work").is_dir():
        (folder / "work").symlink_to(found.folder / "work")
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("effects")


@pytest.fixture(scope="module")
def bare(folder: Path) -> Made:
    return made(folder, ("response",))


@pytest.fixture(scope="module", params=sorted(EFFECTS))
def effect(request: pytest.FixtureRequest, folder: Path, bare: Made) -> tuple[Effect, Made]:
    row = EFFECTS[request.param]
    return row, made(folder, ("response", request.param), row.more)


def names(asset: Path) -> str:
    """All prims and authored properties of an asset."""
    from pxr import Usd

    stage = Usd.Stage.Open(str(next(asset.glob("*.usda"))))
    return "\n".join(
        f"{prim.GetPath()} {[p.GetName() for p in prim.GetAuthoredProperties()]}" for prim in stage.Traverse()
    )


def test_every_row_is_an_effect_that_is_built() -> None:
    assert set(EFFECTS) <= set(CAPABILITIES["effects"]) - {"response"}


def test_its_solves_are_gone(bare: Made, effect: tuple[Effect, Made]) -> None:
    row, full = effect
    asked = lambda run: {name for job in run.jobs for name in ASKED_FOR if getattr(job, name)}  # noqa: E731
    assert asked(bare) == set()
    assert asked(full) == set(row.asks)
    assert len(bare.jobs) <= len(full.jobs)


def test_its_usd_attributes_are_gone_and_the_asset_is_clean(bare: Made, effect: tuple[Effect, Made]) -> None:
    row, full = effect
    assert all(name in names(full.folder) and name not in names(bare.folder) for name in row.usd)
    assert asset_errors(bare.folder) == []
    nodes = read_field(bare.folder, "ball").nodes
    assert not nodes.friction_stiffness.any() and not nodes.friction_coefficient.any()


def test_its_curves_channels_and_layers_are_gone(bare: Made, effect: tuple[Effect, Made]) -> None:
    without, full = read_header(bare.rfield), read_header(effect[1].rfield)
    assert without["stiffness_curve_count"] == without["friction_curve_count"] == 0
    assert without["channel_stride"] == 4
    assert all(int(size) == 0 for size in without["layer_size"][: len(LAYERS)])
    sizes = dict(zip(LAYERS, map(int, full["layer_size"]), strict=False))
    assert {name for name, size in sizes.items() if size} == ({effect[0].layer} - {""})
    assert len(bare.rfield) < len(effect[1].rfield)
    if effect[0] is EFFECTS.get("friction"):
        assert (
            full["stiffness_curve_count"] > 0
            and full["friction_curve_count"] > 0
            and full["channel_stride"] == 8
        )


def test_its_share_of_a_tick_is_gone(bare: Made, effect: tuple[Effect, Made]) -> None:
    """Least CPU time of many turns, taken alternately; noise only adds to a turn."""
    row, full = effect
    if not row.slower:
        pytest.skip("is evaluated outside the tick")
    fields = [Field.open(run.rfield) for run in (bare, full)]
    rho = fields[0].info.tool_offset
    angle = np.linspace(0.0, 20.0, TICKS)
    path = np.column_stack([2e-3 * np.sin(angle), 2e-3 * np.cos(angle), np.full(TICKS, 0.02 + rho - 1.5e-3)])
    path[0, 2] = 0.02 + rho + 1e-3
    least = [np.inf, np.inf]
    for _ in range(TRIES):
        for k, opened in enumerate(fields):
            session = Session(opened)
            begun = time.process_time()
            responses = session.tick_batch(path)
            least[k] = min(least[k], time.process_time() - begun)
            assert (responses["region"][1:] == 2).all()
    assert least[1] >= row.slower * least[0]


def test_what_is_felt_straight_down_is_the_same(bare: Made, effect: tuple[Effect, Made]) -> None:
    down = np.column_stack([np.zeros(200), np.zeros(200), 0.03 - np.arange(200) * 40e-6])
    forces = [Session(Field.open(run.rfield)).tick_batch(down)["normal_force"] for run in (bare, effect[1])]
    limit = effect[0].height * Field.open(effect[1].rfield).info.stiffness_max
    assert forces[0] == pytest.approx(forces[1], rel=1e-6, abs=1e-9 + limit)
