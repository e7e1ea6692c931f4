// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "rigid_coupling.h"

#include <cmath>

namespace palpate {
namespace {

// x from A x = b, A symmetric and positive definite, by A = L L^T in place.
void solve(rigid_matrix& a, const double b[6], double x[6]) noexcept {
    for (int j = 0; j < 6; ++j) {
        for (int i = j; i < 6; ++i) {
            double sum = a.at[i][j];
            for (int k = 0; k < j; ++k) sum -= a.at[i][k] * a.at[j][k];
            if (i == j) a.at[j][j] = std::sqrt(sum > 1e-30 ? sum : 1e-30);
            else a.at[i][j] = sum / a.at[j][j];
        }
    }
    for (int i = 0; i < 6; ++i) {
        double sum = b[i];
        for (int k = 0; k < i; ++k) sum -= a.at[i][k] * x[k];
        x[i] = sum / a.at[i][i];
    }
    for (int i = 5; i >= 0; --i) {
        double sum = x[i];
        for (int k = i + 1; k < 6; ++k) sum -= a.at[k][i] * x[k];
        x[i] = sum / a.at[i][i];
    }
}

}  // namespace

void rigid_add_point(rigid_matrix& m, const double d[3], const double arm[3], double k) noexcept {
    double j[6] = {d[0], d[1], d[2], 0.0, 0.0, 0.0};
    cross(arm, d, j + 3);
    for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) m.at[r][c] += k * j[r] * j[c];
    }
}

void rigid_advance(const rigid_drive& q, const rigid_coupling& coupling, double part, double dt, rigid_step& step) noexcept {
    const double k = part * coupling.stiffness, b = part * coupling.damping;
    const double kappa = part * coupling.turn_stiffness, beta = part * coupling.turn_damping;
    rigid_matrix a;
    double right[6], pull[3], lever[3];
    for (int r = 0; r < 6; ++r) {
        right[r] = dt * q.wrench[r];
        for (int c = 0; c < 6; ++c) {
            a.at[r][c] = q.inertia.at[r][c] + dt * (q.damping.at[r][c] + dt * q.stiffness.at[r][c]);
            right[r] += (q.inertia.at[r][c] + dt * q.damping.at[r][c]) * q.speed[c];
        }
    }
    for (int i = 0; i < 3; ++i) {
        const double axis[3] = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
        rigid_add_point(a, axis, q.arm, dt * (b + dt * k));
        a.at[3 + i][3 + i] += dt * (beta + dt * kappa);
        pull[i] = k * q.stretch[i] + b * q.hand[i];
    }
    cross(q.arm, pull, lever);
    for (int i = 0; i < 3; ++i) {
        right[i] += dt * (pull[i] + q.weight[i]);
        right[3 + i] += dt * (lever[i] + kappa * q.turn[i] + beta * q.hand[3 + i] - q.gyro[i]);
    }
    solve(a, right, step.speed);
    double grip[3];
    cross(step.speed + 3, q.arm, grip);
    for (int i = 0; i < 3; ++i) {
        grip[i] += step.speed[i];
        step.force[i] = -(k * (q.stretch[i] - dt * grip[i]) + b * (q.hand[i] - grip[i]));
        step.torque[i] = -(kappa * (q.turn[i] - dt * step.speed[3 + i]) + beta * (q.hand[3 + i] - step.speed[3 + i]));
    }
}

}  // namespace palpate
