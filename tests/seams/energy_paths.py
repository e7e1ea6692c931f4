# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Paths by the million: is energy created?  `python tests/seams/energy_paths.py PATHS [SEED]` prints two tables.

Fields go through a USD asset; usd_judge.py recomputes every tick's energy from what USD holds, path_kinds.py draws the
paths: random, adversarial and recorded.  Drawn at random for each path: friction 0 to 1, adhesion function, rate 100 Hz
to 80 kHz, speed 1 mm/s to 1 m/s; the device's force limit and the leak's cover in a quarter each; by row contrasts of
stiffness 1:1, 6:1, 100:1; by family tilts of the tool, changes to a field four times as stiff and back, a moving organ.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial.transform import Rotation

sys.path.insert(0, str(Path(__file__).parents[1] / "fields"))
from known_organ import KnownOrgan, field_of
from path_kinds import KINDS, TICKS, Ground, paths_of
from usd_judge import Ways, judged

from palpate.fields.as_cooked import as_cooked
from palpate.fields.cook import cook
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.response_field import ResponseField
from palpate.fields.usd_read import read_field
from palpate.fields.usd_write import write_asset
from palpate.runtime import Adhesion, Config, Field, Session, Tick
from palpate.runtime.layout import RESPONSE, STATE, Input
from palpate.runtime.library import library

FAMILIES = ("plain", "tilt", "swap", "organ", "all at once")
CONTRASTS = {"1:1": 0.0, "6:1": 0.5 * np.log(6.0), "100:1": 0.5 * np.log(100.0)}
WAYS = Ways(np.array([1.0, 0.8, 0.5]), np.array([1.0, 0.5, 2.0]), np.array([5e-3, 4.8e-3, 4.9e-3]))
SWAPPED = 4.0  # powers of two: scaled amplitudes are then exact in float32
SWAP_EVERY = 6  # ticks
FELT = np.uint32(Tick.FELT)
SUMS = ("paths", "left", "touched", "exchanged")


@dataclass(frozen=True)
class Subject:
    """One organ from USD; the runtime's fields of it by what they are for."""

    ground: Ground
    one: Field
    ways: Field
    stiff_one: Field
    stiff_ways: Field


def scaled(field: ResponseField, factor: float, offset: float) -> ResponseField:
    """`field` with energies and stiffnesses times `factor`, and another rho."""
    mu = field.friction_curves.curve_count
    by = np.where(
        np.arange(field.amplitudes.channel_count) < field.amplitudes.channel_count - mu, factor, 1.0
    )
    amplitudes = replace(field.amplitudes, coefficients=field.amplitudes.coefficients * by)
    return replace(field, amplitudes=amplitudes, tool=replace(field.tool, offset=offset))


def subject(contrast: float, nodes: int = 60, touches: int = 40) -> Subject:
    """An ellipsoid whose modulus varies by exp(2 contrast), written to USD and read back; touches recorded on it."""
    organ = KnownOrgan(contrast=contrast)
    points = 0.02 * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.int32)
    shape = OrganGeometry(
        "ellipsoid", points, faces, points, np.array([[0, 1, 2, 3]], np.int32),
        (Support("bottom", np.array([0, 1, 2], np.int32)),), ("tissue",), np.zeros(1, np.int32),
        np.arange(4, dtype=np.int32), {"model": "neo_hookean", "youngs_modulus": 5400.0, "poissons_ratio": 0.48},
    )  # fmt: skip
    with TemporaryDirectory() as folder:
        asset = write_asset(Path(folder), shape, as_cooked(field_of(organ, nodes)))
        truth = read_field(asset, "ball")

    def fields(times: float) -> tuple[Field, Field]:
        first, *others = (
            scaled(truth, times * factor, rho) for factor, rho in zip(WAYS.factor, WAYS.offset, strict=True)
        )
        tilted = list(zip(WAYS.cosine[1:], others, strict=True))
        return Field.open(cook(first)), Field.open(cook(first, tilted))

    one, ways = fields(1.0)
    return Subject(Ground.of(organ, truth, one, touches), one, ways, *fields(SWAPPED))


