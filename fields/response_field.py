# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a response field is: one organ, one tool, one set of supports.

The tool's reference point is q (sphere: its centre) and its offset rho (sphere: its radius).  With the organ's
signed distance phi(q) (positive outside), depth is d = rho - phi(q).  The field is a potential

    U(q) = sum_r phi_r(d(q)) a_r(q),           force on the tool (the hand)  f = -grad U(q)

plus a friction spring of stiffness k(q) = max(0, sum_r kappa_r(d) b_r(q)) and a friction coefficient
mu(q) = max(0, sum_r mu_r(d) m_r(q)).  `ResponseNodes` are the authored truth; everything else is derived.

Units: SI.  Axes: the organ's own, right-handed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from palpate.fields.lattice import Lattice

__all__ = [
    "ContactGeometry",
    "DepthCurves",
    "FamilyMember",
    "ResponseField",
    "ResponseNodes",
    "TiltedWay",
    "ToolReference",
]


@dataclass(frozen=True)
class ToolReference:
    """The tool that a field is valid for.

    Attributes:
        name: scene name.
        shape: sphere, flat_punch, cylinder, cone, capsule or mesh.
        offset: rho, m; depth = offset - signed distance of the reference point.
        parameters: shape parameters, SI (sphere: {"radius": m}).
        hash: hex digest of shape, parameters, reference point, axis and tilt.
        axis: (3,) unit vector in the shape's own frame; points out of the tissue.
        tip: (3,) m in the shape's own frame; the reference point.
        tilt: rad between the axis and the surface's normal, leaning towards the first tangent (see `held_against`).
        vertices, triangles: (V, 3) m and (G, 3); the tool's surface in its frame: the reference point at the origin,
            z along the axis.  Empty for a sphere.
    """

    name: str
    shape: str
    offset: float
    parameters: dict[str, float]
    hash: str
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    tip: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilt: float = 0.0
    vertices: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)), compare=False)
    triangles: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), np.int32), compare=False)

    def held_against(self, normal: np.ndarray) -> np.ndarray:
        """(3, 3) rotation from the tool's frame to the organ's where the surface's unit normal is (3,).

        Q = [cos b t_1 - sin b n, t_2, cos b n + sin b t_1], b the tilt; t_1 leans on the axis that n avoids most.
        """
        axis = np.eye(3)[np.argmin(np.abs(normal))]
        first = axis - (axis @ normal) * normal
        first /= np.linalg.norm(first)
        c, s = np.cos(self.tilt), np.sin(self.tilt)
        return np.stack([c * first - s * normal, np.cross(normal, first), c * normal + s * first], axis=1)


@dataclass(frozen=True)
class ContactGeometry:
    """The organ's smooth signed distance phi(q) in a narrow band; shared by all tools of an asset.

    Attributes:
        signed_distance: one-channel lattice, m, positive outside the tissue.
        band: (2,) m; smallest and largest phi for which the lattice is meant to be read.
        error_p99: m; 99th percentile of |lattice - mesh distance| at check points in the band, within the reach.
        flagged_share: share of them where |grad phi| < 0.9.
    """

    signed_distance: Lattice
    band: np.ndarray
    error_p99: float = 0.0
    flagged_share: float = 0.0


@dataclass(frozen=True)
class ResponseNodes:
    """Node curves on shared knots.  N nodes, K knots; knot 0 is depth 0 and its values are 0.

    Attributes:
        position: (N, 3) m; contact point on the organ's surface.
        normal: (N, 3); outward unit normal, grad phi at the tool's reference point.
        depth_knots: (K,) m, rising from 0.
        stored_energy: (N, K) J; Phi_i(d).
        normal_force: (N, K) N; f_i(d) = Phi_i'(d), on the tool along the outward normal.
        lateral_gradient: (N, K, 3) N; B_i(d), gradient of U along the surface at the tool's reference point
            = minus the tangential force on the tool in the frictionless press.  Orthogonal to `normal`.
        friction_stiffness: (N, K) N/m; k_i(d), stiffness of the friction spring.
        friction_coefficient: (N, K); mu_i(d).
        depth_reached: (N,) m; deepest converged depth; values beyond it are extrapolated and marked so.
        pressed: (N,) bool; True where FEM pressed, False where derived.
        residual: (N,) fraction; fit against press data, largest over knots, relative to the deepest force.
        press_hash: (N,) str; the press record's hash, "" where derived.
    """

    position: np.ndarray
    normal: np.ndarray
    depth_knots: np.ndarray
    stored_energy: np.ndarray
    normal_force: np.ndarray
    lateral_gradient: np.ndarray
    friction_stiffness: np.ndarray
    friction_coefficient: np.ndarray
    depth_reached: np.ndarray
    pressed: np.ndarray
    residual: np.ndarray
    press_hash: np.ndarray

    @property
    def node_count(self) -> int:
        return int(self.position.shape[0])


