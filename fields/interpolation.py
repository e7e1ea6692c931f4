# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The response at a point: the NumPy twin of the runtime's location and response.

    d = rho - phi(q),   n = grad phi / |grad phi|
    U(q) = sum_r phi_r(d) a_r(q)
    grad U = sum_r phi_r(d) grad a_r - (sum_r phi_r'(d) a_r) grad phi,     f = -grad U

A texture (texture.py) puts the felt depth s and its gradient in the place of d and -grad phi.

A point is valid where the contact geometry is stored (contact_geometry.py); elsewhere everything is zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.fields.lattice_stencil import sample_lattice
from palpate.fields.response_field import ResponseField
from palpate.fields.shared_curves import evaluate_curves
from palpate.fields.texture_layout import read_texture

__all__ = ["Response", "energy_hessian", "evaluate"]


@dataclass(frozen=True)
class Response:
    """What the field says at n points.

    Attributes:
        energy: (n,) J; U.
        gradient: (n, 3) N; grad U.
        force: (n, 3) N; on the tool, -grad U.
        depth: (n,) m; negative outside contact.
        normal: (n, 3) outward unit normal.
        normal_force: (n,) N; f . n.
        friction_stiffness: (n,) N/m; 0 outside contact.
        friction_coefficient: (n,); 0 outside contact.
        valid: (n,) bool.
    """

    energy: np.ndarray
    gradient: np.ndarray
    force: np.ndarray
    depth: np.ndarray
    normal: np.ndarray
    normal_force: np.ndarray
    friction_stiffness: np.ndarray
    friction_coefficient: np.ndarray
    valid: np.ndarray


def evaluate(field: ResponseField, points: np.ndarray) -> Response:
    """The response at tool reference `points` (n, 3) m, organ axes.  Invalid points: all zero, depth NaN."""
    points = np.asarray(points, dtype=float)
    geometry = sample_lattice(field.geometry.signed_distance, points)
    valid = geometry.present
    phi, slope = geometry.value[:, 0], geometry.gradient[:, 0]
    normal = slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12)
    depth = np.where(valid, field.tool.offset - phi, 0.0)

    amplitude = sample_lattice(field.amplitudes, points)
    split = np.cumsum([field.energy_curves.curve_count, field.stiffness_curves.curve_count])
    a, b, m = np.split(amplitude.value, split, axis=1)
    grad_a = amplitude.gradient[:, : split[0]]
    felt, felt_slope = depth, slope
    if "texture" in field.layers:
        texture = read_texture(field.layers["texture"])
        h, dh = texture.height(points)
        w, dw = texture.fade(depth)
        felt, felt_slope = depth + w * h, (1.0 + dw * h)[:, None] * slope - w[:, None] * dh
    g, dg, _ = evaluate_curves(field.energy_curves, felt)
    energy = np.sum(g * a, axis=1)
    gradient = np.einsum("nr,nri->ni", g, grad_a) - np.sum(dg * a, axis=1)[:, None] * felt_slope
    stiffness = np.sum(evaluate_curves(field.stiffness_curves, felt)[0] * b, axis=1)
    friction = np.sum(evaluate_curves(field.friction_curves, felt)[0] * m, axis=1)
    gradient = np.where(valid[:, None], gradient, 0.0)
    return Response(
        energy=np.where(valid, energy, 0.0),
        gradient=gradient,
        force=-gradient,
        depth=np.where(valid, depth, np.nan),
        normal=np.where(valid[:, None], normal, 0.0),
        normal_force=-np.sum(gradient * normal, axis=1),
        friction_stiffness=np.where(valid, np.maximum(stiffness, 0.0), 0.0),
        friction_coefficient=np.where(valid, np.maximum(friction, 0.0), 0.0),
        valid=valid,
    )


def energy_hessian(field: ResponseField, points: np.ndarray) -> np.ndarray:
    """Second derivatives of U, (n, 3, 3) N/m, at `points` (n, 3) m; they jump between lattice cells.  No texture.

    With g = phi_r(d), D = grad phi, H = Hess phi:
    Hess U = g Hess a - g' (D grad a^T + grad a D^T) + a (g'' D D^T - g' H), summed over r.
    """
    points = np.asarray(points, dtype=float)
    geometry = sample_lattice(field.geometry.signed_distance, points, hessian=True)
    amplitude = sample_lattice(field.amplitudes, points, hessian=True)
    assert geometry.hessian is not None and amplitude.hessian is not None
    depth = np.where(geometry.present, field.tool.offset - geometry.value[:, 0], 0.0)
    count = field.energy_curves.curve_count
    g, dg, ddg = evaluate_curves(field.energy_curves, depth)
    a, grad_a = amplitude.value[:, :count], amplitude.gradient[:, :count]
    D, H = geometry.gradient[:, 0], geometry.hessian[:, 0]
    along = np.einsum("nr,nri->ni", dg, grad_a)
    mixed = D[:, :, None] * along[:, None, :]
    out = np.einsum("nr,nrij->nij", g, amplitude.hessian[:, :count]) - mixed - mixed.swapaxes(1, 2)
    out += np.sum(ddg * a, axis=1)[:, None, None] * (D[:, :, None] * D[:, None, :])
    out -= np.sum(dg * a, axis=1)[:, None, None] * H
    return np.where(geometry.present[:, None, None], out, 0.0)
