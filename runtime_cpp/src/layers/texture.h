// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Texture (Hayward 2008, section 5; Campion and Hayward 2005): a small height that enters depth inside U.  With the depth d of the
// surface that has yielded, the felt depth is
//     s = d + w(d) h(q),   h(q) = sum_c m_c(q) sum_i a_i cos(2 pi (k_i . q + p_i)),   w = t^2 (3 - 2 t), t = min(1, d / fade_depth)
//     U(q) = sum_r phi_r(s) a_r(q),   grad s = - (1 + w' h) grad phi + w grad h
// so that force is minus the gradient of one potential, needs no velocity and is still when the tool is.  |h| <= fade_depth / 4, hence
// 1 + w' h >= 5/8 and s >= 0.7 d: U still rises with depth, contact begins where it did, and force is continuous.
// The waves are functions of the reference point in space (solid), not of the foot point on the surface: the foot point's derivative
// holds the second derivatives of phi, which jump from cell to cell of its lattice, and force would jump with them.
// The block's layout is fields/texture_layout.py.
#ifndef PALPATE_SRC_LAYERS_TEXTURE_H
#define PALPATE_SRC_LAYERS_TEXTURE_H

#include <cstddef>
#include <cstdint>
#include <limits>

#include "cell.h"
#include "lattice.h"
#include "layers/layers.h"
#include "palpate/palpate.h"
#include "vec.h"

struct palpate_field;
struct palpate_session;

namespace palpate {

struct response;

constexpr std::uint32_t texture_magic = 0x54584554u;  // TEXT
constexpr std::uint32_t texture_version = 2;  // 1: without the header's last number
constexpr std::uint32_t texture_group_limit = 4;  // of four waves each, which have one mask
constexpr std::uint32_t texture_wave_limit = 4 * texture_group_limit;
constexpr std::uint32_t texture_mask_limit = 4;   // channels of the masks' lattice
constexpr std::uint32_t texture_no_mask = 0xFFFFFFFFu;
constexpr double texture_height_share = 0.25;  // largest sum of amplitudes, of fade_depth

// What a device can render, Hayward's table 1; 0: not known, and then not a limit.
struct texture_limits {
    double time_factor;           // alpha
    double space_factor;          // beta
    double force_factor;          // gamma
    double resolution;            // delta, m
    double force_resolution;      // b, N
    double stiffness_max;         // A_0, N/m
    double structural_frequency;  // F_0, Hz
};

struct texture_header {
    std::uint32_t magic;
    std::uint32_t version;
    std::uint32_t group_count;
    std::uint32_t mask_stored;                        // blocks, the zero block included; 0: no masks
    std::uint32_t mask_blocks[3];
    std::uint32_t reserved;
    std::uint32_t mask_channel[texture_group_limit];  // or texture_no_mask
    double fade_depth;                                // m
    double stiffness;                                 // N/m; largest of the response, by which a height becomes a force along the normal
    texture_limits limits;                            // of the device that the scene was made for
    double mask_origin[3];                            // m
    double mask_spacing;                              // m
    double normal_force;                              // N; largest of the response, by which a slope becomes a force along the surface
};
static_assert(sizeof(texture_header) == 160 && offsetof(texture_header, normal_force) == 152 && offsetof(texture_header, mask_channel) == 32 &&
                  offsetof(texture_header, fade_depth) == 48 && offsetof(texture_header, limits) == 64 &&
                  offsetof(texture_header, mask_origin) == 120,
              "fields/texture_layout.py");

// In an opened field: pointers into the file.
struct texture_ground {
    std::int32_t group_count;  // 0: no texture
    const double *kx, *ky, *kz;  // 1/m
    const double* phase;         // cycles
    const double* amplitude;     // m, >= 0
    double fade_depth, inverse_fade_depth;  // m, 1/m
    double spatial_frequency[texture_wave_limit];  // |k|, 1/m
    double k_squared;            // 1/m^2; of the finest wave
    double stiffness;            // N/m
    double normal_force;         // N; 0: not known
    texture_limits limits;
    bool masked;
    std::uint32_t mask_channel[texture_group_limit];
    std::int32_t sole_mask;  // the channel that all masked groups have; -1: several, or none
    double sole_scale[4];    // (m, grad m) of its sums in one cell
    lattice mask;
    const float* mask_coefficients;
};

// At one place, of a session or of a sample.
struct texture_here {
    double height;       // h, m
    double gradient[3];  // grad h
    double fade_depth, inverse_fade_depth;
};

// Of a session.  Trivially copyable.
struct texture_state {
    double amplitude[texture_wave_limit];  // m; as felt now
    double gain[texture_wave_limit];       // of it, 0 to 1
    double most[texture_wave_limit];       // that the device's limits leave for ever
    double cycles;                         // largest step along a wave, in wavelengths, by the scanning limit; 0: none
    double walked;                         // m; in contact, while gains may change
    double turned_at[texture_group_limit];  // `walked` when the gains of each group last had their turn
    std::uint32_t turn;                    // group whose gains are next
    std::uint32_t limited;                 // a bit for each group: some gain is below 1
    std::uint32_t restless;                // likewise, or not what it should be
    std::uint32_t felt;                    // likewise: some amplitude is above 0
    bool own_limits;                       // `limits` were given to the session
    texture_limits limits;
};

// The cosine of x cycles, |x| <= 1/2, and its derivative, for scalars and lanes: with z = 1 - 4 x^2, -1 + z^2 Q(z), whose slope
// -8 x z P(z), P = sum (i + 2) Q_i z^i, is exactly zero at both ends; off by at most 2e-10.  Summed in thirds, not by Horner's rule,
// which waits for each step.
template <class T, class Of>
PALPATE_INLINE void cosine_of_cycles(const T& x, Of of, T& value, T& slope) noexcept {
    const T z = of(1.0) - of(4.0) * (x * x), z2 = z * z, z4 = z2 * z2;
    const auto sum = [&](const double (&c)[6]) {
        return ((of(c[0]) + of(c[1]) * z) + z2 * (of(c[2]) + of(c[3]) * z)) + z4 * (of(c[4]) + of(c[5]) * z);
    };
    constexpr double Q[6] = {1.2337004498466428, 0.6168516142877368,    0.13185525056589387,
                             0.0162187217213286, 0.0012859124735048189, 8.805110489329415e-05};
    constexpr double P[6] = {2 * Q[0], 3 * Q[1], 4 * Q[2], 5 * Q[3], 6 * Q[4], 7 * Q[5]};
    value = z2 * sum(Q) - of(1.0);
    slope = (of(-8.0) * x * z) * sum(P);
}

// The nearest whole number of |u| < 2^51.
template <class T, class Of>
PALPATE_INLINE T nearest(const T& u, Of of) noexcept {
    constexpr double half_of_all = 6755399441055744.0;  // 1.5 * 2^52: what follows the point is rounded away
    return (u + of(half_of_all)) - of(half_of_all);
}

PALPATE_INLINE void set_here(const texture_ground& ground, const double height_and_gradient[4], texture_here& here) noexcept {
    here.height = height_and_gradient[0];
    for (int a = 0; a < 3; ++a) here.gradient[a] = height_and_gradient[1 + a];
    here.fade_depth = ground.fade_depth;
    here.inverse_fade_depth = ground.inverse_fade_depth;
}

// What the response is asked for instead of depth and grad phi, and what its answer means along the real depth.
struct felt_depth {
    double depth;        // s, m
    double gradient[3];  // - grad s
    double slope, bend;  // ds/dd, d2s/dd2

