// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// How the surface moves, for graphics: the twin of fields/deformation.py, which has the formulas.
//
// A call first mixes the shared tables for where the tool is (amplitudes, depth), which leaves one profile of R for each
// harmonic; each vertex then costs four knots of them.  Nothing is allocated and nothing is kept between calls.
#include "layers/deformation.h"

#include <cmath>
#include <cstring>
#include <initializer_list>

#include "field.h"
#include "locate.h"
#include "palpate/palpate.h"
#include "rotation.h"
#include "vec.h"

namespace palpate {
namespace {

constexpr double behind_low = -0.9, behind_high = -0.7;
constexpr double tiny = 1e-12;        // m
constexpr double depths_beyond = 2.0; // the last slope goes on up to so many depth_end
constexpr int column_limit = 10 * static_cast<int>(deformation_rank_limit);
constexpr int padded_limit = static_cast<int>(deformation_knot_limit) + 2;

// What mixing leaves, with one row before the first knot (its slope goes on) and one after the last (zero).
struct profiles {
    double zero[padded_limit][2];
    double one[padded_limit][3][3];  // a vector for each of n and t, and one that is the displacement itself
    double two[padded_limit][3][6];  // a tensor xx yy zz yz xz xy for each of n, t, b
};

struct place {
    double c[3], n[3];       // contact point, normal
    double depth;            // m
    double stretch[3];       // m, along the surface
    double tip[3], axis[3];  // of the tool
};

void catmull_rom(double f, double w[4]) noexcept {
    w[0] = f * (-0.5 + f * (1.0 - 0.5 * f));
    w[1] = 1.0 + f * f * (-2.5 + 1.5 * f);
    w[2] = f * (0.5 + f * (2.0 - 1.5 * f));
    w[3] = f * f * (-0.5 + 0.5 * f);
}

void depth_weights(const deformation_header& h, double depth, double w[deformation_knot_limit]) noexcept {
    const int count = static_cast<int>(h.depth_count);
    double out[padded_limit] = {};
    const double share = depth / h.depth_end;
    const double x = (share < depths_beyond ? share : depths_beyond) * (count - 1);
    if (x >= count - 1) {
        out[count - 1] = count - 1 - x;
        out[count] = x - (count - 2);
    } else {
        const int cell = static_cast<int>(x);
        double four[4];
        catmull_rom(x - cell, four);
        for (int i = 0; i < 4; ++i) out[cell + i] = four[i];
        out[1] += 2.0 * out[0];
        out[2] -= out[0];
        out[count] += 2.0 * out[count + 1];
        out[count - 1] -= out[count + 1];
    }
    for (int k = 0; k < count; ++k) w[k] = out[k + 1];
}

// a, g and G of the model, in a row: rank[0], 3 rank[1], 6 rank[2]; g and G in the tangent plane.
void amplitudes(const deformation_header& h, const deformation_arrays& at, const place& p, double value[column_limit]) noexcept {
    const int ends[4] = {0, static_cast<int>(h.rank[0]), static_cast<int>(h.rank[0] + 3 * h.rank[1]),
                         static_cast<int>(deformation_columns(h))};
    for (int i = 0; i < ends[3]; ++i) value[i] = i < ends[1] ? at.mean[i] : 0.0;
    for (std::uint32_t node = 0; node < h.node_count; ++node) {
        double far = 0.0;
        for (std::uint32_t a = 0; a < 3; ++a) {
            const double dc = at.node[3 * node + a] - p.c[a], dn = h.normal_length * (at.normal[3 * node + a] - p.n[a]);
            far += dc * dc + dn * dn;
        }
        far = std::sqrt(5.0 * far);
        const double* weight = at.weight + static_cast<std::size_t>(node) * static_cast<std::size_t>(ends[3]);
        for (int harmonic = 0; harmonic < 3; ++harmonic) {
            const double s = far / h.length[harmonic];
            const double k = (1.0 + s + s * s / 3.0) * std::exp(-s);
            for (int i = ends[harmonic]; i < ends[harmonic + 1]; ++i) value[i] += k * weight[i];
        }
    }
    for (int i = ends[1]; i < ends[2]; i += 3) {
        const double along = dot(value + i, p.n);
        for (int a = 0; a < 3; ++a) value[i + a] -= along * p.n[a];
    }
    for (int i = ends[2]; i < ends[3]; i += 6) {  // P G P less its trace, P = 1 - n n
        double* six = value + i;
        const double G[3][3] = {{six[0], six[5], six[4]}, {six[5], six[1], six[3]}, {six[4], six[3], six[2]}};
        double Gn[3];
        for (int a = 0; a < 3; ++a) Gn[a] = dot(G[a], p.n);
        const double nGn = dot(Gn, p.n);
        const double trace = G[0][0] + G[1][1] + G[2][2] - nGn;  // of P G P
        const auto flat = [&](int a, int b) {
            const double plane = (a == b ? 1.0 : 0.0) - p.n[a] * p.n[b];
            return G[a][b] - p.n[a] * Gn[b] - Gn[a] * p.n[b] + nGn * p.n[a] * p.n[b] - 0.5 * trace * plane;
        };
        const double projected[6] = {flat(0, 0), flat(1, 1), flat(2, 2), flat(1, 2), flat(0, 2), flat(0, 1)};
        for (int a = 0; a < 6; ++a) six[a] = projected[a];
    }
}

void mix(const deformation_header& h, const deformation_arrays& at, const place& p, profiles& out) noexcept {
    double d[deformation_knot_limit], value[column_limit];
    depth_weights(h, p.depth, d);
    amplitudes(h, at, p, value);
    const int J = static_cast<int>(h.radial_count), K = static_cast<int>(h.depth_count);
    std::memset(&out, 0, sizeof out);
    const auto each = [&](const float* table, int components, auto&& add) {
        for (int k = 0; k < K; ++k) {
            if (d[k] == 0.0) continue;
            const float* row = table + static_cast<std::ptrdiff_t>(k) * J * components;
            for (int j = 0; j < J; ++j) {
                for (int c = 0; c < components; ++c) add(j + 1, c, d[k] * static_cast<double>(row[j * components + c]));
            }
        }
    };
    const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(J) * K;
    const double* g = value;
    for (std::uint32_t r = 0; r < h.rank[0]; ++r, ++g) {
        each(at.table[0] + size * 2 * r, 2, [&](int j, int c, double f) { out.zero[j][c] += *g * f; });
    }
    for (std::uint32_t r = 0; r < h.rank[1]; ++r, g += 3) {
        each(at.table[1] + size * 3 * r, 3, [&](int j, int c, double f) {
            for (int a = 0; a < 3; ++a) out.one[j][c][a] += g[a] * f;
        });
    }
    for (std::uint32_t r = 0; r < h.rank[2]; ++r, g += 6) {
        each(at.table[2] + size * 3 * r, 3, [&](int j, int c, double f) {
            for (int a = 0; a < 6; ++a) out.two[j][c][a] += g[a] * f;
        });
    }
    if (dot(p.stretch, p.stretch) > 0.0) {
        each(at.stuck, 3, [&](int j, int c, double f) {
            for (int a = 0; a < 3; ++a) out.one[j][c][a] += p.stretch[a] * f;
        });
    }
    double* all = &out.zero[0][0];
    constexpr std::size_t zero_row = 2, one_row = 9, two_row = 18;
    const auto before = [](double* rows, std::size_t width) {
        for (std::size_t i = 0; i < width; ++i) rows[i] = 2.0 * rows[width + i] - rows[2 * width + i];
    };
    before(all, zero_row);
    before(&out.one[0][0][0], one_row);
    before(&out.two[0][0][0], two_row);
}

// From x, which the tool covers, to its surface; nothing elsewhere.
void uncover(const deformation_header& h, const float* gap, const place& p, double x[3]) noexcept {
    const double y[3] = {x[0] - p.tip[0], x[1] - p.tip[1], x[2] - p.tip[2]};
    const double height = dot(y, p.axis);
    double across[3];
    for (int a = 0; a < 3; ++a) across[a] = y[a] - height * p.axis[a];
    const double distance = std::sqrt(dot(across, across));
    const int rows = static_cast<int>(h.gap_count[0]), columns = static_cast<int>(h.gap_count[1]);
    const double i = height / h.gap_step + 2.0, k = distance / h.gap_step;
    if (!(i >= 0.0 && i < rows - 1 && k < columns - 1)) return;
    const int i0 = static_cast<int>(i), k0 = static_cast<int>(k);
    const double a = i - i0, e = k - k0;
    const float* row = gap + static_cast<std::ptrdiff_t>(i0) * columns + k0;
    const double v00 = static_cast<double>(row[0]), v01 = static_cast<double>(row[1]);
    const double v10 = static_cast<double>(row[columns]), v11 = static_cast<double>(row[columns + 1]);
    const double value = (1 - a) * ((1 - e) * v00 + e * v01) + a * ((1 - e) * v10 + e * v11);
    if (!(value < 0.0)) return;
    const double up = (1 - e) * (v10 - v00) + e * (v11 - v01);
    const double out = (1 - a) * (v01 - v00) + a * (v11 - v10);
    const double size = std::sqrt(up * up + out * out);
    if (!(size > 0.0)) return;
    const double push = -value / size, inverse = 1.0 / (distance > tiny ? distance : tiny);
    for (int c = 0; c < 3; ++c) x[c] += push * (up * p.axis[c] + out * across[c] * inverse);
}

// False where X does not move.
bool move(const deformation_header& h, const deformation_arrays& at, const place& p, const profiles& f, const double X[3],
          double u[3]) noexcept {
    const double r[3] = {X[0] - p.c[0], X[1] - p.c[1], X[2] - p.c[2]};
    const double R = std::sqrt(dot(r, r));
    if (!(R < h.radius)) return false;
    const double z = dot(r, p.n), inverse = 1.0 / (R > tiny ? R : tiny);
    double t[3], b[3];
    for (int a = 0; a < 3; ++a) t[a] = (r[a] - z * p.n[a]) * inverse;
    cross(p.n, t, b);
    double side = (z * inverse - behind_low) / (behind_high - behind_low);
    side = side < 0.0 ? 0.0 : side > 1.0 ? 1.0 : side;
    const double shown = side * side * (3.0 - 2.0 * side);

    const int count = static_cast<int>(h.radial_count);
    const double x = (R / (R + h.scale)) * ((h.radius + h.scale) / h.radius) * (count - 1);
    int cell = static_cast<int>(x);
    cell = cell < count - 2 ? cell : count - 2;
    double w[4];
    catmull_rom(x - cell, w);
    const double* direction[3] = {t, t, b};  // of n, t, b: what their factors are multiplied with
    double value[3] = {}, whole[3] = {};
    for (int i = 0; i < 4; ++i) {
        const int j = cell + i;
        for (int c = 0; c < 3; ++c) {
            const double* e = direction[c];
            const double* G = f.two[j][c];
            const double Gt[3] = {G[0] * t[0] + G[5] * t[1] + G[4] * t[2], G[5] * t[0] + G[1] * t[1] + G[3] * t[2],
                                  G[4] * t[0] + G[3] * t[1] + G[2] * t[2]};
            value[c] += w[i] * (dot(Gt, e) + (c < 2 ? dot(f.one[j][c], t) + f.zero[j][c] : 0.0));
            whole[c] += w[i] * f.one[j][2][c];
        }
    }
    double moved[3];
    for (int a = 0; a < 3; ++a) {
        u[a] = shown * (value[0] * p.n[a] + value[1] * t[a] + value[2] * b[a] + whole[a]);
        moved[a] = X[a] + u[a];
    }
    uncover(h, at.gap, p, moved);
    for (int a = 0; a < 3; ++a) u[a] = moved[a] - X[a];
    return true;
}

bool found(const palpate_field& field, const double q[3], location& at, double n[3]) noexcept {
    locate(field, q, at);
    if (at.region != PALPATE_REGION_CONTACT && at.region != PALPATE_REGION_FREE) return false;
    const double length = std::sqrt(dot(at.gradient, at.gradient));
    if (!(length > tiny)) return false;
    for (int a = 0; a < 3; ++a) n[a] = at.gradient[a] / length;
    return true;
}

// False where nothing is pressed.
bool placed(const palpate_field& field, const palpate_deformation_input& input, place& p) noexcept {
    double q[3], anchor[3];
    for (int a = 0; a < 3; ++a) {
        q[a] = input.reference_point[a];
        anchor[a] = input.anchor[a];
    }
    if ((input.flags & PALPATE_INPUT_ORGAN_POSE) != 0) {
        double back[4], squared = 0.0;
        for (const double x : input.organ_orientation) squared += x * x;
        conjugate(input.organ_orientation, back);
        for (double* point : {q, anchor}) {
            const double away[3] = {point[0] - input.organ_position[0], point[1] - input.organ_position[1],
                                    point[2] - input.organ_position[2]};
            rotate_scaled(back, 2.0 / squared, away, point);
        }
    }
    location at, held;
    if (!found(field, q, at, p.axis)) return false;
    p.depth = at.depth - input.surface_offset;
    if (!(p.depth > 0.0)) return false;
    const bool stuck = found(field, anchor, held, p.n);
    if (!stuck) {
        for (int a = 0; a < 3; ++a) p.n[a] = p.axis[a];
    }
    const double phi = field.tool_offset - (stuck ? held.depth : at.depth);
    for (int a = 0; a < 3; ++a) {
        p.c[a] = (stuck ? anchor[a] : q[a]) - phi * p.n[a];
        p.tip[a] = q[a] - field.tool_offset * p.axis[a];
        p.stretch[a] = stuck ? q[a] - anchor[a] : 0.0;
    }
    const double along = dot(p.stretch, p.n);
    for (int a = 0; a < 3; ++a) p.stretch[a] -= along * p.n[a];
    return true;
}

bool usable(const palpate_deformation_input& input) noexcept {
    bool good = std::fabs(input.surface_offset) <= length_limit;
    for (int a = 0; a < 3; ++a) good = good && bounded(input.reference_point[a], length_limit) && bounded(input.anchor[a], length_limit);
    if ((input.flags & PALPATE_INPUT_ORGAN_POSE) == 0) return good;
    double squared = 0.0;
    for (const double x : input.organ_orientation) squared += x * x;
    for (const double x : input.organ_position) good = good && bounded(x, length_limit);
    return good && squared > 0.98 && squared < 1.02;
}

}  // namespace
}  // namespace palpate

