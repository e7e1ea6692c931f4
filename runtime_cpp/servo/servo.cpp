// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "servo.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <vector>

#include "palpate/servo_thread.hpp"

#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#include <sched.h>
#endif

namespace {

struct pose {
    double position[3];     // m
    double orientation[4];  // x y z w
};

struct target {
    pose to;
    double duration;       // s
    std::uint32_t flags;   // PALPATE_INPUT_
    std::uint32_t number;  // rises with every target
};

struct felt {
    palpate_tool_response response;
    pose at;
    std::uint64_t contact_ticks, slip_ticks;
    double longest;  // s
    std::uint32_t real_time;
};

bool usable(const double* position, const double* orientation) {
    if (position == nullptr || orientation == nullptr) return false;
    double square = 0.0;
    for (int a = 0; a < 4; ++a) square += orientation[a] * orientation[a];
    bool finite = std::isfinite(square);
    for (int a = 0; a < 3; ++a) finite = finite && std::fabs(position[a]) <= 1e3;
    return finite && std::fabs(std::sqrt(square) - 1.0) <= 0.01;
}

pose pose_of(const double* position, const double* orientation) {
    return {{position[0], position[1], position[2]}, {orientation[0], orientation[1], orientation[2], orientation[3]}};
}

// Share `s` (0 to 1) of the way; orientations on the nearer of the two ways round.
pose between(const pose& from, const pose& to, double s) {
    pose p{};
    for (int a = 0; a < 3; ++a) p.position[a] = from.position[a] + s * (to.position[a] - from.position[a]);
    double cosine = 0.0;
    for (int a = 0; a < 4; ++a) cosine += from.orientation[a] * to.orientation[a];
    const double sign = cosine < 0.0 ? -1.0 : 1.0;
    double square = 0.0;
    for (int a = 0; a < 4; ++a) {
        p.orientation[a] = from.orientation[a] + s * (sign * to.orientation[a] - from.orientation[a]);
        square += p.orientation[a] * p.orientation[a];
    }
    const double length = std::sqrt(square);  // at least 0.7 of a unit: the two are at most a right angle apart
    for (int a = 0; a < 4; ++a) p.orientation[a] /= length;
    return p;
}

// The calling thread above all ordinary ones, as far as the system lets it; the least of the real-time priorities is enough.
bool ask_for_real_time() {
#if defined(__unix__) || defined(__APPLE__)
    sched_param parameter{};
    parameter.sched_priority = sched_get_priority_min(SCHED_RR);
    return pthread_setschedparam(pthread_self(), SCHED_RR, &parameter) == 0;
#else
    return false;
#endif
}

}  // namespace

struct palpate_servo {
    std::vector<std::uint64_t> memory;
    palpate_session* session = nullptr;
    palpate::latest<target> wanted;  // written by who leads the tool
    palpate::latest<felt> shared;    // written by the loop
    std::atomic<const palpate_field*> next_field{nullptr};
    std::atomic<bool> reset{false};
    std::uint32_t number = 0;  // of the last target that was given

    // The loop's own.
    pose at{}, from{};
    target going{};
    double gone = 0.0;  // s, of going.duration
    felt now{};
    bool began = false;

    std::unique_ptr<palpate::servo_thread> loop;  // last: it uses the others

