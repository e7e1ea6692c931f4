// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "organ.h"

#include <cmath>
#include <cstring>
#include <new>

#include "guard.h"
#include "rotation.h"
#include "session.h"
#include "vec.h"

static_assert(sizeof(palpate::published_pose) % 8 == 0, "copied word by word");
static_assert(alignof(palpate_organ) <= 8, "the header promises 8");
static_assert(ATOMIC_LLONG_LOCK_FREE == 2, "wait-free needs 64-bit atomics");

namespace palpate {
namespace {

constexpr double duration_limit = 1e3;  // s

// Length within 1 % of 1; `unit` gets exactly 1.
bool normalised(const double q[4], double unit[4]) noexcept {
    double length_squared = 0.0;
    for (int a = 0; a < 4; ++a) length_squared += q[a] * q[a];
    if (!(length_squared > 0.98 && length_squared < 1.02)) return false;
    const double scale = 1.0 / std::sqrt(length_squared);
    for (int a = 0; a < 4; ++a) unit[a] = q[a] * scale;
    return true;
}

// False without news.
bool read(const palpate_organ& organ, std::uint64_t& seen, published_pose& news) noexcept {
    const std::uint64_t number = organ.latest.load(std::memory_order_acquire);
    if (number == seen) return false;
    const palpate_organ::slot& slot = organ.slots[number % palpate_organ::slot_count];
    if (slot.stamp.load(std::memory_order_acquire) != number) return false;
    std::uint64_t words[palpate_organ::word_count];
    for (std::uint64_t i = 0; i < palpate_organ::word_count; ++i) words[i] = slot.words[i].load(std::memory_order_acquire);
    if (slot.stamp.load(std::memory_order_relaxed) != number) return false;
    std::memcpy(&news, words, sizeof news);
    seen = number;
    return true;
}

// `share` of the way, 0 to 1: position linearly, orientation along the chord of the shorter way and then normalised.
void between(const rigid& from, const rigid& to, double share, rigid& pose) noexcept {
    double side = 0.0;
    for (int a = 0; a < 4; ++a) side += from.orientation[a] * to.orientation[a];
    const double sign = side < 0.0 ? -1.0 : 1.0;
    double length_squared = 0.0;
    for (int a = 0; a < 3; ++a) pose.position[a] = from.position[a] + share * (to.position[a] - from.position[a]);
    for (int a = 0; a < 4; ++a) {
        pose.orientation[a] = from.orientation[a] + share * (sign * to.orientation[a] - from.orientation[a]);
        length_squared += pose.orientation[a] * pose.orientation[a];
    }
    const double scale = 1.0 / std::sqrt(length_squared);  // at least 1/2: the two are at most a right angle apart
    for (double& x : pose.orientation) x *= scale;
}

// Where the organ is in this tick, dt (s) after the last one.
void advance(carriage& c, const palpate_tool_state& state) noexcept {
    if ((state.flags & PALPATE_INPUT_ORGAN_POSE) != 0) {
        for (int a = 0; a < 3; ++a) c.now.position[a] = state.organ_position[a];
        normalised(state.organ_orientation, c.now.orientation);
        c.to = c.now;
        c.elapsed = c.duration = 0.0;
        c.posed = true;
        return;
    }
    published_pose news;
    if (c.source != nullptr && read(*c.source, c.seen, news)) {
        c.from = c.posed ? c.now : news.pose;
        c.to = news.pose;
        c.elapsed = 0.0;
        c.duration = c.posed ? news.duration : 0.0;
        c.posed = true;
    }
    if (!c.posed) return;
    c.elapsed += state.dt;
    if (c.elapsed < c.duration) {
        between(c.from, c.to, c.elapsed / c.duration, c.now);
    } else {
        c.now = c.to;
    }
}

void turn_to_world(const rigid& pose, double v[3]) noexcept {
    const double organ[3] = {v[0], v[1], v[2]};
    rotate(pose.orientation, organ, v);
}

void place_in_world(const rigid& pose, double x[3]) noexcept {
    turn_to_world(pose, x);
    for (int a = 0; a < 3; ++a) x[a] += pose.position[a];
}

}  // namespace

std::uint32_t tick_on_organ(palpate_session& s, const palpate_tool_state& state, palpate_tool_response& out) PALPATE_REAL_TIME {
    carriage& c = s.organ;
    c.used = true;
    if (!c.started) {  // so far the organ's axes were the world's
        c.started = true;
        c.has_tool = s.has_q;
        for (int a = 0; a < 3; ++a) {
            c.tool[a] = s.q[a];
            c.force[a] = s.force[a];
        }
    }
    const bool usable = input_fault(state) == 0;
    if (usable) advance(c, state);
    palpate_tool_state seen = state;  // from the organ
    seen.flags &= ~static_cast<std::uint32_t>(PALPATE_INPUT_ORGAN_POSE);
    if (!usable) seen.dt = 0.0;  // its pose may be what cannot be used
    double tool[3];
    double hand = 0.0, relative = 0.0;  // J
    if (usable) {
        reference_point(state, s.config.reference_point, tool);
        if (c.posed) {
            double back[4];
            conjugate(c.now.orientation, back);
            const double from_origin[3] = {state.position[0] - c.now.position[0], state.position[1] - c.now.position[1],
                                           state.position[2] - c.now.position[2]};
            rotate(back, from_origin, seen.position);
            const double none[4] = {0.0, 0.0, 0.0, 1.0};
            multiply(back, (state.flags & PALPATE_INPUT_POSITION_ONLY) != 0 ? none : state.orientation, seen.orientation);
            seen.flags &= ~static_cast<std::uint32_t>(PALPATE_INPUT_POSITION_ONLY);
        }
        if (c.has_tool) {
            for (int a = 0; a < 3; ++a) hand -= c.force[a] * (tool[a] - c.tool[a]);
        }
    }
    const double force[3] = {s.force[0], s.force[1], s.force[2]};
    const double q[3] = {s.q[0], s.q[1], s.q[2]};
    const bool had_q = s.has_q;
    const std::uint32_t status = tick(s, seen, out);
    const bool rendered = usable && (status & PALPATE_TICK_BAD_INPUT) == 0;  // not further from its organ than a tool can be
    if (rendered && had_q && c.has_tool) {
        for (int a = 0; a < 3; ++a) relative -= force[a] * (s.q[a] - q[a]);
        s.books.work_in += hand - relative;
        s.books.organ_work += relative - hand;
    }
    c.has_tool = rendered;
    if (c.posed) {
        turn_to_world(c.now, out.force);
        turn_to_world(c.now, out.torque);
        turn_to_world(c.now, out.normal);
        place_in_world(c.now, out.reference_point);
        place_in_world(c.now, out.anchor);
    }
    out.work_in = s.books.work_in;
    out.organ_work = s.books.organ_work;
    for (int a = 0; a < 3; ++a) {
        if (rendered) c.tool[a] = tool[a];
        c.force[a] = out.force[a];
    }
    return status;
}

}  // namespace palpate