@dataclass(frozen=True)
class FamilyMember:
    """One pressed radius of a tool family: a tool, and its curves at the nodes that all members share."""

    tool: ToolReference
    nodes: ResponseNodes

    @property
    def radius(self) -> float:
        """m."""
        return self.tool.parameters["radius"]


@dataclass(frozen=True)
class TiltedWay:
    """A further way of touching: the tool tilted, its curves at the nodes that all ways share, its amplitudes.

    The shared curves are the field's (`ResponseField.energy_curves` and so on), the lattice has its origin and shape.
    """

    tool: ToolReference
    nodes: ResponseNodes
    amplitudes: Lattice

    @property
    def cosine(self) -> float:
        """Of the angle between tool axis and outward normal."""
        return float(np.cos(self.tool.tilt))


@dataclass(frozen=True)
class DepthCurves:
    """R shared functions of depth on M uniform intervals [0, depth_end], piecewise cubic.

    In interval m with x = d - m * depth_end / M:  g_r(d) = c0 + c1 x + c2 x^2 + c3 x^3.
    d <= 0: g_r = 0.  d > depth_end: continues with its value, slope and second derivative (a quadratic),
    so that a force continues with its last slope.

    Attributes:
        depth_end: m.
        coefficients: (R, M, 4) float64; [J or unit of the quantity] per m^j.
    """

    depth_end: float
    coefficients: np.ndarray

    @property
    def curve_count(self) -> int:
        return int(self.coefficients.shape[0])


@dataclass(frozen=True)
class ResponseField:
    """One organ, one tool: node curves (truth) and the derived, conservative form that the runtime reads.

    Attributes:
        tool: what the field is valid for.
        geometry: contact geometry, shared by the asset's tools.
        nodes: the authored truth.
        energy_curves: phi_r(d), R_U curves, J; phi_r(0) = phi_r'(0) = 0.
        stiffness_curves: kappa_r(d), R_k curves, N/m.
        friction_curves: mu_r(d), R_mu curves, dimensionless.
        amplitudes: lattice whose channels are, in this order, a_r (R_U), b_r (R_k), m_r (R_mu); dimensionless.
            An absent block means zero amplitude; coefficients fall to zero before it, so U stays C1.
        depth_max: m; depth that presses were asked to reach.
        representation: residuals of the derived form at the nodes (fractions of the deepest force), by name.
        provenance: hashes of mesh, scene, supports, solver settings; versions; seed; errors.
        family: all pressed radii, rising, where `tool` is one of a family (tool_family.py makes fields of any radius
            between them); empty where it is not.
        ways: further ways of touching, by rising tilt, where `tool` is upright and was pressed tilted as well; empty
            where one way holds.  A node holds the mean of two presses that lean opposite ways.
        layers: what the file carries for effects beyond response and friction, by name (`rfield_layout.LAYERS`): the
            bytes that the effect's own layout says.
        band: (2,) m; the part of the geometry's band that `tool` needs, which is what its file holds; None for all.
    """

    tool: ToolReference
    geometry: ContactGeometry
    nodes: ResponseNodes
    energy_curves: DepthCurves
    stiffness_curves: DepthCurves
    friction_curves: DepthCurves
    amplitudes: Lattice
    depth_max: float
    representation: dict[str, float] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    family: tuple[FamilyMember, ...] = ()
    ways: tuple[TiltedWay, ...] = ()
    band: np.ndarray | None = None
    layers: dict[str, bytes] = field(default_factory=dict)

    @property
    def own_band(self) -> np.ndarray:
        """(2,) m; smallest and largest phi of the reference point for which the field is meant to be read."""
        return self.geometry.band if self.band is None else self.band

    def fields_by_way(self) -> list[ResponseField]:
        """The field of each way by itself, the upright one first."""
        own = replace(self, ways=())
        tilted = [
            replace(own, tool=w.tool, nodes=w.nodes, amplitudes=w.amplitudes, family=()) for w in self.ways
        ]
        return [own, *tilted]
