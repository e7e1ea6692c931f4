# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Traces in, traces with energies out; and what a wrong trace is told."""

import json

import numpy as np
import pytest
import synthetic_field

from palpate.author.command_line import main
from palpate.author.errors import InputError
from palpate.author.replay import RESULT_COLUMNS, read_trace, replay, write_trace
from palpate.fields.cook import cook


@pytest.fixture(scope="module")
def field(tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "plane.rfield"
    path.write_bytes(cook(synthetic_field.FIELDS["plane"]()))
    return path


def press(ticks=400):
    """In, aside, out: 1.6 s at 1 kHz."""
    corners = np.array([(-4e-3, 0, 8e-3), (-4e-3, 0, 2e-3), (-1e-3, 1e-3, 2e-3), (-1e-3, 1e-3, 8e-3)])
    t = np.linspace(0, 3, 4 * ticks)
    q = np.stack([np.interp(t, range(4), corners[:, a]) for a in range(3)], axis=1)
    return {"x": q[:, 0], "y": q[:, 1], "z": q[:, 2], "dt": np.full(len(q), 1e-3)}


@pytest.mark.parametrize("ending", [".csv", ".npz"])
def test_an_answer_is_a_trace_that_reproduces_itself(field, tmp_path, ending):
    first, second, third = (tmp_path / f"{i}{ending}" for i in range(3))
    write_trace(first, press())
    result = replay(field, first, second)
    replay(field, second, third)
    assert second.read_bytes() == third.read_bytes()
    with_forces = np.load(second) if ending == ".npz" else np.genfromtxt(second, delimiter=",", names=True)
    names = with_forces.files if ending == ".npz" else with_forces.dtype.names
    assert set(RESULT_COLUMNS) <= set(names)
    work = -sum(np.sum(with_forces[f"f{a}"][:-1] * np.diff(with_forces[a])) for a in "xyz")
    assert result["work_in"] == pytest.approx(work, abs=1e-14)
    assert result["balance_error"] < 1e-14 and result["dissipated_friction"] > 1e-6
    assert result["work_in"] > 0 and result["stored_energy"] == 0


def test_npz_with_whole_vectors_times_and_orientation_is_the_same_trace(field, tmp_path):
    table = press()
    write_trace(tmp_path / "a.npz", table)
    q = np.stack([table[a] for a in "xyz"], axis=1)
    turn = np.tile([0.0, 0.6, 0.0, 0.8], (len(q), 1))
    np.savez(tmp_path / "b.npz", position=q, orientation=turn, time=np.arange(len(q)) * 1e-3)
    one, other = (replay(field, tmp_path / f"{n}.npz") for n in "ab")
    assert one["work_in"] == other["work_in"]  # a ball feels no orientation
    assert one["seconds"] == pytest.approx(other["seconds"])


def test_a_moving_organ_is_replayed_and_its_work_told(field, tmp_path):
    table = press()
    held = {name: np.full(1600, value) for name, value in (("x", -4e-3), ("y", 0.0), ("z", 5.2e-3))}
    lift = {"ox": np.zeros(1600), "oy": np.zeros(1600), "oz": 3e-3 * np.sin(np.linspace(0, np.pi, 1600))}
    write_trace(tmp_path / "breath.csv", held | {"dt": table["dt"]} | lift)
    result = replay(field, tmp_path / "breath.csv", tmp_path / "answer.csv")
    assert result["work_in"] == 0 and abs(result["organ_work"]) > 1e-7 and result["force_max_seen"] > 0.05
    assert result["balance_error"] < 1e-14
    turned = lift | {f"oq{a}": np.full(1600, float(a == "w")) for a in "xyzw"}
    write_trace(tmp_path / "turned.csv", held | {"dt": table["dt"]} | turned)
    assert replay(field, tmp_path / "turned.csv")["organ_work"] == result["organ_work"]


def test_the_force_limit_and_friction_reach_the_runtime(field, tmp_path):
    write_trace(tmp_path / "t.csv", press())
    free = replay(field, tmp_path / "t.csv", friction=0.0)
    rough = replay(field, tmp_path / "t.csv", friction=0.5)
    assert (
        free["dissipated_friction"] < 0.05 * rough["dissipated_friction"]
    )  # the spring's share within a tick
    limited = replay(field, tmp_path / "t.csv", force_max=0.02)
    assert limited["force_max_seen"] <= 0.02 < free["force_max_seen"]
    assert any("yielded" in sentence for sentence in limited["status"])


def test_the_command_prints_one_json_object(field, tmp_path, capsys):
    write_trace(tmp_path / "t.csv", press())
    assert (
        main(["replay", str(field), str(tmp_path / "t.csv"), "--out", str(tmp_path / "o.csv"), "--json"]) == 0
    )
    result = json.loads(capsys.readouterr().out)
    assert result["ticks"] == 1600 and (tmp_path / "o.csv").is_file()
    assert main(["replay", str(field), str(tmp_path / "t.csv")]) == 0
    assert "hold_leak" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"dt": None}, "dt"),
        ({"x": None}, "x"),
        ({"qx": 0.0}, "qy"),
    ],
)
def test_what_a_trace_lacks_is_named(field, tmp_path, change, key):
    table = press(5)
    for name, value in change.items():
        if value is None:
            del table[name]
        else:
            table[name] = np.array(table.get(name, np.zeros(20)))
            table[name][3] = value
    write_trace(tmp_path / "t.csv", table)
    with pytest.raises(InputError) as caught:
        replay(field, tmp_path / "t.csv")
    assert key in [problem.key for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("y", np.nan),
        ("x", np.inf),
        ("dt", 0.0),
        ("dt", -1e-3),
        ("time", np.nan),
        ("qw", 0.5),
        ("oz", np.nan),
        ("oqw", np.inf),
        ("release", np.nan),
    ],
)
def test_a_row_that_cannot_be_used_reaches_the_runtime_which_says_so(field, tmp_path, name, value):
    table = press()
    columns = {f"{prefix}q{a}": np.full(1600, float(a == "w")) for prefix in ("", "o") for a in "xyzw"}
    table |= columns | {f"o{a}": np.zeros(1600) for a in "xyz"} | {"release": np.zeros(1600)}
    if name == "time":
        table["time"] = np.cumsum(table.pop("dt"))
    write_trace(tmp_path / "good.npz", table)
    good, bad, again = (tmp_path / f"{n}.npz" for n in ("good_answer", "bad_answer", "again"))
    replay(field, tmp_path / "good.npz", good)
    row = 700  # in contact
    table[name][row] = value
    write_trace(tmp_path / "bad.csv", table)
    result = replay(field, tmp_path / "bad.csv", bad)
    was, now = np.load(good), np.load(bad)
    assert was["normal_force"][row] > 0.05 and result["ticks"] == 1600
    says = 0x200 if name == "release" else 0x100  # palpate.h: RELEASED, BAD_INPUT
    assert int(now["status"][row]) & says and sum(result["status"].values()) >= 1
    assert all(now[f][row] == 0 for f in ("fx", "fy", "fz", "stored_energy"))
    np.testing.assert_array_equal(now["fz"][:row], was["fz"][:row])
    deep = slice(row + 1, 1000)  # still in the tissue, which it has not left since: no contact
    assert not now["fz"][deep].any() and (now["status"][deep].astype(int) & 0x20).all()
    assert result["balance_error"] < 1e-14 and np.isfinite(result["seconds"])
    replay(field, bad, again)
    np.testing.assert_array_equal(np.load(again)["work_in"], now["work_in"])


