// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "bench_paths.h"

#include <cmath>
#include <random>

namespace palpate_bench_paths {
namespace {

palpate_sample sample(const palpate_field* field, const point& q) {
    palpate_sample s{};
    s.size = sizeof s;
    palpate_field_sample(field, q.data(), 1, &s);
    return s;
}

palpate_field_info describe(const palpate_field* field) {
    palpate_field_info info{};
    info.size = sizeof info;
    palpate_field_describe(field, &info);
    return info;
}

point along(const point& q, const point& direction, double distance) {
    return {q[0] + direction[0] * distance, q[1] + direction[1] * distance, q[2] + direction[2] * distance};
}

// Moves q to `depth` along grad phi (Newton); false where that leaves the band.
bool to_depth(const palpate_field* field, double depth, point& q, point& normal) {
    for (int step = 0; step < 20; ++step) {
        const palpate_sample s = sample(field, q);
        if (s.region != PALPATE_REGION_CONTACT && s.region != PALPATE_REGION_FREE) return false;
        const double* g = s.distance_gradient;
        const double slope = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        if (!(slope > 0.25)) return false;
        normal = {s.normal[0], s.normal[1], s.normal[2]};
        const double miss = s.depth - depth;
        if (std::fabs(miss) < 1e-9) return true;
        q = along(q, {g[0], g[1], g[2]}, miss / slope);
    }
    return false;
}

double depth_of_contact(const palpate_field* field) { return 0.4 * describe(field).depth_max; }

void approach(std::vector<tick>& path, const contact& c) {
    for (int i = 0; i <= 12; ++i) path.push_back({along(c.q, c.normal, 12e-3 - 1e-3 * i), false});
}

}  // namespace

std::vector<contact> contacts(const palpate_field* field, std::size_t count, std::uint64_t seed) {
    const palpate_field_info info = describe(field);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<contact> found;
    for (std::size_t tries = 0; tries < 400000 && found.size() < count; ++tries) {
        contact c{};
        for (std::size_t a = 0; a < 3; ++a) c.q[a] = info.box_min[a] + unit(random) * (info.box_max[a] - info.box_min[a]);
        if (!to_depth(field, 0.4 * info.depth_max, c.q, c.normal)) continue;
        if (sample(field, c.q).stored_energy > 0.0) found.push_back(c);
    }
    return found;
}

std::vector<tick> sticking(const std::vector<contact>& at) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> micrometre(0.0, 1e-6);
    std::vector<tick> path;
    for (const contact& c : at) {
        approach(path, c);
        for (int i = 0; i < 50; ++i) {
            path.push_back({{c.q[0] + micrometre(random), c.q[1] + micrometre(random), c.q[2] + micrometre(random)}, true});
        }
    }
    return path;
}

std::vector<tick> sliding(const palpate_field* field, const std::vector<contact>& at) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal(0.0, 1.0);
    const double depth = depth_of_contact(field);
    std::vector<tick> path;
    for (const contact& c : at) {
        approach(path, c);
        const point way{normal(random), normal(random), normal(random)};
        point q = c.q;
        point n = c.normal;
        for (int i = 0; i < 50; ++i) {
            const double out = way[0] * n[0] + way[1] * n[1] + way[2] * n[2];
            const point t{way[0] - out * n[0], way[1] - out * n[1], way[2] - out * n[2]};
            const double length = std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
            if (!(length > 1e-6)) break;
            q = along(q, t, 1e-4 / length);
            if (!to_depth(field, depth, q, n)) break;
            path.push_back({q, i > 0});
        }
    }
    return path;
}

std::vector<tick> hovering(const palpate_field* field, const std::vector<contact>& at) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> gap(0.1e-3, 2e-3);
    const double depth = depth_of_contact(field);
    std::vector<tick> path;
    for (const contact& c : at) {
        for (int i = 0; i < 50; ++i) path.push_back({along(c.q, c.normal, depth + gap(random)), i > 0});
    }
    return path;
}

std::vector<tick> tapping(const palpate_field* field, const std::vector<contact>& at) {
    const double depth = depth_of_contact(field);
    std::vector<tick> path;
    for (const contact& c : at) {
        for (int i = 0; i < 10; ++i) {
            path.push_back({along(c.q, c.normal, depth + 0.3e-3), false});
            path.push_back({along(c.q, c.normal, depth - 0.3e-3), true});
        }
    }
    return path;
}

std::vector<tick> adversarial(const palpate_field* field, const std::vector<contact>& at, std::size_t count) {
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal(0.0, 1.0);
    const palpate_field_info info = describe(field);
    const double depth = depth_of_contact(field);
    std::vector<tick> path;
    while (path.size() < count && !at.empty()) {
        const contact& c = at[random() % at.size()];
        path.push_back({along(c.q, c.normal, depth + 1e-3), true});  // free here, so that contact may begin
        for (int i = 0; i < 40; ++i) {
            const double depths[] = {1e-9, 1e-6, 0.5 * depth, depth, info.depth_max, info.tool_offset - info.band[0], -1e-4};
            point q = along(c.q, c.normal, depth - depths[random() % 7]);
            for (double& x : q) x += 1e-4 * normal(random);
            const auto kind = random() % 8;
            if (kind < 4) {  // to the nearest border of a cell of either lattice, exactly or almost
                const double spacing = kind < 2 ? info.geometry_spacing : info.amplitude_spacing;
                for (std::size_t a = 0; a < 3; ++a) {
                    q[a] = info.box_min[a] + spacing * std::nearbyint((q[a] - info.box_min[a]) / spacing) + 1e-15 * normal(random);
                }
            } else if (kind == 4) {  // 9.9 mm: as far as 10 m/s go in a millisecond
                q = along(path.back().q, c.normal, random() % 2 == 0 ? 9.9e-3 : -9.9e-3);
            } else if (kind == 5 && random() % 16 == 0) {
                q[random() % 3] += random() % 2 == 0 ? 1.0 : -1.0;
            }
            path.push_back({q, true});
        }
    }
    return path;
}

}  // namespace palpate_bench_paths
