# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A stylus device that is known exactly: what identification and assessment are held against.

Motor, arm and stylus are three masses on a line with springs between them and a hand on the last one:

    m1 x1'' = f - c1 x1' - k1 (x1 - x2)
    m2 x2'' = k1 (x1 - x2) - c2 x2' - k2 (x2 - x3)
    m3 x3'' = k2 (x2 - x3) - c3 x3' - z,       z' = kh (x3' - u') - (kh / bh) z

x is the motion into the sample, f the motor's force `delay` after the command, z the hand: a spring kh in series with a
damper bh (Maxwell), whose far end moves at the hand's own speed u'.  From f to x3'' that is a transfer
function of order 7 and
relative degree 4, as the paper's empirical model of its PHANTOM.  The springs put the first resonance at 130
Hz (its figure 3)
and the second where `second` says; the masses are a choice of this project, such that a tap that stops the tip
rings near the
66 Hz which the paper reports for wood on foam.  Limits: one direction, no gravity, no dry friction, amplifiers
without dynamics.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Stylus"]

X1, X2, X3, V1, V2, V3, Z = range(7)


@dataclass(frozen=True)
class Stylus:
    """A device with its hand.

    Attributes:
        masses: (m1, m2, m3) kg; dampings: (c1, c2, c3) N s/m; resonance, second: Hz, of the chain without hand.
        hand_stiffness: N/m, kh; hand_damping: N s/m, bh.
        delay: s, from a command to the motor's force; rate: Hz, of the loop, whose commands are held.
        force_max: N, the amplifier's limit; force_steady: N, what the motors bear for ever.
        quantum: m, of the encoder, which sits at the motor; noise: m/s2, standard deviation of the accelerometer.
    """

    masses: tuple[float, float, float] = (0.075, 0.015, 0.035)
    dampings: tuple[float, float, float] = (8.0, 1.0, 4.0)
    resonance: float = 130.0
    second: float = 700.0
    hand_stiffness: float = 1500.0
    hand_damping: float = 6.0
    delay: float = 0.25e-3
    rate: float = 10_000.0
    force_max: float = 8.5
    force_steady: float = 1.4
    quantum: float = 30e-6
    noise: float = 0.05

    @property
    def springs(self) -> tuple[float, float]:
        """(k1, k2) N/m that put the free chain's modes at `resonance` and `second`.

        With w^2 the roots of m1 m2 m3 w^4 - (k1 m3 (m1 + m2) + k2 m1 (m2 + m3)) w^2 + k1 k2 (m1 + m2 + m3) = 0.
        """
        m1, m2, m3 = self.masses
        low, high = ((2.0 * np.pi * f) ** 2 for f in (self.resonance, self.second))
        total, product = (low + high) * m1 * m2 * m3, low * high * m1 * m2 * m3 / (m1 + m2 + m3)
        a, b = m3 * (m1 + m2), m1 * (m2 + m3)  # a k1 + b k2 = total, k1 k2 = product
        root = total**2 - 4.0 * a * b * product
        if root < 0.0:
            raise ValueError("these masses cannot have those two resonances: move the second one up")
        k1 = (total - np.sqrt(root)) / (2.0 * a)
        return float(k1), float(product / k1)

    def matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """(7, 7) and (7, 3): state (x1 x2 x3 v1 v2 v3 z), inputs (motor force N, force on the tip N, hand's
        speed m/s)."""
        (m1, m2, m3), (c1, c2, c3), (k1, k2) = self.masses, self.dampings, self.springs
        kh, bh = self.hand_stiffness, self.hand_damping
        a, b = np.zeros((7, 7)), np.zeros((7, 3))
        a[X1, V1] = a[X2, V2] = a[X3, V3] = 1.0
        a[V1, [X1, X2, V1]] = np.array([-k1, k1, -c1]) / m1
        a[V2, [X1, X2, X3, V2]] = np.array([k1, -k1 - k2, k2, -c2]) / m2
        a[V3, [X2, X3, V3, Z]] = np.array([k2, -k2, -c3, -1.0]) / m3
        a[Z, V3], a[Z, Z] = kh, -kh / bh
        b[V1, 0], b[V3, 1], b[Z, 2] = 1.0 / m1, 1.0 / m3, -kh
        return a, b

    def transfer(self, frequency: np.ndarray) -> np.ndarray:
        """(n,) complex, (m/s2)/N: acceleration of the tip over commanded force at `frequency` (n,) Hz, delay
        included."""
        a, b = self.matrices()
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        states = np.linalg.solve(s[:, None, None] * np.eye(7) - a, np.broadcast_to(b[:, :1], (len(s), 7, 1)))
        return s**2 * states[:, X3, 0] * np.exp(-s * self.delay)