extern "C" {

palpate_status palpate_deformation_describe(const palpate_field* field, palpate_deformation_info* info) noexcept {
    if (field == nullptr || info == nullptr || info->size < sizeof(palpate_deformation_info)) return PALPATE_BAD_ARGUMENT;
    const palpate::layer_bytes& layer = field->layer[palpate::layer_deformation];
    if (layer.begin == nullptr) return PALPATE_LAYER_MISSING;
    const auto& h = *reinterpret_cast<const palpate::deformation_header*>(layer.begin);
    info->node_count = h.node_count;
    info->bytes = layer.size;
    info->radius = h.radius;
    info->depth_end = h.depth_end;
    info->error_p95 = h.error[0];
    info->error_max = h.error[1];
    info->error_p95_length = h.error[2];
    info->error_max_length = h.error[3];
    info->error_within = h.error[4];
    return PALPATE_OK;
}

palpate_status palpate_deformation(const palpate_field* field, const palpate_deformation_input* input, const float* vertices,
                                   const uint32_t* indices, size_t count, float* displacement,
                                   palpate_deformation_result* result) noexcept {
    if (field == nullptr || input == nullptr || input->size < sizeof *input || (count > 0 && (vertices == nullptr || displacement == nullptr)) ||
        (result != nullptr && result->size < sizeof *result)) {
        return PALPATE_BAD_ARGUMENT;
    }
    const palpate::layer_bytes& layer = field->layer[palpate::layer_deformation];
    if (layer.begin == nullptr) return PALPATE_LAYER_MISSING;
    const auto& h = *reinterpret_cast<const palpate::deformation_header*>(layer.begin);
    palpate::deformation_arrays at;
    palpate::deformation_size(h, layer.begin, at);
    palpate::place p = {};
    palpate::profiles f;
    const bool pressed = palpate::usable(*input) && palpate::placed(*field, *input, p);
    if (pressed) palpate::mix(h, at, p, f);
    size_t moved = 0;
    for (size_t i = 0; i < count; ++i) {
        const size_t v = 3 * (indices == nullptr ? i : indices[i]);
        double u[3] = {};
        if (pressed) {
            const double X[3] = {static_cast<double>(vertices[v]), static_cast<double>(vertices[v + 1]),
                                 static_cast<double>(vertices[v + 2])};
            if (palpate::move(h, at, p, f, X, u)) ++moved;
        }
        for (size_t a = 0; a < 3; ++a) displacement[v + a] = static_cast<float>(u[a]);
    }
    if (result != nullptr) {
        for (int a = 0; a < 3; ++a) {
            result->contact_point[a] = pressed ? p.c[a] : 0.0;
            result->normal[a] = pressed ? p.n[a] : 0.0;
        }
        result->depth = pressed ? p.depth : 0.0;
        result->radius = pressed ? h.radius : 0.0;
        result->moved_count = moved;
    }
    return PALPATE_OK;
}

}  // extern "C"