def test_contact_comes_back_from_outside_after_a_row_that_cannot_be_used(field, tmp_path):
    twice = {name: np.concatenate([column, column]) for name, column in press().items()}
    twice["x"][700] = np.nan
    write_trace(tmp_path / "t.csv", twice)
    replay(field, tmp_path / "t.csv", tmp_path / "o.npz")
    answer = np.load(tmp_path / "o.npz")
    assert not answer["fz"][700:1600].any() and answer["fz"][1600:].max() > 0.05


@pytest.mark.parametrize(("name", "value"), [("y", np.nan), ("dt", 0.0), ("dt", np.nan)])
def test_a_trace_without_one_usable_row_is_refused(field, tmp_path, name, value):
    table = press(5)
    table[name][:] = value
    write_trace(tmp_path / "t.csv", table)
    with pytest.raises(InputError) as caught:
        replay(field, tmp_path / "t.csv")
    assert [problem.key for problem in caught.value.problems] == [name]


@pytest.mark.parametrize("text", ["", "x,y,z,dt\n", "hello", "x,y,z,dt\n1,2,3\n"])
def test_a_file_that_is_no_trace_is_refused(tmp_path, text):
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(InputError):
        read_trace(tmp_path / "t.csv")


@pytest.mark.parametrize("option", ["--friction", "--force-max"])
def test_numbers_that_no_session_takes_are_refused_by_name(field, tmp_path, capfd, option):
    (tmp_path / "t.csv").write_text("dt,x,y,z\n0.001,0,0,0\n")
    assert main(["replay", str(field), str(tmp_path / "t.csv"), option, "inf"]) == 2
    assert f"{option} = inf is not usable" in capfd.readouterr().err


def test_missing_files_are_refused(field, tmp_path):
    with pytest.raises(InputError):
        replay(field, tmp_path / "none.csv")
    write_trace(tmp_path / "t.csv", press(5))
    with pytest.raises(InputError):
        replay(tmp_path / "none.rfield", tmp_path / "t.csv")
    with pytest.raises(InputError):
        replay(field, tmp_path / "t.csv", tmp_path / "out.txt")
