# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import trimesh

from palpate.fem_offline import surface
from palpate.fem_offline.errors import SurfaceError
from palpate.fem_offline.smoothing import solid_volume
from palpate.fem_offline.surface import FACET_ANGLE, SurfacePart, load_surface, repair_surface
from palpate.fem_offline.surface_parts import is_closed

BALL_VOLUME = 4.0 / 3.0 * np.pi * 0.03**3


def _sorted(points: np.ndarray) -> np.ndarray:
    return points[np.lexsort(points.T)]


def test_every_part_of_a_scene_comes_in_its_place_and_in_metres(tmp_path):
    scene = trimesh.Scene()
    ball = trimesh.creation.icosphere(subdivisions=2, radius=30.0)
    scene.add_geometry(
        ball, node_name="here", transform=trimesh.transformations.translation_matrix((100, 0, 0))
    )
    scene.add_geometry(ball, node_name="mirrored", transform=np.diag([1.0, 1.0, -1.0, 1.0]))
    scene.export(tmp_path / "two.glb")
    parts = {part.name: part for part in load_surface(tmp_path / "two.glb", "mm")}
    assert set(parts) == {"here", "mirrored"}
    assert parts["here"].vertices.mean(axis=0) == pytest.approx([0.1, 0.0, 0.0], abs=1e-6)
    for part in parts.values():  # a mirror must not turn the organ inside out
        assert solid_volume(part.vertices, part.triangles) == pytest.approx(BALL_VOLUME, rel=0.05)


def test_even_closed_surface_is_taken_as_it_is(ball):
    surface = repair_surface([ball], edge=4e-3)
    report = surface.report
    assert np.array_equal(
        surface.vertices[np.lexsort(surface.vertices.T)], ball.vertices[np.lexsort(ball.vertices.T)]
    )
    assert report.input_closed and not report.wrapped and not report.remeshed and not report.flipped
    assert report.distance_to_input < 1e-12 and report.input_outside < 1e-12
    assert report.volume == pytest.approx(solid_volume(ball.vertices, ball.triangles))


def test_inward_normals_are_turned_and_reported(ball):
    surface = repair_surface([SurfacePart("ball", ball.vertices, ball.triangles[:, ::-1])], mode="none")
    assert surface.report.flipped and surface.report.volume > 0.0


def test_same_input_gives_the_same_surface(ball):
    uneven = [SurfacePart("ball", ball.vertices * [1.0, 1.0, 2.0], ball.triangles)]
    first, second = repair_surface(uneven, edge=3e-3), repair_surface(uneven, edge=3e-3)
    assert first.report.remeshed
    assert first.hash == second.hash and np.array_equal(first.vertices, second.vertices)


def test_open_overlapping_patches_become_one_solid(ball, as_part):
    north = ball.vertices[ball.triangles].mean(axis=1)[:, 2] > -0.004
    south = ball.vertices[ball.triangles].mean(axis=1)[:, 2] < 0.004
    membrane = as_part(trimesh.creation.box((0.02, 0.02, 0.0002)), "membrane")
    membrane = SurfacePart("membrane", membrane.vertices + np.array([0.035, 0.0, 0.0]), membrane.triangles)
    parts = [
        SurfacePart("north", ball.vertices, ball.triangles[north]),
        SurfacePart("south", ball.vertices * 1.003, ball.triangles[south][:, ::-1]),
        membrane,
    ]
    surface = repair_surface(parts, edge=4e-3)
    report = surface.report
    assert report.wrapped and not report.input_closed
    assert is_closed(surface.triangles)
    assert report.volume == pytest.approx(BALL_VOLUME, rel=0.02)
    assert report.distance_to_input < 2e-3  # largest where the membrane sat
    assert report.input_outside > 8e-3  # the membrane sticks out by 15 mm and was taken off
    assert np.linalg.norm(surface.vertices, axis=1).max() < 0.033


def test_smaller_solids_beside_the_main_one_are_dropped_and_reported(ball):
    small = SurfacePart("crumb", 0.2 * ball.vertices + np.array([0.05, 0.0, 0.0]), ball.triangles)
    surface = repair_surface([small, ball], edge=4e-3)
    assert surface.report.volume == pytest.approx(BALL_VOLUME, rel=0.02)
    ((volume, size),) = surface.report.dropped
    assert volume == pytest.approx(0.008 * BALL_VOLUME, rel=0.02)
    assert size == pytest.approx(0.012, rel=0.02)


@pytest.mark.parametrize("hole", [1, 200])
def test_open_surface_without_repair_is_refused_in_one_sentence(ball, hole):
    with pytest.raises(SurfaceError, match="not one closed solid") as refusal:
        repair_surface([SurfacePart("ball", ball.vertices, ball.triangles[:-hole])], mode="none")
    assert refusal.value.where == "ball" and "auto" in refusal.value.expected


def test_unknown_repair_is_refused(ball):
    with pytest.raises(SurfaceError) as refusal:
        repair_surface([ball], mode="maybe")
    assert str(refusal.value) == "organ.repair: unknown repair 'maybe'; expected auto, wrap or none"


