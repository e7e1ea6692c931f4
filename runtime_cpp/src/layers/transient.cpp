// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Energy: this force is given on purpose, so the response's accounts leave it out and this layer keeps its own.  Work that the hand
// receives, f . dq > 0, is taken from an allowance that each event fills up by energy_max; with nothing left nothing is played.  So
// given <= events energy_max + what the force of one tick does while the hand moves on for one more.
#include "layers/transient.h"

#include <cmath>
#include <cstring>

namespace palpate {
namespace {

constexpr std::uint32_t no_force = PALPATE_TICK_UNREACHED | PALPATE_TICK_TOO_DEEP | PALPATE_TICK_PASSED_THROUGH | PALPATE_TICK_WAITING |
                                   PALPATE_TICK_JUMP | PALPATE_TICK_STALE | PALPATE_TICK_BAD_INPUT | PALPATE_TICK_RELEASED;
constexpr double fade_time = 5e-3;  // s, in which the steady limit takes the force away

inline double dot3(const double a[3], const double b[3]) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void silence(transient_state& t) noexcept {
    for (transient_event& e : t.event) e.on = false;
    for (double& x : t.force) x = 0.0;
}

// Incoming velocity: the slope of the line through the depths known so far, which the organ's own motion is part of, each weighted
// by (T / (T + dt))^n, n ticks ago.  Noise of s in the depth is s sqrt(dt / T) / (2 T) of it; two filters of the depth's rate in
// its place heard an encoder's single steps, or took longer than an approach lasts.
void remember(transient_state& t, double depth, double dt, double memory) noexcept {
    const double kept = memory / (memory + dt);
    t.age2 = kept * (t.age2 - 2.0 * dt * t.age + dt * dt * t.count);
    t.moment = kept * (t.moment - dt * t.sum);
    t.age = kept * (t.age - dt * t.count);
    t.count = kept * t.count + 1.0;
    t.sum = kept * t.sum + depth;
}

// m/s; `stroke` where the surface was reached in one stroke from where no depth is known, or without memory.
double incoming(const transient_state& t, double stroke) noexcept {
    const double spread = t.count * t.age2 - t.age * t.age;
    return spread > 0.0 ? (t.count * t.moment - t.age * t.sum) / spread : stroke;
}

void begin_event(transient_state& t, const transient_header& h, const double* velocity, double v, const double normal[3],
                 std::uint32_t& status) noexcept {
    for (transient_event& e : t.event) {
        if (e.on) continue;
        e = transient_event{};
        e.on = true;
        e.gain = 1.0;
        const std::uint32_t last = h.velocity_count - 1;
        if (v <= velocity[0]) {
            e.gain = v / velocity[0];
        } else if (v >= velocity[last]) {
            e.row = last;
            if (v > velocity[last]) status |= PALPATE_TICK_TRANSIENT_LIMITED;
        } else {
            while (e.row + 1 < last && velocity[e.row + 1] <= v) ++e.row;
            e.share = (v - velocity[e.row]) / (velocity[e.row + 1] - velocity[e.row]);
        }
        for (int a = 0; a < 3; ++a) e.normal[a] = normal[a];
        t.armed = false;
        t.allowance += h.energy_max;
        ++t.events;
        return;
    }
    status |= PALPATE_TICK_TRANSIENT_LIMITED;  // all are playing
}

// N at the event's age; false when it is over.
bool played(const transient_event& e, const transient_header& h, const float* force, double& f) noexcept {
    const double x = e.age * h.rate;
    if (!(x < static_cast<double>(h.sample_count - 1))) return false;
    const auto i = static_cast<std::uint32_t>(x);
    const double w = x - static_cast<double>(i);
    const float* one = force + static_cast<std::size_t>(e.row) * h.sample_count + i;
    f = (1.0 - w) * static_cast<double>(one[0]) + w * static_cast<double>(one[1]);
    if (e.share > 0.0) {
        const float* next = one + h.sample_count;
        f += e.share * ((1.0 - w) * static_cast<double>(next[0]) + w * static_cast<double>(next[1]) - f);
    }
    f *= e.gain * h.attenuation;
    return true;
}

}  // namespace

bool prove_transient(const layer_bytes& bytes, const rfield_header&, refusal& why) noexcept {
    const auto bad = [&why](const char* what) { return refuse(why, PALPATE_BAD_LAYER, "The effect transient %s.", what); };
    if (bytes.size < sizeof(transient_header)) return bad("is shorter than its header");
    const auto& h = *reinterpret_cast<const transient_header*>(bytes.begin);
    if (h.magic != transient_magic || h.version != transient_version) return bad("is of another layout");
    if (h.velocity_count < 1 || h.velocity_count > transient_velocity_limit || h.sample_count < 2 || h.sample_count > transient_sample_limit) {
        return bad("has an impossible number of velocities or samples");
    }
    const std::uint64_t numbers = static_cast<std::uint64_t>(h.velocity_count) * h.sample_count;
    if (bytes.size != sizeof h + h.velocity_count * sizeof(double) + numbers * sizeof(float)) return bad("has not the size of its library");
    const auto within = [](double x, double least, double most) { return x >= least && x <= most; };
    if (!(within(h.rate, 100.0, 1e6) && within(h.attenuation, 0.0, 1.0) && within(h.force_short, 0.0, 1e3) &&
          within(h.force_steady, 0.0, 1e3) && within(h.steady_time, 1e-3, 1e4) && within(h.rearm_distance, 0.0, 1.0) &&
          within(h.rearm_time, 0.0, 1e3) && within(h.velocity_min, 0.0, 1e2) && within(h.velocity_time, 0.0, 1.0) &&
          within(h.energy_max, 0.0, 1e2))) {
        return bad("has a number out of range");
    }
    const auto* velocity = reinterpret_cast<const double*>(bytes.begin + sizeof h);
    for (std::uint32_t i = 0; i < h.velocity_count; ++i) {
        if (!within(velocity[i], 1e-9, 1e2) || (i > 0 && !(velocity[i] > velocity[i - 1]))) return bad("has velocities that do not rise");
    }
    const auto* force = reinterpret_cast<const float*>(velocity + h.velocity_count);
    for (std::uint64_t i = 0; i < numbers; ++i) {
        if (!(force[i] >= -1e3f && force[i] <= 1e3f)) return bad("has a force that is not finite or too large");
        const std::uint64_t at = i % h.sample_count;
        if ((at == 0 || at + 1 == h.sample_count) && force[i] != 0.0f) return bad("does not begin and end at zero");
    }
    return true;
}

std::uint32_t play_transients(transient_state& t, const layer_bytes& bytes, const palpate_tool_state& state,
                              palpate_tool_response& out) PALPATE_REAL_TIME {
    std::uint32_t status = 0;
    const auto& h = *reinterpret_cast<const transient_header*>(bytes.begin);
    const auto* velocity = reinterpret_cast<const double*>(bytes.begin + sizeof h);
    const auto* force = reinterpret_cast<const float*>(velocity + h.velocity_count);
    if (t.library != bytes.begin) {
        silence(t);
        t.library = bytes.begin;
    }
    double step[3] = {0.0, 0.0, 0.0};
    if (t.seen) {
        for (int a = 0; a < 3; ++a) step[a] = out.reference_point[a] - t.q[a];
    }
    if ((out.status & PALPATE_TICK_BAD_INPUT) != 0) {  // where the hand went is not known
        silence(t);
        t.seen = t.armed = false;
        t.count = t.age = t.age2 = t.sum = t.moment = 0.0;
        return status;
    }
    const double work = dot3(t.force, step);  // on the hand
    if (work > 0.0) {
        t.given += work;
        t.allowance -= work;
    } else {
        t.taken -= work;
    }

    const bool known = out.region == PALPATE_REGION_FREE || out.region == PALPATE_REGION_CONTACT;
    const bool inside = out.region == PALPATE_REGION_CONTACT;
    if (known) {
        remember(t, out.depth, state.dt, h.velocity_time);
    } else {
        t.count = t.age = t.age2 = t.sum = t.moment = 0.0;
    }
    for (int a = 0; a < 3; ++a) t.q[a] = out.reference_point[a];
    t.seen = true;

    const std::uint32_t faults = out.status & no_force;
    if (faults != 0) {
        silence(t);
        t.armed = false;
    }
    if (inside) {
        t.off = 0.0;
        if (t.armed && faults == 0) {
            const double v = incoming(t, -dot3(step, out.normal) / state.dt);
            if (v >= h.velocity_min && v > 0.0) begin_event(t, h, velocity, v, out.normal, status);
        }
        t.armed = false;  // a contact begins once
    } else {
        t.off += state.dt;
        if (!known || -out.depth >= h.rearm_distance || t.off >= h.rearm_time) t.armed = faults == 0;
    }

    double f[3] = {0.0, 0.0, 0.0};
    bool playing = false;
    for (transient_event& e : t.event) {
        if (!e.on) continue;
        double size = 0.0;
        e.on = played(e, h, force, size);
        if (!e.on) continue;
        playing = true;
        e.age += state.dt;
        for (int a = 0; a < 3; ++a) f[a] += size * e.normal[a];
    }
    const double change = state.dt < fade_time ? state.dt / fade_time : 1.0;
    const bool hot = t.mean_square > h.force_steady * h.force_steady;
    t.fade += hot ? change : -change;
    t.fade = t.fade < 0.0 ? 0.0 : t.fade > 1.0 ? 1.0 : t.fade;
    if (playing) {
        status |= PALPATE_TICK_TRANSIENT;
        double gain = 1.0 - t.fade;
        if (t.allowance <= 0.0) gain = 0.0;
        const double ff = dot3(f, f) * gain * gain, fr = dot3(f, out.force) * gain;
        const double spare = h.force_short * h.force_short - dot3(out.force, out.force);
        if (spare <= 0.0) {
            gain = 0.0;
        } else if (ff > 0.0 && ff + 2.0 * fr > spare) {  // |r + g f| = limit
            gain *= (std::sqrt(fr * fr + ff * spare) - fr) / ff;
        }
        if (gain < 1.0) status |= PALPATE_TICK_TRANSIENT_LIMITED;
        for (double& x : f) x *= gain;
        const double arm[3] = {out.reference_point[0] - state.position[0], out.reference_point[1] - state.position[1],
                               out.reference_point[2] - state.position[2]};
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            out.force[a] += f[a];
            out.torque[a] += arm[b] * f[c] - arm[c] * f[b];
        }
    }
    for (int a = 0; a < 3; ++a) t.force[a] = f[a];
    t.mean_square += state.dt / (h.steady_time + state.dt) * (dot3(out.force, out.force) - t.mean_square);
    out.status |= status;
    return status;
}

}  // namespace palpate
