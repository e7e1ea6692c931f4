# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Response curves anywhere on the surface, kriged from the nodes.

    y(c, d) = log(Phi / d^2.5),   y' = dy/dd = f / Phi - 2.5 / d
    grad_c y = (I + s W) B / Phi,   s = rho - d        (surface_curvature.py)

y and y' at all knots are columns of one kriging operator, so energy and force belong together everywhere.
Between knots y is the cubic through y and y'; below the first knot, Phi is a power of d.
k and mu are kriged as logarithms, without gradients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from palpate.fields.kriging import Kriging, KrigingSettings, embed, fit_kriging
from palpate.fields.node_fit import relative_gradient
from palpate.fields.response_field import ContactGeometry, ResponseNodes
from palpate.fields.surface_curvature import shape_operator, tangent_frame

__all__ = ["Curves", "SiteCurves", "embedded_directions"]

HERTZ = 2.5
"""Exponent of a rounded tool's energy in depth; any tool may deviate, y then varies more."""
FELT = 0.05
"""Share of the deepest force from which a knot's data choose the kriging's settings."""
EXPONENT_RANGE = (2.0, 4.0)
"""Powers of d believed below the first knot: a flat punch has 2, a cone 3."""


def embedded_directions(normal: np.ndarray, shape: np.ndarray, normal_length: float) -> np.ndarray:
    """(N, 2, 6) how embedded surface points move along their tangents; shape operators `shape` (N, 3, 3) 1/m."""
    e = tangent_frame(normal)
    return np.concatenate([e, normal_length * np.einsum("nij,ntj->nti", shape, e)], axis=2)


@dataclass(frozen=True)
class Curves:
    """Predicted curves of S sites.

    Attributes:
        energy: (S, J) J at the depths asked for.
        force: (S, J) N there.
        friction_stiffness: (S, M + 1) N/m, at depth 0 and every second depth asked for.
        friction_coefficient: (S, M + 1), likewise.
    """

    energy: np.ndarray
    force: np.ndarray
    friction_stiffness: np.ndarray
    friction_coefficient: np.ndarray