extern "C" {

size_t palpate_organ_size(void) noexcept { return sizeof(palpate_organ); }

palpate_status palpate_organ_init(void* memory, size_t size, palpate_organ** organ) noexcept {
    if (organ != nullptr) *organ = nullptr;
    if (organ == nullptr || memory == nullptr || size < sizeof(palpate_organ) ||
        reinterpret_cast<std::uintptr_t>(memory) % alignof(palpate_organ) != 0) {
        return PALPATE_BAD_ARGUMENT;
    }
    *organ = new (memory) palpate_organ{};
    return PALPATE_OK;
}

palpate_status palpate_organ_move(palpate_organ* organ, const double position[3], const double orientation[4],
                                  double duration) PALPATE_REAL_TIME {
    using namespace palpate;
    published_pose news;
    if (organ == nullptr || position == nullptr || orientation == nullptr || !normalised(orientation, news.pose.orientation) ||
        !(duration >= 0.0 && duration <= duration_limit)) {
        return PALPATE_BAD_ARGUMENT;
    }
    for (int a = 0; a < 3; ++a) {
        if (!within(position[a], position_limit)) return PALPATE_BAD_ARGUMENT;
        news.pose.position[a] = position[a];
    }
    news.duration = duration;
    std::uint64_t words[palpate_organ::word_count];
    std::memcpy(words, &news, sizeof news);
    const std::uint64_t number = organ->latest.load(std::memory_order_relaxed) + 1;
    palpate_organ::slot& slot = organ->slots[number % palpate_organ::slot_count];
    slot.stamp.store(0, std::memory_order_relaxed);
    // Whoever sees one of the new words sees the stamp gone.
    for (std::uint64_t i = 0; i < palpate_organ::word_count; ++i) slot.words[i].store(words[i], std::memory_order_release);
    slot.stamp.store(number, std::memory_order_release);
    organ->latest.store(number, std::memory_order_release);
    return PALPATE_OK;
}

palpate_status palpate_session_set_organ(palpate_session* session, const palpate_organ* organ) PALPATE_REAL_TIME {
    if (session == nullptr) return PALPATE_BAD_ARGUMENT;
    session->organ.source = organ;
    session->organ.seen = 0;
    session->organ.used = session->organ.used || organ != nullptr;
    return PALPATE_OK;
}

}  // extern "C"