    PALPATE_INLINE felt_depth(const texture_here& t, double d, const double distance_gradient[3]) noexcept {
        const double u = d * t.inverse_fade_depth;
        double w = 1.0, dw = 0.0, ddw = 0.0;
        if (u < 1.0) {
            w = u * u * (3.0 - 2.0 * u);
            dw = 6.0 * u * (1.0 - u) * t.inverse_fade_depth;
            ddw = (6.0 - 12.0 * u) * t.inverse_fade_depth * t.inverse_fade_depth;
        }
        depth = d + w * t.height;
        slope = 1.0 + dw * t.height;
        bend = ddw * t.height;
        for (int a = 0; a < 3; ++a) gradient[a] = slope * distance_gradient[a] - w * t.gradient[a];
    }
};

bool prove_texture(const layer_bytes& bytes, const rfield_header& h, refusal& why) noexcept;

// Points `ground` into a layer that was proven.
void set_texture(texture_ground& ground, const layer_bytes& bytes) noexcept;

// h and grad h at q with the given amplitudes; `kept` is of the same field, and is made q's.
void texture_at(const palpate_field& field, const double* amplitude, const double q[3], mask_cell& kept,
                texture_here& here) PALPATE_REAL_TIME;

// What the session's limits, or else the field's, leave of each wave; gains stay as they are.
void limit_texture(texture_state& t, const palpate_field& field) PALPATE_REAL_TIME;

// Full amplitudes, but for what the limits leave for ever.
void begin_texture(texture_state& t, const palpate_field& field) PALPATE_REAL_TIME;

// What the limits leave for a tool that touches down with `step` (m) in dt (s), at once: nothing is touched that could hold energy.
void touch_texture(texture_state& t, const palpate_field& field, const double step[3], double dt) PALPATE_REAL_TIME;

// The gains of the last turn go back to `gain`: what changed would have raised U.
void take_back_turn(texture_state& t, const palpate_field& field, const double gain[4]) PALPATE_REAL_TIME;

// The longest step along a wave that leaves it as it is, in wavelengths; infinite without limits.
PALPATE_INLINE double longest_step(const texture_state& t, double dt) noexcept {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const double structural = t.limits.structural_frequency * dt;
    const double own = structural > 0.0 ? structural : infinite, scanning = t.cycles > 0.0 ? t.cycles : infinite;
    return own < scanning ? own : scanning;
}

// Something may be to be done about gains: one is not at rest, or the step (its square, m^2) is too long for the finest wave.
PALPATE_INLINE bool gains_move(const texture_state& t, const texture_ground& ground, double length_squared, double dt) noexcept {
    const double reach = longest_step(t, dt);
    return t.restless != 0 || length_squared * ground.k_squared > reach * reach;
}

}  // namespace palpate

#endif
