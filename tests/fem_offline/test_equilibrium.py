# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
from types import SimpleNamespace

import numpy as np
import pytest

from palpate.fem_offline.assembly import ElementState
from palpate.fem_offline.body import FreeMotion
from palpate.fem_offline.equilibrium import EquilibriumError, equilibrate
from palpate.fem_offline.linear_solver import NotPositiveDefiniteError


class Chain(FreeMotion):
    """Two nodes on springs with energy sum k/2 u^2 + c/4 u^4 + d u: an equilibrium known by hand."""

    def __init__(self, k, c=0.0):
        self.k, self.c = k, c
        self.nodes = np.zeros((2, 3))
        self.equation = np.arange(6)
        self.equation_count = 6
        self.shifts = []

    def state(self, u):
        energy = float(np.sum(0.5 * self.k * u**2 + 0.25 * self.c * u**4))
        return ElementState(energy, self.k * u + self.c * u**3, 1.0)

    def linearise(self, u, contact, shift, stuck=False):
        self.shifts.append(shift)
        self.diagonal = (self.k + 3 * self.c * u**2).ravel() + shift * (abs(self.k) + 1.0)
        if self.diagonal.min() <= 0.0:
            raise NotPositiveDefiniteError

    def solve(self, b, tolerance):
        return b / self.diagonal


class Pull:
    """A dead load of 1 N on every component."""

    def state(self, u):
        return SimpleNamespace(
            energy=-float(u.sum()), gradient=-np.ones((2, 3)), force=np.array([0.0, 0.0, 1.0])
        )

    def hessian(self, u, geometric):
        return None


def test_linear_springs_take_one_step():
    found = equilibrate(Chain(4.0), Pull(), np.zeros((2, 3)), 1e-12, 1.0)
    assert found.u == pytest.approx(np.full((2, 3), 0.25), rel=1e-12)
    assert found.iterations == 1 and found.residual <= 1e-12


def test_stiffening_springs_reach_their_root():
    """k u + c u^3 = 1 with k = 1, c = 8: 8 u^3 + u - 1 = 0."""
    found = equilibrate(Chain(1.0, 8.0), Pull(), np.full((2, 3), 3.0), 1e-12, 1.0)
    root = np.roots([8.0, 0.0, 1.0, -1.0])
    assert found.u == pytest.approx(np.full((2, 3), root[np.isreal(root)].real[0]), rel=1e-10)


def test_an_indefinite_start_is_shifted_until_it_descends():
    """k = -1, c = 1: a double well; from u = 0.1 the Hessian is negative, the minimum lies beyond u = 1."""
    chain = Chain(-1.0, 1.0)
    found = equilibrate(chain, Pull(), np.full((2, 3), 0.1), 1e-10, 1.0)
    assert max(chain.shifts) > 0.0
    assert found.u == pytest.approx(np.full((2, 3), 1.3247179572447460), rel=1e-9)  # u^3 - u - 1 = 0


def test_failing_to_converge_is_an_error_that_says_so():
    with pytest.raises(EquilibriumError, match="no convergence in 2 Newton steps"):
        equilibrate(Chain(1.0, 8.0), Pull(), np.full((2, 3), 30.0), 1e-12, 1.0, iterations_max=2)


def test_a_hessian_that_nothing_mends_is_an_error():
    class Hopeless(Chain):
        def linearise(self, u, contact, shift, stuck=False):
            raise NotPositiveDefiniteError

    with pytest.raises(EquilibriumError, match="positive definite"):
        equilibrate(Hopeless(1.0), Pull(), np.zeros((2, 3)), 1e-9, 1.0)


def test_inverted_starts_are_refused():
    class Inverted(Chain):
        def state(self, u):
            return ElementState(np.inf, np.zeros((2, 3)), -1.0)

    with pytest.raises(EquilibriumError, match="inverted"):
        equilibrate(Inverted(1.0), Pull(), np.zeros((2, 3)), 1e-9, 1.0)


def test_energy_noise_does_not_stop_convergence():
    """The sum over a whole body rounds at 1e-16 mu V, which hides the last decreases of a small contact's energy."""

    class Noisy(Chain):
        def state(self, u):
            clean = super().state(u)
            noise = 1e-9 * np.sin(1e12 * float(np.sum(u)))
            return ElementState(clean.energy + noise, clean.force, 1.0)

    found = equilibrate(Noisy(1.0, 8.0), Pull(), np.full((2, 3), 1.0), 1e-11, 1.0, iterations_max=20)
    assert found.residual <= 1e-11