@dataclass(frozen=True)
class SiteCurves:
    """Kriged nodes.

    Attributes:
        knots: (K - 1,) m, depth knots above 0.
        normal_length: L of the embedding, m.
        response: kriging of y and y', 2 (K - 1) columns.
        stiffness: kriging of log k, K - 1 columns; None where k = 0.
        friction: kriging of log mu, K - 1 columns; a number where mu is the same everywhere.
        own_exponent: (N, K - 1), d f / Phi of the nodes at the knots.
        convex: no node's force falls with depth.
        offset: rho of the tool, m.
        felt: knots whose data chose the settings.
    """

    knots: np.ndarray
    normal_length: float
    response: Kriging
    stiffness: Kriging | None
    friction: Kriging | float
    own_exponent: np.ndarray
    convex: bool
    offset: float
    felt: np.ndarray

    @staticmethod
    def from_nodes(
        nodes: ResponseNodes,
        geometry: ContactGeometry,
        offset: float,
        normal_length: float,
        *,
        with_gradients: bool = True,
        near: KrigingSettings | None = None,
        settings: KrigingSettings | None = None,
    ) -> SiteCurves:
        """Fit the kriging.

        Args:
            nodes: response nodes.
            geometry: gives the curvature at the nodes.
            offset: rho of the tool, m.
            normal_length: L, m.
            with_gradients: use B; without it only for comparison.
            near: settings that fitted most of the nodes; only what is near them is searched.
            settings: of the kriging of energy and force; found when absent.

        Raises:
            ValueError: energy or force of a node is not positive at a knot above 0.
        """
        knots = nodes.depth_knots[1:]
        phi, f = nodes.stored_energy[:, 1:], nodes.normal_force[:, 1:]
        if not (np.all(phi > 0) and np.all(f > 0)):
            bad = np.flatnonzero(np.any((phi <= 0) | (f <= 0), axis=1))
            raise ValueError(f"response field: energy or force is not positive at nodes {bad.tolist()}")
        y = np.log(phi / knots**HERTZ)
        slope = f / phi - HERTZ / knots
        z = embed(nodes.position, nodes.normal, normal_length)
        directions = gradients = None
        if with_gradients:
            reference = nodes.position + (offset - 0.5 * knots[-1]) * nodes.normal
            W = shape_operator(geometry, reference)
            e = tangent_frame(nodes.normal)  # (N, 2, 3)
            directions = embedded_directions(nodes.normal, W, normal_length)
            b, b_slope = (a[:, 1:] for a in relative_gradient(nodes))
            s = (offset - knots)[None, :, None]
            turned, turned_slope = (np.einsum("nij,nkj->nki", W, a) for a in (b, b_slope))
            g = np.concatenate([b + s * turned, b_slope + s * turned_slope - turned], axis=1)
            gradients = np.einsum("nti,nki->ntk", e, g)
        felt = np.flatnonzero(f.mean(axis=0) > FELT * f.mean(axis=0)[-1])
        columns = np.concatenate([y, slope], axis=1)
        response = fit_kriging(z, columns, directions, gradients, scored=felt, near=near, settings=settings)
        k = nodes.friction_stiffness[:, 1:]
        stiffness = fit_kriging(z, np.log(np.maximum(k, 1e-3 * k.max()))) if k.max() > 0 else None
        mu = nodes.friction_coefficient[:, 1:]
        friction: Kriging | float = float(mu.max())
        if np.ptp(mu) > 1e-9:
            friction = fit_kriging(z, np.log(np.maximum(mu, 1e-3 * mu.max())))
        rising = np.diff(nodes.normal_force, axis=1).min() >= 0
        return SiteCurves(
            knots, normal_length, response, stiffness, friction, f * knots / phi, bool(rising), offset, felt
        )

    def at(self, position: np.ndarray, normal: np.ndarray, depth: np.ndarray) -> Curves:
        """Curves of sites `position` (S, 3) m with `normal` (S, 3) at `depth` (J,) m, rising, above 0, J even."""
        z = embed(position, normal, self.normal_length)
        y, y_slope = np.split(self.response.predict(z), 2, axis=1)
        log_value, log_slope = self.interpolated(y, y_slope, depth)
        energy = depth**HERTZ * np.exp(log_value)
        coarse = depth[1::2]
        return Curves(
            energy=energy,
            force=energy * (HERTZ / depth + log_slope),
            friction_stiffness=self.positive(self.stiffness, z, coarse, start=0.5),
            friction_coefficient=self.positive(self.friction, z, coarse, start=0.0),
        )

    def at_own_depth(self, position: np.ndarray, normal: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Normal force (S,) N of each site at its own `depth` (S,) m."""
        z = embed(position, normal, self.normal_length)
        y, y_slope = np.split(self.response.predict(z), 2, axis=1)
        out = np.empty(len(z))
        for i in range(len(z)):
            value, slope = self.interpolated(y[i : i + 1], y_slope[i : i + 1], depth[i : i + 1])
            out[i] = depth[i] ** HERTZ * np.exp(value[0, 0]) * (HERTZ / depth[i] + slope[0, 0])
        return out

    def interpolated(
        self, y: np.ndarray, slope: np.ndarray, depth: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """y and y' (S, J) at `depth` (J,) from both at the knots (S, K - 1)."""
        first, last = self.knots[0], self.knots[-1]
        inside = np.clip(depth, first, last)
        if len(self.knots) > 1:
            spline = CubicHermiteSpline(self.knots, y, slope, axis=1)
            value, value_slope = spline(inside), spline(inside, 1)
        else:
            value, value_slope = np.repeat(y, len(depth), 1), np.repeat(slope, len(depth), 1)
        low, high = (p - HERTZ for p in EXPONENT_RANGE)
        power = np.clip(slope[:, :1] * first, low, high)
        shallow = depth < first
        value = np.where(shallow, y[:, :1] + power * np.log(depth / first), value)
        return value, np.where(shallow, power / depth, value_slope)

    def positive(
        self, kriged: Kriging | float | None, z: np.ndarray, depth: np.ndarray, start: float
    ) -> np.ndarray:
        """(S, 1 + J) values at depth 0 and `depth`; below the first knot a power `start` of d."""
        if not isinstance(kriged, Kriging):
            return np.full((len(z), 1 + len(depth)), 0.0 if kriged is None else kriged)
        logs = kriged.predict(z)
        nearest = np.stack([np.interp(depth, self.knots, row) for row in logs])
        nearest += start * np.log(np.minimum(depth / self.knots[0], 1.0))
        value = np.exp(nearest)
        at_zero = np.zeros((len(z), 1)) if start > 0 else value[:, :1]
        return np.concatenate([at_zero, value], axis=1)

    def leave_one_out(self) -> np.ndarray:
        """(N, K - 1) normal force predicted without the node, relative to its own, minus one."""
        missing, missing_slope = np.split(self.response.left_out, 2, axis=1)  # data minus prediction
        # f = d^1.5 e^y (2.5 + d y') = Phi (d f / Phi) / d
        return np.exp(-missing) * (self.own_exponent - self.knots * missing_slope) / self.own_exponent - 1.0

    def report(self) -> dict[str, float]:
        """Kriging's settings and leave-one-out force errors, |relative|, at the knots from 15 % of depth_max on."""
        settings = self.response.settings
        error = np.abs(self.leave_one_out()[:, self.knots > 0.15 * self.knots[-1]])
        return {
            "leave_one_out_force_p50": float(np.quantile(error, 0.5)),
            "leave_one_out_force_p95": float(np.quantile(error, 0.95)),
            "leave_one_out_force_max": float(error.max()),
            "kriging_length": settings.length,
            "kriging_value_noise": settings.value_noise,
            "kriging_gradient_noise": settings.gradient_noise,
            "kriging_short_length": settings.short_length,
        }
