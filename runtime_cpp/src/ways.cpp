// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "ways.h"

#include "respond.h"

namespace palpate {
namespace {

// Way `below` and the next one with shares 1 - t and t; t is 0 where there is no next one.
std::int32_t between_ways(const palpate_field& field, double cosine, double& t) noexcept {
    const double* c = field.header.way_cosine;
    std::int32_t w = 0;
    while (w + 2 < field.way_count && cosine < c[w + 1]) ++w;
    t = 0.0;
    if (w + 1 < field.way_count && cosine < c[w]) {
        t = (c[w] - cosine) / (c[w] - c[w + 1]);
        if (t > 1.0) t = 1.0;
    }
    return w;
}

const amplitude_sums& sums_of(const palpate_field& field, amplitudes_here& here, std::int32_t w) noexcept {
    if (!here.known[w]) {
        const std::int64_t way = static_cast<std::int64_t>(w) * field.way_stride;
        field.contract->amplitudes(here.taps, way, field.gradient_channels, field.channels, here.way[w]);
        here.known[w] = true;
    }
    return here.way[w];
}

}  // namespace

double clamped_cosine(const palpate_field& field, double cosine) PALPATE_REAL_TIME {
    const double* c = field.header.way_cosine;
    const double least = c[field.way_count - 1];
    return cosine > c[0] ? c[0] : cosine > least ? cosine : least;
}

double offset_of_way(const palpate_field& field, double cosine) PALPATE_REAL_TIME {
    double t = 0.0;
    const std::int32_t w = between_ways(field, cosine, t);
    const double* rho = field.header.way_offset;
    return t > 0.0 ? (1.0 - t) * rho[w] + t * rho[w + 1] : rho[w];
}

void amplitudes_at(const palpate_field& field, const double q[3], amplitudes_here& here) PALPATE_REAL_TIME {
    here.stored = gather(field, q, here.taps);
    for (bool& known : here.known) known = false;
}

void blend(const palpate_field& field, amplitudes_here& here, double cosine, amplitude_sums& sums) PALPATE_REAL_TIME {
    if (!here.stored) {
        sums = amplitude_sums{};
        return;
    }
    double t = 0.0;
    const std::int32_t w = between_ways(field, cosine, t);
    sums = sums_of(field, here, w);
    if (!(t > 0.0)) return;
    const amplitude_sums& next = sums_of(field, here, w + 1);
    for (std::int32_t i = 0; i < field.channels; ++i) sums.value[i] = (1.0 - t) * sums.value[i] + t * next.value[i];
    for (std::int32_t i = 0; i < field.gradient_channels; ++i) {
        sums.dx[i] = (1.0 - t) * sums.dx[i] + t * next.dx[i];
        sums.dy[i] = (1.0 - t) * sums.dy[i] + t * next.dy[i];
        sums.dz[i] = (1.0 - t) * sums.dz[i] + t * next.dz[i];
    }
}

}  // namespace palpate
