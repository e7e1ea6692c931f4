# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Paint on the surface file's vertices: read from what holds it, carried through repair, refused by name."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from palpate.author.capabilities import require_capabilities
from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.field_stage import press_arrays
from palpate.author.organ_stage import OrganMesh, mesh_organ
from palpate.author.paint import read_paint
from palpate.author.plan import plan
from palpate.author.sampling import reach_samples
from palpate.author.scene import load_scene
from palpate.author.store import Store
from palpate.author.tool_stage import shape_of
from palpate.author.tool_work import ToolWork

SCENE = """
[scene]
name = "cube"
effects = ["response", "friction"]

[organ]
surface = "{file}"
mesh_size = "8 mm"
units = "{units}"

[[organ.support]]
box = {{ min = [-1.0, -1.0, -1.0], max = [1.0, 1.0, 0.001] }}

[organ.paint]
{paint}

[reach]
sphere = {{ center = [0.0, 0.0, 0.02], radius = "12 mm" }}
depth_max = "2 mm"

[[tool]]
name = "ball"
shape = "sphere"
radius = "3 mm"

[accuracy]
held_out = 2
fidelity = "linear"
"""
BOTH = 'friction = "palpate:friction"\nreach = "palpate:reach"'


def block() -> trimesh.Trimesh:
    """40 x 40 x 20 mm on z = 0, edges of 5 mm: friction 0.2 + 5 x / m, scale 2 + 20 x / m, reach where x > -4 mm."""
    made = trimesh.creation.box((0.04, 0.04, 0.02)).subdivide().subdivide().subdivide()
    made.apply_translation((0.0, 0.0, 0.01))
    x = made.vertices[:, 0]
    made.vertex_attributes["palpate:friction"] = (0.2 + 5.0 * x).astype("f4")
    made.vertex_attributes["palpate:stiffness_scale"] = (2.0 + 20.0 * x).astype("f4")
    made.vertex_attributes["palpate:reach"] = (x > -4e-3).astype("f4")
    return made


def scene_of(
    folder: Path, mesh, file: str = "organ.ply", paint: str = BOTH, units: str = "m", **options
) -> Path:
    mesh.export(folder / file, **options)
    path = folder / "scene.toml"
    path.write_text(SCENE.format(file=file, paint=paint, units=units))
    return path


@pytest.mark.parametrize(
    ("file", "options"),
    [("organ.ply", {}), ("organ.ply", {"encoding": "ascii"}), ("organ.glb", {}), ("moved.glb", {})],
)
def test_every_format_says_the_same_at_any_point(tmp_path, file, options):
    mesh = block()
    if file == "organ.glb":  # as glTF would have custom attributes named
        for name in list(mesh.vertex_attributes):
            mesh.vertex_attributes[f"_{name}"] = mesh.vertex_attributes.pop(name)
    if file == "moved.glb":  # a node of the scene graph, turned and moved
        turn = trimesh.transformations.rotation_matrix(0.7, (0, 0, 1), (0.01, 0, 0))
        mesh.apply_transform(np.linalg.inv(turn))
        scene = trimesh.Scene()
        scene.add_geometry(mesh, transform=turn)
        mesh = scene
    paint = read_paint(load_scene(scene_of(tmp_path, mesh, file, **options)))
    points = np.random.default_rng(1).uniform((-0.018, -0.018, 0.019), (0.018, 0.018, 0.023), (50, 3))
    found = paint.at(points)
    np.testing.assert_allclose(found["friction"], 0.2 + 5.0 * points[:, 0], atol=2e-6)  # linear, so exact
    far = np.abs(points[:, 0] + 2.5e-3) > 3e-3
    assert np.array_equal(found["reach"][far] > 0.5, points[far, 0] > 0)


def test_units_of_the_file_apply_to_its_paint(tmp_path):
    mesh = block()
    mesh.apply_scale(1000.0)
    paint = read_paint(load_scene(scene_of(tmp_path, mesh, units="mm")))
    assert paint.at(np.array([[0.01, 0.0, 0.02]]))["friction"][0] == pytest.approx(0.25)


def changed(name: str, values) -> trimesh.Trimesh:
    mesh = block()
    mesh.vertex_attributes[name] = np.asarray(values(mesh.vertex_attributes[name].astype("f4")))
    return mesh


def at_three(value: float):
    def change(values):
        values[3] = value
        return values

    return change


def two_parts(second: float | None) -> trimesh.Scene:
    """Two blocks that share a face; friction 0.1 on one, `second` on the other."""
    scene = trimesh.Scene()
    for name, shift, value in (("left", -0.02, 0.1), ("right", 0.02, second)):
        part = trimesh.creation.box((0.04, 0.04, 0.02))
        part.apply_translation((shift, 0.0, 0.01))
        if value is not None:
            part.vertex_attributes["_palpate:friction"] = np.full(len(part.vertices), value, "f4")
        scene.add_geometry(part, node_name=name, geom_name=name)
    return scene


