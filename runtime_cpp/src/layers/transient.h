// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Event-based transients (Kuchenbecker, Fiene and Niemeyer, 2005): at a crossing of the surface with incoming velocity v the linear
// combination of the two nearest forces of a library is played open-loop along the normal of that crossing, on top of the response.
// The block's layout is fields/transient_layout.py.
#ifndef PALPATE_SRC_LAYERS_TRANSIENT_H
#define PALPATE_SRC_LAYERS_TRANSIENT_H

#include <cstddef>
#include <cstdint>

#include "layers/layers.h"
#include "palpate/palpate.h"

namespace palpate {

constexpr std::uint32_t transient_magic = 0x534e5254u;  // TRNS
constexpr std::uint32_t transient_version = 1;
constexpr std::uint32_t transient_velocity_limit = 64;
constexpr std::uint32_t transient_sample_limit = 65536;
constexpr int transient_event_limit = 4;  // that overlap

struct transient_header {
    std::uint32_t magic;
    std::uint32_t version;
    std::uint32_t velocity_count;
    std::uint32_t sample_count;
    double rate;            // Hz
    double attenuation;     // 0 to 1
    double force_short;     // N; of the device for a moment, response included
    double force_steady;    // N; for ever
    double steady_time;     // s; over which the mean square is taken
    double rearm_distance;  // m; so far off the surface another event may begin
    double rearm_time;      // s; or so long off it
    double velocity_min;    // m/s; slower contacts begin no event
    double velocity_time;   // s; memory of the line that measures the incoming velocity
    double energy_max;      // J; that one event may give to the hand
    double reserved[4];
};
static_assert(sizeof(transient_header) == 128 && offsetof(transient_header, rate) == 16 && offsetof(transient_header, energy_max) == 88,
              "fields/transient_layout.py");

struct transient_event {
    bool on;
    std::uint32_t row;  // and the next one
    double share;       // of the next row
    double gain;        // below the slowest velocity
    double age;         // s
    double normal[3];   // unit, out of the tissue, world axes
};

// Of a session; zero is the state of a fresh one.
struct transient_state {
    const unsigned char* library;  // that the events play
    transient_event event[transient_event_limit];
    bool armed, seen;       // seen: q is the last tick's
    double q[3];            // m
    double count, age, age2, sum, moment;  // weighted sums over the depths known so far of 1, t, t^2, depth, t depth; t = 0 now
    double off;             // s since contact
    double force[3];        // N; sent at the last tick
    double mean_square;     // N^2; of all that was sent
    double fade;            // 0 to 1 taken away by the steady limit
    double allowance;       // J; left of what the events so far may give
    double given, taken;    // J; by the layer to the hand, and from it, since reset
    std::uint64_t events;   // begun since reset
};

bool prove_transient(const layer_bytes& bytes, const rfield_header& h, refusal& why) noexcept;

// Adds what is played to out.force and out.torque and says so in the status that it returns.  After the response, in world axes.
std::uint32_t play_transients(transient_state& t, const layer_bytes& bytes, const palpate_tool_state& state,
                              palpate_tool_response& out) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
