# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Print how far fields are from organs that are known exactly: `python tests/fields/field_accuracy.py`."""

from __future__ import annotations

import sys
from time import process_time

import numpy as np
from known_organ import BALL, FLAT, KnownOrgan, field_of, geometry_of, held_out, nodes_of

from palpate.fields.interpolation import evaluate


def errors(organ: KnownOrgan, count: int, noise: float, with_gradients: bool) -> tuple[float, ...]:
    """p50, p95 and maximum of normal and of lateral error against the normal force at the same place; seconds."""
    geometry_of(organ), nodes_of(organ, count, noise, 2)
    start = process_time()
    field = field_of(organ, count, noise, 2, with_gradients=with_gradients)
    seconds = process_time() - start
    q, n = held_out(organ)
    true, said = organ.force(q), evaluate(field, q).force
    size = np.sum(true * n, axis=1)
    normal = np.sum((said - true) * n, axis=1)
    lateral = np.linalg.norm(said - true - normal[:, None] * n, axis=1) / size
    normal = np.abs(normal) / size
    return (*np.quantile(normal, [0.5, 0.95, 1.0]), *np.quantile(lateral, [0.5, 0.95, 1.0]), seconds)


def main(counts: list[int]) -> None:
    print("organ      nodes  noise  B     normal % p50   p95   max   lateral % p50   p95   max   build s")
    for name, organ in (("sphere", KnownOrgan(BALL)), ("ellipsoid", KnownOrgan(FLAT))):
        for count in counts:
            for noise in (0.0, 0.005):
                for with_gradients in (True, False):
                    e = errors(organ, count, noise, with_gradients)
                    percent = (
                        "".join(f"{100 * x:8.2f}" for x in e[:3])
                        + "     "
                        + "".join(f"{100 * x:8.2f}" for x in e[3:6])
                    )
                    used = "yes" if with_gradients else "no"
                    print(
                        f"{name:10} {count:5d} {100 * noise:5.1f}%  {used:4}  {percent} {e[6]:8.1f}",
                        flush=True,
                    )


if __name__ == "__main__":
    main([int(a) for a in sys.argv[1:]] or [12, 25, 50, 100])