FRICTION = 'friction = "palpate:friction"'
CONTRADICTIONS = {
    "a stiffness of nothing": (lambda: changed("palpate:friction", at_three(0.0)), "organ.ply",
                               'stiffness_scale = "palpate:friction"\n' + FRICTION,
                               ["organ.paint.stiffness_scale", "is 0 at (", "0.001 to 1000"]),
    "a negative coefficient": (lambda: changed("palpate:friction", at_three(-0.1)), "organ.ply", BOTH,
                               ["organ.paint.friction", "is -0.1 at (", "0 to 2"]),
    "no number": (lambda: changed("palpate:friction", at_three(np.nan)), "organ.ply", BOTH,
                  ["organ.paint.friction", "is nan at (", "1 vertices"]),
    "a coefficient of 3": (lambda: changed("palpate:friction", at_three(3.0)), "organ.ply", BOTH, ["is 3 at ("]),
    "half a reach too much": (lambda: changed("palpate:reach", at_three(1.5)), "organ.ply", BOTH,
                              ["organ.paint.reach", "is 1.5", "0 to 1"]),
    "nothing to touch": (lambda: changed("palpate:reach", lambda v: 0 * v), "organ.ply", BOTH,
                         ["organ.paint.reach", "lets no tool touch anything"]),
    "two parts that disagree": (lambda: two_parts(0.3), "organ.glb", FRICTION,
                                ["organ.paint.friction", "is both 0.1 and 0.3 at (0.0, ", "one value at one place"]),
    "a part that is not painted": (lambda: two_parts(None), "organ.glb", FRICTION,
                                   ["organ.paint.friction", 'not on "right"', "every part painted"]),
    "a name that is missing": (block, "organ.ply", 'friction = "palpate:frictoin"',
                               ['"palpate:frictoin"', 'did you mean "palpate:friction"?', "palpate:reach"]),
    "a format without scalars": (block, "organ.stl", FRICTION, ["no scalar per vertex of organ.stl", "PLY or GLB"]),
    "three numbers a vertex": (lambda: changed("palpate:friction", lambda v: np.stack([v, v, v], 1)), "organ.glb",
                               FRICTION, ["organ.paint.friction", "has 1158 values", "386 vertices"]),
}  # fmt: skip


@pytest.mark.parametrize("case", CONTRADICTIONS)
def test_contradictory_paint_is_refused_by_name_before_any_work(case, tmp_path, capfd):
    make, file, paint, told = CONTRADICTIONS[case]
    scene = scene_of(tmp_path, make(), file, paint)
    for command in (["plan", str(scene)], ["author", str(scene), "--out", str(tmp_path / "out")]):
        assert main(command) == 2
        err = capfd.readouterr().err
        assert "scene.toml" in err and "Traceback" not in err
        for words in told:
            assert words in err, err
    assert not (tmp_path / "out" / "work" / "surface").exists()


def test_what_the_scene_contradicts_is_refused(tmp_path):
    path = scene_of(tmp_path, block())
    text = path.read_text()
    path.write_text(text.replace('radius = "3 mm"', 'radius = "3 mm"\nfriction = 0.1'))
    with pytest.raises(InputError, match=r"tool\[0\]\.friction = 0\.1 contradicts organ\.paint\.friction"):
        load_scene(path)
    path.write_text(text.replace('effects = ["response", "friction"]', ""))
    with pytest.raises(InputError, match=r"paints what scene\.effects leaves out"):
        load_scene(path)
    path.write_text(text.replace(BOTH, ""))
    with pytest.raises(InputError, match=r"organ\.paint paints nothing"):
        load_scene(path)
    path.write_text(text.replace(BOTH, 'reach = "palpate:reach"'))
    with pytest.raises(InputError, match=r"tool\[0\]\.friction is missing"):  # nobody says it then
        load_scene(path)


@pytest.fixture(scope="module")
def meshed(tmp_path_factory) -> tuple:
    folder = tmp_path_factory.mktemp("painted")
    scene = load_scene(scene_of(folder, block()))
    return scene, mesh_organ(scene, Store(folder / "work"))


def test_paint_goes_through_repair_by_the_closest_point_of_the_file(meshed):
    _, mesh = meshed
    assert mesh.report["surface"]["remeshed"] and len(mesh.vertices) != 386
    top = mesh.vertices[:, 2] > 0.0199
    assert top.sum() > 20
    np.testing.assert_allclose(mesh.paint["friction"][top], 0.2 + 5.0 * mesh.vertices[top, 0], atol=1e-5)
    everywhere = np.abs(mesh.paint["friction"] - (0.2 + 5.0 * mesh.vertices[:, 0]))
    assert everywhere.max() < 5.0 * 1e-3  # smoothing moves a vertex by 1 mm at most


