# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Random paths by the hundred thousand: is energy created?  `python tests/seams/energy_paths.py PATHS` prints a table.

Fields go through a USD asset; potential, gradient and friction stiffness are evaluated here from what USD holds.  Of
the runtime's answers only what it sent and the state it says it is in are used: force f, anchor (stretch s), yielded
surface o, way of touching c.  With E(q; c, o) = U at depth rho(c) - phi(q) - o, each tick has to obey

    created = dE + d(k |s|^2 / 2) + f . dq - hold <= 0,
    hold    = E(q'; c, o) - E(q; c, o) - grad E . dq + k |P dq|^2 / 2

(the zero-order hold's own terms), in the organ's axes; created is summed over a path and held against the energy that
the path exchanged, sum |f . dq|.  Drawn at random for each path: friction 0 to 1, adhesion function, rate 100 Hz to
80 kHz, speed 1 mm/s to 1 m/s; by row contrasts of stiffness 1:1, 6:1, 100:1; by family tilts of the tool, changes to a
field four times as stiff and back, a moving organ.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial.transform import Rotation

sys.path.insert(0, str(Path(__file__).parents[1] / "fields"))
from known_organ import KnownOrgan, field_of
from rfield_evaluation import curves_at

from palpate.fields.as_cooked import as_cooked
from palpate.fields.cook import cook
from palpate.fields.lattice import Lattice
from palpate.fields.organ_geometry import OrganGeometry, Support
from palpate.fields.response_field import ResponseField
from palpate.fields.usd_read import read_field
from palpate.fields.usd_write import write_asset
from palpate.runtime import Adhesion, Config, Field, Session, Tick
from palpate.runtime.layout import RESPONSE, STATE, Input
from palpate.runtime.library import library

TICKS = 24
FAMILIES = ("plain", "tilt", "swap", "organ", "all at once")
CONTRASTS = {"1:1": 0.0, "6:1": 0.5 * np.log(6.0), "100:1": 0.5 * np.log(100.0)}
COSINES, FACTORS, OFFSETS = (
    np.array([1.0, 0.8, 0.5]),
    np.array([1.0, 0.5, 2.0]),
    np.array([5e-3, 4.8e-3, 4.9e-3]),
)
SWAPPED = 4.0  # powers of two: scaled amplitudes are then exact in float32
FELT = np.uint32(Tick.FELT)


@dataclass(frozen=True)
class Subject:
    """One organ from USD; the runtime's fields of it by what they are for."""

    organ: KnownOrgan
    truth: ResponseField
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


def subject(contrast: float, nodes: int = 60) -> Subject:
    """An ellipsoid whose modulus varies by exp(2 contrast), written to USD and read back."""
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
        first = scaled(truth, times, OFFSETS[0])
        tilted = [
            (c, scaled(truth, times * f, o)) for c, f, o in zip(COSINES, FACTORS, OFFSETS, strict=True)
        ][1:]
        return Field.open(cook(first)), Field.open(cook(first, tilted))

    return Subject(organ, truth, *fields(1.0), *fields(SWAPPED))


def walks(organ: KnownOrgan, rng: np.random.Generator, step: np.ndarray, drop: float) -> np.ndarray:
    """(n, TICKS, 3) m: from just above the cap into it, then with inertia; every second one returns the way it came.

    Contact comes from above the way that reaches farthest; over five ticks the tool sinks by `drop` (m) as well, so
    that the other ways touch however small the step.
    """
    n = len(step)
    c = organ.random_cap(n, rng, 14e-3)
    out = organ.normal(c)
    v = rng.normal(size=(n, TICKS - 1, 3)) * 0.4
    for i in range(1, TICKS - 1):
        v[:, i] += 0.9 * v[:, i - 1]
    v[:, :5] -= 1.2 * out[:, None]
    start = c + (5e-3 + 0.5 * step[:, None]) * out
    q = np.concatenate([start[:, None], start[:, None] + np.cumsum(v * step[:, None, None], axis=1)], axis=1)
    q -= (drop * np.minimum(np.arange(TICKS) / 5.0, 1.0))[:, None] * out[:, None]
    half = TICKS // 2
    q[::2, half:] = q[::2, half - 1 :: -1][:, : TICKS - half]
    return q


def lattice_at(lattice: Lattice, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All channels (n, c), their gradients (n, 3, c), and whether all 27 coefficients are stored (n,)."""
    parts = [_lattice_at(lattice, q[i : i + 1024]) for i in range(0, len(q), 1024)]
    return tuple(np.concatenate(part) for part in zip(*parts, strict=True))


def _lattice_at(lattice: Lattice, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    u = (q - lattice.origin) / lattice.spacing
    cell = np.floor(u).astype(int)
    t = u - cell
    w = np.stack([0.5 * (1 - t) ** 2, 0.5 + t * (1 - t), 0.5 * t**2], axis=1)  # (n, tap, axis)
    d = np.stack([t - 1, 1 - 2 * t, t], axis=1) / lattice.spacing
    j = cell[:, None, :] + np.arange(3)[:, None]
    shape = np.array(lattice.block_index.shape)
    within = ((j >= 0) & (j < 4 * shape)).all(axis=(1, 2))
    j = np.where(within[:, None, None], j, 0)
    b, p = j // 4, j % 4
    at = (b[:, :, None, None, 0] * shape[1] + b[:, None, :, None, 1]) * shape[2] + b[:, None, None, :, 2]
    row = np.where(within[:, None, None, None], lattice.block_index.ravel()[at], -1)
    place = (p[:, :, None, None, 0] * 4 + p[:, None, :, None, 1]) * 4 + p[:, None, None, :, 2]
    flat = lattice.coefficients.reshape(-1, lattice.channel_count)
    c = flat[np.maximum(row, 0) * 64 + place] * (row >= 0)[..., None]  # (n, 3, 3, 3, c)
    weights = [np.einsum("ni,nj,nk->nijk", *(v[:, :, x] for x, v in enumerate(o))).reshape(len(q), 27)
               for o in ((w, w, w), (d, w, w), (w, d, w), (w, w, d))]  # fmt: skip
    sums = np.stack(weights, axis=1) @ c.reshape(len(q), 27, -1)  # (n, 4, c)
    return sums[:, 0], sums[:, 1:], (row >= 0).all(axis=(1, 2, 3))


def run(subject: Subject, family: str, paths: int, rng: np.random.Generator) -> dict[str, float]:
    """Judges `paths` paths; see `table` for what comes back."""
    rate = 10.0 ** rng.uniform(2.0, np.log10(8e4), paths)
    speed = 10.0 ** rng.uniform(-3.0, 0.0, paths)  # m/s
    step = np.clip(speed / rate, 1e-7, 6e-4)  # m; beyond, 24 ticks would leave the cap
    friction = rng.choice([0.0, 0.05, 0.1, 0.3, 1.0], paths)
    tilt, swap, moving = (family in (name, FAMILIES[-1]) for name in FAMILIES[1:4])
    x = walks(subject.organ, rng, step, np.ptp(OFFSETS) if tilt else 0.0)
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
    r = answers(subject, states, friction, tilt, swap, rng.integers(1, 5, paths))
    force, anchor = r["force"], r["anchor"]
    if moving:
        force = pose.inv().apply(force.reshape(-1, 3)).reshape(x.shape)
        anchor = pose.inv().apply((anchor - states["organ_position"]).reshape(-1, 3)).reshape(x.shape)
    times = np.where((np.arange(TICKS) // 6 % 2 == 1) & swap, SWAPPED, 1.0)[None].repeat(paths, 0)
    return judged(subject, x, force, x - anchor, r, times)


def answers(subject, states, friction, tilt, swap, adhesion) -> np.ndarray:
    """(paths, TICKS) responses, each path from a fresh session; with `swap` another field from every 6th tick on."""
    lib = library()
    soft, stiff = (subject.ways, subject.stiff_ways) if tilt else (subject.one, subject.stiff_one)
    out = np.zeros(states.shape, dtype=RESPONSE)
    out["size"] = RESPONSE.itemsize
    sessions = {
        (mu, kind): Session(soft, Config(friction_coefficient=mu, speed_max=0.0, adhesion=Adhesion(kind)))
        for mu in np.unique(friction)
        for kind in range(1, 5)
    }
    first_in, first_out = states.ctypes.data, out.ctypes.data
    parts = range(0, TICKS, 6) if swap else (0,)
    length = 6 if swap else TICKS
    for i in range(len(states)):
        handle = sessions[friction[i], adhesion[i]]._handle
        lib.palpate_session_set_field(handle, soft.handle)
        lib.palpate_session_reset(handle)
        for part in parts:
            if part:
                lib.palpate_session_set_field(handle, (stiff if part // 6 % 2 else soft).handle)
            at = i * TICKS + part
            lib.palpate_tick_batch(
                handle, first_in + at * STATE.itemsize, first_out + at * RESPONSE.itemsize, length
            )
    return out


def judged(subject, x, force, s, r, times) -> dict[str, float]:
    """The law of the module's docstring for every path that was rendered to its end."""
    whole = ((r["status"] & ~FELT) == 0).all(axis=1)
    x, force, s, r, times = x[whole], force[whole], s[whole], r[whole], times[whole]
    paths = len(x)
    truth = subject.truth
    phi, dphi, known = lattice_at(truth.geometry.signed_distance, x.reshape(-1, 3))
    a, da, _ = lattice_at(truth.amplitudes, x.reshape(-1, 3))
    ru, rk = truth.energy_curves.curve_count, truth.stiffness_curves.curve_count
    dphi = dphi[..., 0]

    def evaluated(c, o, scale):
        """E (paths, ticks) J, its gradient N and k N/m, at the way, the offset and the field's scale."""
        factor = scale * np.interp(c, COSINES[::-1], FACTORS[::-1])
        depth = (np.interp(c, COSINES[::-1], OFFSETS[::-1]) - o).ravel() - phi[:, 0]
        value, slope = curves_at(truth.energy_curves, np.maximum(depth, 0.0))
        stiffness, _ = curves_at(truth.stiffness_curves, np.maximum(depth, 0.0))
        by = np.where((depth > 0) & known, factor.ravel(), 0.0)
        energy = by * np.einsum("nr,nr->n", value, a[:, :ru])
        gradient = np.einsum("nr,nir->ni", value, da[..., :ru])
        gradient -= np.einsum("nr,nr->n", slope, a[:, :ru])[:, None] * dphi
        k = np.maximum(by * np.einsum("nr,nr->n", stiffness, a[:, ru : ru + rk]), 0.0)
        return energy.reshape(x.shape[:2]), (by[:, None] * gradient).reshape(x.shape), k.reshape(x.shape[:2])

    c, o = r["way_cosine"], r["surface_offset"]
    energy, gradient, k = evaluated(c, o, times)

    def before(v):
        return np.concatenate([v[:, :1], v[:, :-1]], axis=1)

    moved = evaluated(before(c), before(o), before(times))[0][:, 1:]
    length = np.linalg.norm(dphi, axis=1, keepdims=True)
    normal = (dphi / np.where(length > 0, length, 1.0)).reshape(x.shape)
    dq = np.diff(x, axis=1)
    across = dq - np.sum(dq * normal[:, :-1], axis=2, keepdims=True) * normal[:, :-1]
    stored = energy + 0.5 * k * np.sum(s * s, axis=2)
    hold = moved - energy[:, :-1] - np.sum(gradient[:, :-1] * dq, axis=2)
    hold += 0.5 * k[:, :-1] * np.sum(across * across, axis=2)
    work = -np.sum(force[:, :-1] * dq, axis=2)
    created = np.cumsum(np.diff(stored, axis=1) - work - hold, axis=1).max(axis=1, initial=0.0)
    exchanged = np.abs(work).sum(axis=1) + stored.max(axis=1)
    balance = r["work_in"] + r["organ_work"] + r["hold_leak"] - r["stored_energy"] - r["dissipated_friction"]
    balance = np.abs(balance - r["dissipated_rule"])[:, -1]
    touched = exchanged > 0
    share = np.divide(created, exchanged, out=np.zeros(paths), where=touched)
    return {
        "paths": paths,
        "left": int(len(whole) - paths),
        "touched": int(touched.sum()),
        "exchanged": float(exchanged.sum()),
        "created": float(created.max(initial=0.0)),
        "share": float(np.where(exchanged > 1e-9, share, 0.0).max(initial=0.0)),
        "force_error": float(np.abs(force + gradient + k[..., None] * s).max(initial=0.0)),
        "balance": float(balance.max(initial=0.0)),
    }


def table(paths: int, seed: int = 1, chunk: int = 2000, tell=None) -> list[dict]:
    """Rows by family and contrast: paths judged, left (out of the field or refused: not judged), touched, exchanged (J,
    sum), created (J, largest), share (largest created / exchanged, of paths that exchange more than a nanojoule),
    force_error (N), balance (J, the runtime's own accounts)."""
    rng = np.random.default_rng(seed)
    rows = []
    each = -(-paths // (len(FAMILIES) * len(CONTRASTS)))
    for name, contrast in CONTRASTS.items():
        of = subject(contrast)
        for family in FAMILIES:
            row: dict = {"contrast": name, "family": family}
            while row.get("paths", 0) + row.get("left", 0) < each:
                found = run(of, family, min(chunk, each), rng)
                for key, value in found.items():
                    add = key in ("paths", "left", "touched", "exchanged")
                    row[key] = row.get(key, 0) + value if add else max(row.get(key, 0.0), value)
            rows.append(row)
            if tell:
                tell(row)
    return rows


if __name__ == "__main__":
    start = time.monotonic()
    print(
        "contrast family      judged    left touched exchanged/J created/J  of exchanged force error/N accounts/J"
    )
    done = table(
        int(sys.argv[1]) if len(sys.argv) > 1 else 15000,
        tell=lambda r: print(
            f"{r['contrast']:8} {r['family']:11} {r['paths']:7} {r['left']:6} {r['touched']:7} {r['exchanged']:11.4g} "
            f"{r['created']:9.2g} {r['share']:12.2g} {r['force_error']:13.2g} {r['balance']:10.2g}",
            flush=True,
        ),
    )
    judged_paths = sum(r["paths"] for r in done)
    worst = max(r["share"] for r in done)
    print(
        f"{judged_paths} paths of {TICKS} ticks, largest share created {worst:.2g}, {time.monotonic() - start:.0f} s"
    )
    sys.exit(0 if worst < 1e-9 else 1)