    void step(double dt) noexcept {
        if (!began) {
            now.real_time = ask_for_real_time() ? 1u : 0u;
            began = true;
        } else if (dt > now.longest) {
            now.longest = dt;
        }
        if (const palpate_field* field = next_field.exchange(nullptr)) palpate_session_set_field(session, field);
        if (reset.exchange(false)) palpate_session_reset(session);
        target given{};
        if (wanted.read(given) && given.number != going.number) {
            going = given;
            from = at;
            gone = 0.0;
        }
        if (going.number != 0 && gone < going.duration) {
            gone += dt;
            at = between(from, going.to, gone < going.duration ? gone / going.duration : 1.0);
        } else if (going.number != 0) {
            at = going.to;
        }
        palpate_tool_state state{};
        state.size = sizeof state;
        state.flags = going.flags;
        state.dt = dt;
        for (int a = 0; a < 3; ++a) state.position[a] = at.position[a];
        for (int a = 0; a < 4; ++a) state.orientation[a] = at.orientation[a];
        now.response.size = sizeof now.response;
        palpate_tick(session, &state, &now.response);
        now.at = at;
        if (now.response.region == PALPATE_REGION_CONTACT) ++now.contact_ticks;
        if ((now.response.status & PALPATE_TICK_SLIPPING) != 0) ++now.slip_ticks;
        shared.publish(now);
    }
};

palpate_status palpate_servo_start(const palpate_field* field, const palpate_config* config, double rate,
                                   const double position[3], const double orientation[4], palpate_servo** servo) {
    if (servo == nullptr) return PALPATE_BAD_ARGUMENT;
    *servo = nullptr;
    if (field == nullptr || !(rate >= 10.0 && rate <= 1e5) || !usable(position, orientation)) return PALPATE_BAD_ARGUMENT;
    try {
        auto made = std::make_unique<palpate_servo>();
        made->memory.resize((palpate_session_size() + 7) / 8);
        const palpate_status status =
            palpate_session_init(made->memory.data(), 8 * made->memory.size(), field, config, &made->session);
        if (status != PALPATE_OK) return status;
        made->at = made->from = pose_of(position, orientation);
        const std::chrono::nanoseconds period(static_cast<std::chrono::nanoseconds::rep>(1e9 / rate));
        palpate_servo* self = made.get();
        made->loop = std::make_unique<palpate::servo_thread>(period, [self](double dt) noexcept { self->step(dt); });
        *servo = made.release();
        return PALPATE_OK;
    } catch (...) {  // no memory, or no thread
        return PALPATE_OUT_OF_MEMORY;
    }
}

palpate_status palpate_servo_move(palpate_servo* servo, const double position[3], const double orientation[4], double duration,
                                  uint32_t flags) {
    if (servo == nullptr || !usable(position, orientation)) return PALPATE_BAD_ARGUMENT;
    if (!(duration >= 0.0 && duration <= 1e3) || (flags & ~PALPATE_INPUT_RELEASE) != 0) return PALPATE_BAD_ARGUMENT;
    if (++servo->number == 0) servo->number = 1;
    servo->wanted.publish(target{pose_of(position, orientation), duration, flags, servo->number});
    return PALPATE_OK;
}

palpate_status palpate_servo_set_field(palpate_servo* servo, const palpate_field* field) {
    if (servo == nullptr || field == nullptr) return PALPATE_BAD_ARGUMENT;
    servo->next_field.store(field);
    return PALPATE_OK;
}

palpate_status palpate_servo_reset(palpate_servo* servo) {
    if (servo == nullptr) return PALPATE_BAD_ARGUMENT;
    servo->reset.store(true);
    return PALPATE_OK;
}

palpate_status palpate_servo_read(const palpate_servo* servo, palpate_servo_state* state) {
    felt now{};
    if (servo == nullptr || state == nullptr || state->size < sizeof *state || !servo->shared.read(now)) return PALPATE_BAD_ARGUMENT;
    state->real_time = now.real_time;
    state->ticks = servo->loop->ticks();
    state->missed = servo->loop->missed();
    state->contact_ticks = now.contact_ticks;
    state->slip_ticks = now.slip_ticks;
    state->longest = now.longest;
    for (int a = 0; a < 3; ++a) state->position[a] = now.at.position[a];
    for (int a = 0; a < 4; ++a) state->orientation[a] = now.at.orientation[a];
    state->response = now.response;
    return PALPATE_OK;
}

void palpate_servo_stop(palpate_servo* servo) {
    if (servo == nullptr) return;
    servo->loop->stop();
    delete servo;
}