def test_only_painted_reach_is_touched_and_planned(meshed):
    scene, mesh = meshed
    samples = reach_samples(mesh, scene.reach, shape_of(scene, scene.tool[0]), 2e-3)
    border = samples.points[:, 0].min()
    assert -3.5e-3 < border < -1.5e-3  # painted 0 at -5 mm, 1 at 0
    planned = plan(scene).result
    assert planned["mesh"]["paint"] == ["friction", "reach"]
    disc = np.pi * 12e-3**2
    half = disc / 2 + 2 * 2.5e-3 * 12e-3
    assert planned["reach"]["area"] == pytest.approx(half, rel=0.12)


def test_a_node_and_a_held_out_press_have_the_friction_painted_where_they_stand(meshed):
    scene, mesh = meshed
    work = ToolWork(scene, mesh, scene.tool[0])
    for job in work.held_jobs:
        assert job.friction == pytest.approx(0.2 + 5.0 * job.contact_point[0], abs=1e-3) and job.moves
    point = (5e-3, 0.0, 0.02)
    states = np.linspace(0.0, 2e-3, 11)
    arrays = {
        "depth": states, "contact_point": np.array(point), "normal": np.array([0.0, 0.0, 1.0]),
        "force_vector": np.outer(500.0 * states**1.5, [0, 0, 1.0]), "energy": 200.0 * states**2.5,
        "sticking_stiffness": np.tile(50.0 * np.eye(3), (11, 1, 1)),
        "friction_share": np.ones(11),
    }  # fmt: skip
    outcome = SimpleNamespace(
        arrays=arrays, values={"reason": ""}, key="k", job=SimpleNamespace(contact_point=point)
    )
    press, reason = press_arrays(scene, scene.tool[0], outcome, mesh)
    assert press is not None and not reason
    assert press.friction_coefficient[:, 1] == pytest.approx(0.225, abs=1e-4)


def test_friction_and_reach_change_no_press(meshed):
    """A press is frictionless; its key must not know of paint that it does not feel."""
    _, mesh = meshed
    bare = OrganMesh(
        **{k: v for k, v in mesh.__dict__.items() if k in OrganMesh.__dataclass_fields__} | {"paint": {}}
    )
    assert bare.hash == mesh.hash and bare.painted("friction", mesh.vertices) is None
    assert bare.reachable(mesh.vertices).all() and not mesh.reachable(mesh.vertices).all()


def test_painted_stiffness_goes_through_the_thickness_and_into_every_press_s_key(meshed):
    scene, mesh = meshed
    folder = scene.file.parent
    text = (folder / "scene.toml").read_text()
    (folder / "stiff.toml").write_text(
        text.replace(BOTH, BOTH + '\nstiffness_scale = "palpate:stiffness_scale"')
    )
    stiff = load_scene(folder / "stiff.toml")
    require_capabilities(stiff)
    painted = mesh_organ(stiff, Store(folder / "work"))
    assert np.array_equal(painted.tets, mesh.tets) and painted.hash != mesh.hash
    middle = painted.points[painted.tets].mean(axis=1)
    inner = np.abs(middle[:, :2]).max(axis=1) < 8e-3  # nearest to top or base, not to a side
    assert inner.any()
    found = painted.organ.fractions.sum(axis=1)
    np.testing.assert_allclose(found[inner], 2.0 + 20.0 * middle[inner, 0], atol=0.03)
    assert np.array_equal(mesh.organ.fractions.sum(axis=1), np.ones(len(mesh.tets)))


def test_the_asset_keeps_the_paint(meshed, tmp_path):
    from pxr import Usd, UsdGeom

    from palpate.fields.organ_geometry import organ_hash
    from palpate.fields.usd_layer import replace_file
    from palpate.fields.usd_organ import organ_from_prim, organ_layer

    _, mesh = meshed
    organ = mesh.geometry(np.ones(len(mesh.triangles), bool))
    replace_file(organ_layer(organ), tmp_path / "organ.usdc")
    stage = Usd.Stage.Open(str(tmp_path / "organ.usdc"))
    back = organ_from_prim(stage.GetDefaultPrim())
    assert back.paint.keys() == {"friction", "reach"} and organ_hash(back) == organ_hash(organ)
    assert back.paint["friction"].tobytes() == mesh.paint["friction"].tobytes()
    painted = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/cube/Surface")).GetPrimvar("palpate:friction")
    assert np.array_equal(np.array(painted.ComputeFlattened()), mesh.paint["friction"])