@pytest.mark.parametrize(
    ("size", "units", "hint"), [(200.0, "m", 'units = "mm"'), (0.2, "mm", 'units = "m"')]
)
def test_wrong_unit_is_refused_with_the_right_one(tmp_path, size, units, hint):
    trimesh.creation.icosphere(subdivisions=2, radius=size / 2).export(tmp_path / "organ.stl")
    with pytest.raises(SurfaceError, match="longest side") as refusal:
        load_surface(tmp_path / "organ.stl", units)
    assert hint in refusal.value.expected


def test_what_is_no_mesh_is_refused(tmp_path):
    with pytest.raises(SurfaceError, match="no such surface file"):
        load_surface(tmp_path / "absent.obj")
    (tmp_path / "text.stl").write_text("this is no mesh")
    (tmp_path / "points.obj").write_text("v 0 0 0\nv 1 0 0\n")
    (tmp_path / "nan.obj").write_text("v 0 0 0\nv nan 0 0\nv 0 0.1 0\nf 1 2 3\n")
    for name in ("text.stl", "points.obj", "nan.obj"):
        with pytest.raises(SurfaceError):
            load_surface(tmp_path / name)
    with pytest.raises(SurfaceError, match="unknown unit"):
        load_surface(tmp_path / "nan.obj", "inch")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "parts", "litres"),
    [
        ("liver-hra-male/VH_M_Liver.glb", 26, (1.72, 1.82)),
        ("kidney-hra-female-left/VH_F_Kidney_L.glb", 15, (0.24, 0.27)),
    ],
)
def test_anatomical_organs_go_in_as_they_are(organ_file, name, parts, litres):
    loaded = load_surface(organ_file(name))
    assert len(loaded) == parts
    surface = repair_surface(loaded)
    report = surface.report
    assert is_closed(surface.triangles)
    assert litres[0] < 1e3 * report.volume < litres[1]
    assert report.distance_to_input_p95 < 1.5e-3 and report.distance_to_input < 5e-3
    assert report.input_outside < 5e-3


@pytest.mark.slow
def test_closed_liver_that_cuts_itself_is_wrapped(organ_file):
    mesh = trimesh.load(organ_file("liver-small/liver-smooth.obj"), process=False)
    vertices = np.asarray(mesh.vertices) * 0.2 / np.ptp(mesh.vertices, axis=0).max()
    surface = repair_surface([SurfacePart("liver", vertices, np.asarray(mesh.faces, np.int32))])
    assert surface.report.wrapped and is_closed(surface.triangles)
    assert surface.report.volume == pytest.approx(solid_volume(vertices, np.asarray(mesh.faces)), rel=0.02)
    assert surface.report.distance_to_input < 2.5e-3


@pytest.mark.parametrize(("radius", "shorter"), [(0.03, True), (0.08, False)])
def test_a_small_organ_gets_shorter_edges_so_that_a_tool_feels_no_facets(as_part, radius, shorter):
    uneven = as_part(trimesh.creation.uv_sphere(radius=radius, count=(96, 96)), "ball")
    report = repair_surface([uneven]).report
    assert report.remeshed
    assert report.edge == 3.5e-3 if not shorter else 1.5e-3 <= report.edge < 3e-3
    assert report.dihedral_p50 < 1.1 * FACET_ANGLE


def test_a_closed_surface_is_made_finer_from_itself(as_part):
    ball = as_part(trimesh.creation.icosphere(subdivisions=5, radius=0.02), "ball")
    uneven = SurfacePart("ball", ball.vertices * [1.0, 1.0, 1.2], ball.triangles)
    report = repair_surface([uneven]).report
    assert report.remeshed and not report.wrapped and report.edge < 2e-3
    assert report.distance_to_input < 0.05e-3
    assert report.volume == pytest.approx(1.2 * (2 / 3) ** 3 * BALL_VOLUME, rel=0.01)


def test_edges_are_no_shorter_than_asked_and_large_curved_organs_stay_affordable(as_part, monkeypatch):
    uneven = as_part(trimesh.creation.uv_sphere(radius=0.03, count=(96, 96)), "ball")
    assert repair_surface([uneven], edge=1.2e-3).report.edge == 1.2e-3
    monkeypatch.setattr(surface, "TRIANGLES_MAX", 4_000)
    assert len(repair_surface([uneven]).triangles) < 1.2 * 4_000


def test_an_organ_of_a_centimetre_keeps_its_volume_and_a_crumb_is_refused(as_part):
    ball = as_part(trimesh.creation.icosphere(subdivisions=5, radius=1.0), "ball").vertices * [1.0, 1.0, 1.2]
    triangles = trimesh.creation.icosphere(subdivisions=5).faces
    report = repair_surface([SurfacePart("small", 0.005 * ball, triangles)]).report
    assert report.edge == 1.5e-3 and report.volume == pytest.approx(1.2 * BALL_VOLUME / 6**3, rel=0.1)
    with pytest.raises(SurfaceError, match="too small or too thin"):
        repair_surface([SurfacePart("crumb", 0.0012 * ball, triangles)])
