# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What batching gains on this machine: kernels against systems in a launch, presses against presses at once.

    python tests/benchmarks/batch.py --device cuda --sizes 1,2,4,8,16,32,64

Kernels need NumPy, SciPy and Warp alone, from a checkout or an installed palpate; presses also need libigl and mmgpy,
and Pardiso to be worth a look.  Nothing is asserted.  The first launch compiles and is left out.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import itertools
import os
import platform
import sys
import threading
import time
import types
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import numpy as np  # noqa: E402

try:
    importlib.import_module("palpate.fem_offline")
except ModuleNotFoundError:  # a checkout's folders are the package's
    package = types.ModuleType("palpate")
    package.__path__ = [str(Path(__file__).resolve().parents[2])]
    sys.modules["palpate"] = package

import warp as wp  # noqa: E402

from palpate.fem_offline import linear_solver  # noqa: E402
from palpate.fem_offline.assembly import ElementSystem, states  # noqa: E402
from palpate.fem_offline.batch import Batch  # noqa: E402
from palpate.fem_offline.hessian_pattern import hessian_pattern  # noqa: E402
from palpate.fem_offline.material import NeoHookean  # noqa: E402
from palpate.fem_offline.quadratic_space import QuadraticSpace, quadratic_space  # noqa: E402

SOFT = NeoHookean(5400.0, 0.48)
SECONDS = 0.5
"""s that a kernel is launched again and again."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--device", default="cpu", help="cpu, cuda or cuda:0")
    parser.add_argument("--sizes", default="1,2,4", help="systems in a launch, and presses at once")
    parser.add_argument("--cells", type=int, default=7, help="cells along a cube's edge; six tetrahedra each")
    parser.add_argument("--gather", type=float, default=0.0, help="s that a launch waits for more")
    parser.add_argument("--depths", type=int, default=4, help="of a press; 0: no presses")
    given = parser.parse_args()
    sizes = [int(size) for size in given.sizes.split(",")]
    with Batch(given.device):
        print(f"machine: {_processor()}, {os.cpu_count()} cores; device: {wp.get_device(given.device).name}")
    kernels(given.device, sizes, given.cells)
    missing = [name for name in ("igl", "mmgpy") if importlib.util.find_spec(name) is None]
    if missing:
        print(f"presses: not measured, {' and '.join(missing)} not installed")
    elif given.depths:
        presses(given.device, sizes, given.depths, given.gather)


def kernels(device: str, sizes: list[int], cells: int) -> None:
    """Tetrahedra per second through state and Hessian, copies to and from the device included."""
    space = cube(cells)
    pattern = hessian_pattern(space.elements, np.zeros(3 * space.node_count, bool), [])
    whole = np.ones((len(space.elements), 1))
    u = 1e-5 * np.random.default_rng(0).standard_normal(space.nodes.shape)
    print(f"\nkernels, {len(space.elements)} tetrahedra a system: million tetrahedra per second")
    print("systems   state  hessian")
    for size in sizes:
        systems = [ElementSystem(space, [SOFT], whole, device=device) for _ in range(size)]
        state = per_call(lambda: states([(system, u) for system in systems]))  # noqa: B023
        hessian = per_call(lambda: ElementSystem.hessians([(system, u, pattern) for system in systems]))  # noqa: B023
        count = 1e-6 * size * len(space.elements)
        print(f"{size:7d} {count / state:7.3f} {count / hessian:8.3f}", flush=True)


def presses(device: str, sizes: list[int], depth_count: int, gather: float) -> None:
    """As many presses at once as a batch has threads, each where no other one is."""
    from palpate.fem_offline.press import press
    from palpate.fem_offline.site import open_site, patch_size
    from palpate.fem_offline.tool import Sphere
    from palpate.fem_offline.verification.blocks import block_organ

    organ = block_organ((0.06, 0.06, 0.03), (8, 8, 4), {0: SOFT})
    tool, depths = Sphere(5e-3), 3e-3 * np.arange(1, depth_count + 1) / depth_count
    size_of_patch = patch_size(tool, depths[-1], radius=12e-3)

    def one(batch: Batch, place: np.ndarray) -> int:
        with batch.member():
            record = press(open_site(organ, place, tool, size_of_patch), tool, depths)
        assert record.converged, record.reason
        return record.unknowns

    print(
        f"\npresses of {depth_count} depths; shares of wall time: device busy, a thread in factors and solves"
    )
    print("at once  unknowns  presses/min  evaluations/s  evaluations/launch  device  solver")
    for size in sizes:
        places = [np.array([1e-3 * (k % 8), 1e-3 * (k // 8), 0.0]) for k in range(size)]
        with Batch(device, gather) as batch, ThreadPoolExecutor(size) as threads, timed_solver() as solver:
            begun = time.perf_counter()
            unknowns = list(threads.map(one, itertools.repeat(batch), places))
            wall = time.perf_counter() - begun
        print(
            f"{size:7d} {np.mean(unknowns):9.0f} {60 * size / wall:12.1f} {batch.requests / wall:14.1f}"
            f" {batch.requests / batch.launches:19.2f} {batch.busy / wall:7.2f} {sum(solver) / size / wall:7.2f}",
            flush=True,
        )


def cube(cells: int) -> QuadraticSpace:
    """10 mm of regular tetrahedra, six in each cell (Kuhn's): one for each order of the axes."""
    n = cells + 1
    points = np.stack(np.meshgrid(*[np.linspace(0.0, 0.01, n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    step = np.array([n * n, n, 1])
    cell = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) @ step
    tets = []
    for order in itertools.permutations(range(3)):
        corners = np.cumsum([0, *step[list(order)]])
        even = np.linalg.det(np.eye(3)[list(order)]) > 0
        tets.append(cell[:, None] + (corners if even else corners[[0, 2, 1, 3]]))
    return quadratic_space(points, np.concatenate(tets))


def per_call(call) -> float:
    """s of one call, after a first one."""
    call()
    begun, count = time.perf_counter(), 0
    while (spent := time.perf_counter() - begun) < SECONDS or count < 2:
        call()
        count += 1
    return spent / count


@contextmanager
def timed_solver() -> Iterator[list[float]]:
    """s of each factorisation and solve, all threads'."""
    found: list[float] = []
    lock = threading.Lock()

    def timed(method):
        def run(*args):
            begun = time.perf_counter()
            try:
                return method(*args)
            finally:
                with lock:
                    found.append(time.perf_counter() - begun)

        return run

    kept = {name: getattr(linear_solver.Factor, name) for name in ("factorise", "solve")}
    for name, method in kept.items():
        setattr(linear_solver.Factor, name, timed(method))
    try:
        yield found
    finally:
        for name, method in kept.items():
            setattr(linear_solver.Factor, name, method)


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    names = (
        [line.split(":")[1].strip() for line in info.read_text().splitlines() if "model name" in line]
        if info.exists()
        else []
    )
    return f"{platform.node()}, {names[0] if names else platform.processor() or platform.machine()}"


if __name__ == "__main__":
    main()
