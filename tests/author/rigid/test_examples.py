# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The published examples come out as published, and formations are named rightly."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from palpate.assets import SCENE_FOLDER
from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.rigid.cook import cooked_rigid
from palpate.author.rigid.examples import EXAMPLES, MASS, run_example
from palpate.author.rigid.formations import formation_table, keys_of
from palpate.author.rigid.known_configurations import BALL, CROSS, PEG, PLATE, identified
from palpate.author.rigid.picture import example_picture
from palpate.author.rigid.scene import load_rigid_scene
from palpate.runtime.rigid import RESPONSE, Region, Rigid, RigidSession, Status

SCENE = SCENE_FOLDER / "rigid" / "ball_on_bars.toml"


@pytest.mark.parametrize("name", EXAMPLES)
def test_what_has_to_come_out_of_an_example_does(name):
    run = run_example(EXAMPLES[name]())
    assert [what for what, met in run.outcomes if not met] == []


def test_an_example_is_drawn(tmp_path):
    example_picture(run_example(EXAMPLES["guarded_hit"]()), tmp_path / "hit.png")
    assert (tmp_path / "hit.png").read_bytes()[:4] == b"\x89PNG"


def test_formations_are_named_rightly_under_noise():
    known = identified(1300, seed=5)
    assert known["right"] >= 0.999, known["cases"]


def test_a_table_names_no_formation_less_rightly():
    plain, listed = (identified(1300, 0.3, seed=5, samples=n)["cases"] for n in (0, 300))
    assert all(listed[name] >= plain[name] for name in plain)


def in_the_corner(turned):
    """The peg's two faces half an eps from two walls, then turned about the vertical, rad; its formation's keys."""
    position = np.array([0.02 - 5e-4, 0.02 - 5e-4, 0.0])
    orientation = Rotation.from_rotvec([0, 0, turned]).as_quat()
    return position[None], orientation[None]


def test_of_contacts_within_a_digital_error_the_valid_combination_is_taken():
    plain = Rigid(cooked_rigid(PEG, PLATE, MASS))
    level = plain.identify(*in_the_corner(0.0))[0]
    tilted = plain.identify(*in_the_corner(-0.02))[0]  # one face's far corners are over eps away
    both = keys_of(level)
    assert level["contact"]["region"][:2].tolist() == [Region.PLANE, Region.PLANE] and keys_of(tilted) != both
    listed = Rigid(cooked_rigid(PEG, PLATE, MASS, formations=(both,))).identify(*in_the_corner(-0.02))[0]
    assert keys_of(listed) == both and listed["formation"] == 0
    other = Rigid(cooked_rigid(PEG, PLATE, MASS, formations=(keys_of(tilted), both)))
    assert keys_of(other.identify(*in_the_corner(-0.02))[0]) == keys_of(tilted)


def test_a_ball_on_two_cylinders_has_the_three_formations_of_two_contacts_that_the_table_finds():
    table = formation_table(BALL, CROSS, samples=600)
    walls = (0 << 16 | 1, 0 << 16 | 6)  # the ball against each cylinder's side
    assert walls in table.formations and (walls[0],) in table.formations and (walls[1],) in table.formations
    rigid = Rigid(cooked_rigid(BALL, CROSS, MASS, formations=table.formations))
    example = EXAMPLES["ball_on_two_cylinders"]()
    out = RigidSession(rigid).tick_batch(*example.path)
    both = out[out["contact_count"] == 2]
    assert len(both) > 1000 and len(set(both["formation"])) == 1 and both["formation"][0] != 0xFFFFFFFF
    assert not np.any(both["status"] & Status.NOT_IN_TABLE)
    assert keys_of(both[0]) == walls


def test_a_formation_that_is_not_in_the_table_is_told():
    rigid = Rigid(cooked_rigid(BALL, CROSS, MASS, formations=((0 << 16 | 1,),)))
    out = RigidSession(rigid).tick_batch(*EXAMPLES["ball_on_two_cylinders"]().path)
    assert np.all(out["status"][out["contact_count"] == 2] & Status.NOT_IN_TABLE)


def test_the_shipped_rigid_scene_is_cooked_and_opens(tmp_path, capsys):
    assert main(["rigid", str(SCENE), "--out", str(tmp_path), "--samples", "200", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    out = Rigid((tmp_path / "ball_on_bars.rigid").read_bytes()).identify([[0.06, 0, 0.0405]], [[0, 0, 0, 1]])
    assert out.dtype == RESPONSE and out["contact_count"][0] == 1 and answer["formations"] > 0


def test_author_cooks_a_rigid_scene(tmp_path, capsys):
    text = SCENE.read_text().replace('shape = "sphere"', 'shape = "blob"')
    (tmp_path / "wrong.toml").write_text(text)
    assert main(["author", str(tmp_path / "wrong.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "shape" in capsys.readouterr().err
    assert main(["author", str(SCENE), "--out", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["formations"] > 0 and (tmp_path / "ball_on_bars.rigid").stat().st_size == answer["bytes"]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({'radius = "20 mm"\nmass': 'radius = "20 mm"\nlenght = 1\nmass'}, "lenght"),
        ({'mass = "0.5 kg"': 'mass = "0 kg"'}, "mass"),
        ({'mass = "0.5 kg"': 'mass = "5 N"'}, "is a force, not a mass"),
        ({'length = "200 mm"\naxis = [1.0': "axis = [1.0"}, r"fixed\[0\].length is missing"),
        ({'["rigid"]': '["rigid", "friction"]'}, "a scene of its own"),
        ({'shape = "sphere"': 'shape = "blob"'}, "shape"),
    ],
)
def test_bad_scenes_are_told(tmp_path, change, says):
    text = SCENE.read_text()
    for old, new in change.items():
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(InputError, match=says):
        load_rigid_scene(tmp_path / "scene.toml").bodies()
