# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Print what nodes are worth that were chosen by error, beside as many spread evenly.

    python tests/benchmarks/sampling.py [--seeds 1,2,3] [--tolerance 0.02] [--most 160] [--no-nodule] [--unaware]

The reach is known everywhere (tests/fields/known_terrain.py).  `even` is farthest points with the same kriging,
`even, one length` what kriging without a rough part makes of the same nodes.  --unaware: nobody says that there is
a nodule.  Errors of force in percent, 95th percentile / worst.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from time import process_time

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "fields"))

from known_terrain import RADIUS, KnownTerrain

from palpate.author.sampling_by_error import SamplingByError
from palpate.fields import kriging

COUNTS = (50, 65, 80, 100, 125, 150, 200, 250)
WIDTH = 4


def shown(error: dict[str, tuple[float, float]]) -> str:
    return "   ".join(f"{name} {100 * p95:5.2f} /{100 * worst:6.2f}" for name, (p95, worst) in error.items())


def even(known: KnownTerrain, most: int) -> None:
    for count in COUNTS:
        if count > most:
            return
        index = known.terrain.even[:count]
        both = known.errors(known.kriged(index))
        believed, kriging.EVIDENCE = kriging.EVIDENCE, np.inf
        one = known.errors(known.kriged(index))
        kriging.EVIDENCE = believed
        print(
            f"  even {count:4d}                          {shown(both)}   | one length {shown(one)}",
            flush=True,
        )


def by_error(known: KnownTerrain, seeds: int, tolerance: float, most: int, unaware: bool) -> None:
    sampling = SamplingByError(known.terrain, known.geometry, RADIUS, tolerance, most)
    index = known.terrain.even[:seeds].tolist()
    if known.nodule and not unaware:
        index.append(int(np.argmin(np.linalg.norm(known.terrain.position - known.nodule_at, axis=1))))
    started, told, under_way = process_time(), 0, []
    while True:
        chosen = sampling.choose(known.nodes(index), index, under_way, WIDTH).tolist()
        last = sampling.rounds[-1]
        if sampling.ended or sum(len(index) >= count for count in COUNTS) > told:
            told = sum(len(index) >= count for count in COUNTS)
            estimate = f"estimate {100 * last.estimate:5.2f} /{100 * last.worst:6.2f}"
            found = shown(known.errors(sampling._sites))
            spent = process_time() - started
            print(
                f"  chosen {len(index):4d} {estimate}  {found}   {spent:.0f} s {sampling.ended}", flush=True
            )
        if sampling.ended:
            return
        index += under_way
        under_way = chosen


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--begin", type=int, default=45)
    parser.add_argument("--tolerance", type=float, default=0.02)
    parser.add_argument("--most", type=int, default=160)
    parser.add_argument("--no-nodule", action="store_true")
    parser.add_argument("--unaware", action="store_true")
    parser.add_argument("--only", choices=("even", "chosen"))
    a = parser.parse_args()
    for seed in map(int, a.seeds.split(",")):
        known = KnownTerrain(seed, nodule=not a.no_nodule)
        print(f"reach {seed}, {'no ' if a.no_nodule else ''}nodule", flush=True)
        if a.only != "chosen":
            even(known, 10 * a.most)
        if a.only != "even":
            by_error(known, a.begin, a.tolerance, a.most, a.unaware)


if __name__ == "__main__":
    main()