def run(subject: Subject, family: str, paths: int, rng: np.random.Generator) -> dict[str, dict[str, float]]:
    """Judges `paths` paths; what `table` says of a row, by kind of path."""
    rate = 10.0 ** rng.uniform(2.0, np.log10(8e4), paths)
    speed = 10.0 ** rng.uniform(-3.0, 0.0, paths)  # m/s
    step = np.clip(speed / rate, 1e-7, 3e-4)  # m; beyond, a walk would leave the cap
    tilt, swap, moving = (family in (name, FAMILIES[-1]) for name in FAMILIES[1:4])
    x, kind = paths_of(subject.ground, step, np.ptp(WAYS.offset) if tilt else 0.0, rng)
    states = np.zeros((paths, TICKS), dtype=STATE)
    states["size"], states["dt"] = STATE.itemsize, (1.0 / rate)[:, None]
    states["orientation"][..., 3] = states["organ_orientation"][..., 3] = 1.0
    states["flags"] = 0 if tilt else Input.POSITION_ONLY
    tool = Rotation.identity()
    if tilt:
        angle = np.cumsum(
            rng.normal(size=(paths, TICKS, 3)) * rng.choice([0.01, 0.1, 0.5], (paths, 1, 1)), axis=1
        )
        tool = Rotation.from_rotvec(angle.reshape(-1, 3))
        states["orientation"] = tool.as_quat().reshape(paths, TICKS, 4)
    states["position"] = x
    if moving:
        sway = np.cumsum(rng.normal(size=(paths, TICKS, 6)), axis=1) * step[:, None, None]
        pose = Rotation.from_rotvec((20.0 * sway[..., 3:]).reshape(-1, 3))  # rad; 20 / m of sway
        states["organ_position"] = sway[..., :3] + rng.normal(size=(paths, 1, 3))
        states["organ_orientation"] = pose.as_quat().reshape(paths, TICKS, 4)
        states["flags"] |= np.uint32(Input.ORGAN_POSE)
        states["position"] = pose.apply(x.reshape(-1, 3)).reshape(x.shape) + states["organ_position"]
        if tilt:
            states["orientation"] = (pose * tool).as_quat().reshape(paths, TICKS, 4)
    r = answers(subject, states, tilt, swap, rng)
    force, anchor = r["force"], r["anchor"]
    if moving:
        force = pose.inv().apply(force.reshape(-1, 3)).reshape(x.shape)
        anchor = pose.inv().apply((anchor - states["organ_position"]).reshape(-1, 3)).reshape(x.shape)
    scale = np.where((np.arange(TICKS) // SWAP_EVERY % 2 == 1) & swap, SWAPPED, 1.0)[None].repeat(paths, 0)
    whole = ((r["status"] & ~FELT) == 0).all(axis=1)  # rendered to its end
    verdict = judged(
        subject.ground.truth, WAYS, x[whole], force[whole], (x - anchor)[whole], r[whole], scale[whole]
    )
    return {name: _row(verdict, whole, kind == i) for i, name in enumerate(KINDS)}


def _row(verdict, whole: np.ndarray, mine: np.ndarray) -> dict[str, float]:
    of = mine[whole]
    created, exchanged, force_error, balance = (part[of] for part in verdict)
    share = np.divide(created, exchanged, out=np.zeros_like(created), where=exchanged > 1e-9)
    return {
        "paths": len(created),
        "left": int(mine.sum()) - len(created),
        "touched": int((exchanged > 0).sum()),
        "exchanged": float(exchanged.sum()),
        "created": float(created.max(initial=0.0)),
        "share": float(share.max(initial=0.0)),
        "force_error": float(force_error.max(initial=0.0)),
        "balance": float(balance.max(initial=0.0)),
    }


def configs(rng: np.random.Generator) -> list[Config]:
    """Friction 0, 1 and six between; each adhesion; a force limit in a quarter, the leak's cover in another."""
    return [
        Config(
            friction_coefficient=mu,
            speed_max=0.0,
            adhesion=Adhesion(adhesion),
            force_max=limit,
            passivity_control=cover,
        )
        for mu in (0.0, 1.0, *rng.uniform(0.0, 1.0, 6))
        for adhesion in range(1, 5)
        for limit, cover in ((0.0, False), (0.0, False), (10.0 ** rng.uniform(-2, 0), False), (0.0, True))
    ]  # fmt: skip


def answers(subject, states, tilt, swap, rng) -> np.ndarray:
    """(paths, TICKS) responses, each path from a fresh session; with `swap` another field from every 6th tick on."""
    lib = library()
    soft, stiff = (subject.ways, subject.stiff_ways) if tilt else (subject.one, subject.stiff_one)
    out = np.zeros(states.shape, dtype=RESPONSE)
    out["size"] = RESPONSE.itemsize
    sessions = [Session(soft, config) for config in configs(rng)]
    chosen = rng.integers(0, len(sessions), len(states))
    first_in, first_out = states.ctypes.data, out.ctypes.data
    length = SWAP_EVERY if swap else TICKS
    for i in range(len(states)):
        handle = sessions[chosen[i]]._handle
        lib.palpate_session_set_field(handle, soft.handle)
        lib.palpate_session_reset(handle)
        for part in range(0, TICKS, length):
            if part:
                lib.palpate_session_set_field(handle, (stiff if part // SWAP_EVERY % 2 else soft).handle)
            at = i * TICKS + part
            lib.palpate_tick_batch(
                handle, first_in + at * STATE.itemsize, first_out + at * RESPONSE.itemsize, length
            )
    return out


def table(
    paths: int,
    seed: int = 1,
    chunk: int = 2000,
    touches: int = 40,
    nodes: int = 60,
    tell: Callable[[dict], None] | None = None,
) -> list[dict]:
    """Rows by contrast, family and kind: paths judged, left (out of the field or refused: not judged), touched,
    exchanged (J, sum), created (J, largest), share (largest created / exchanged, of paths that exchange more than a
    nanojoule), force_error (N), balance (J, the runtime's own accounts)."""
    rng = np.random.default_rng(seed)
    rows = []
    each = -(-paths // (len(FAMILIES) * len(CONTRASTS)))
    for name, contrast in CONTRASTS.items():
        of = subject(contrast, nodes, touches)
        for family in FAMILIES:
            found: dict[str, dict] = {k: {"contrast": name, "family": family, "kind": k} for k in KINDS}
            judged_paths = 0
            while judged_paths < each:
                wanted = min(chunk, each - judged_paths + 50)  # some leave the field
                for k, row in run(of, family, wanted, rng).items():
                    merge(found[k], row)
                    judged_paths += row["paths"]
            rows += found.values()
            if tell:
                tell(merged(list(found.values())))
    return rows


def merge(into: dict, row: dict) -> None:
    for key, value in row.items():
        if not isinstance(value, str):
            into[key] = into.get(key, 0) + value if key in SUMS else max(into.get(key, 0.0), value)


def merged(rows: list[dict]) -> dict:
    whole = {
        key: rows[0][key] for key in ("contrast", "family", "kind") if len({row[key] for row in rows}) == 1
    }
    for row in rows:
        merge(whole, row)
    return whole


def line(r: dict) -> str:
    name = f"{r.get('contrast', ''):8} {r.get('family', r.get('kind', '')):11}"
    return (
        f"{name} {r['paths']:8} {r['left']:7} {r['touched']:8} {r['exchanged']:11.4g} {r['created']:9.2g} "
        f"{r['share']:12.2g} {r['force_error']:13.2g} {r['balance']:10.2g}"
    )


if __name__ == "__main__":
    start = time.monotonic()
    head = "   paths    left  touched exchanged/J created/J  of exchanged force error/N accounts/J"
    print("contrast family     " + head)
    done = table(
        int(sys.argv[1]) if len(sys.argv) > 1 else 15000,
        int(sys.argv[2]) if len(sys.argv) > 2 else 1,
        touches=400,
        tell=lambda r: print(f"{line(r)}  {time.monotonic() - start:6.0f} s", flush=True),
    )
    print("\n         kind       " + head)
    for kind in KINDS:
        print(line(merged([r for r in done if r["kind"] == kind])))
    worst = max(r["share"] for r in done)
    print(
        f"{sum(r['paths'] for r in done)} paths of {TICKS} ticks, largest share created {worst:.2g}, "
        f"{time.monotonic() - start:.0f} s"
    )
    sys.exit(0 if worst < 1e-9 else 1)
