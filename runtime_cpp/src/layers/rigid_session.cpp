// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// One tick of rigid contact: where the object is, what it touches, how it came there, which wrench that gives.
#include "rigid_inertia.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <new>

namespace palpate {
namespace {

constexpr double position_limit = 1e3;
constexpr double shortest_tick = 1e-9;  // s; velocities and accelerations over less are not finite
constexpr double fastest = 1e6;         // m/s; also where speed_max is 0
constexpr int look_limit = 16;  // looks between two ticks
constexpr std::size_t config_size_before_coupling = offsetof(palpate_rigid_config, coupling_stiffness);

bool usable(const palpate_rigid_state& s) noexcept {
    bool good = s.dt >= shortest_tick && s.dt <= 1e9;
    double square = 0.0;
    for (double x : s.position) good = good && std::fabs(x) <= position_limit;
    for (double x : s.orientation) square += x * x;
    return good && square > 0.98 && square < 1.02;
}

rigid_place place_of(const palpate_rigid_state& s, const double grip[3]) noexcept {
    rigid_place at;
    const double* u = s.orientation;
    const double scale = 1.0 / std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3]);
    for (int i = 0; i < 4; ++i) at.orientation[i] = u[i] * scale;
    double arm[3];
    rotate(at.orientation, grip, arm);
    for (int i = 0; i < 3; ++i) at.position[i] = s.position[i] - arm[i];
    return at;
}

// What the hand did over the step with the wrench sent before.
void book_step(palpate_rigid_session& s, const double moved[3], const double turned[3]) noexcept {
    s.account.work -= dot(s.force, moved) + dot(s.torque, turned);
    const double taken = -(dot(s.inertia_force, moved) + dot(s.inertia_torque, turned));
    s.account.inertial += taken;
    s.lent += taken;
    s.account.gravity -= s.gravity_on * s.scene->head.mass * dot(s.scene->head.gravity, moved);
}

// The object is where the device is.
std::uint32_t direct_tick(palpate_rigid_session& s, const palpate_rigid_state& state, const rigid_place& to, const double moved[3],
                          const double turned[3], double step, std::uint32_t status, palpate_rigid_response& out) noexcept {
    const palpate_rigid& scene = *s.scene;
    const rigid_header& h = scene.head;
    const rigid_pose pose = pose_of(to);
    rigid_touches touches;
    if (s.known != 0 && status == 0 && s.waiting == 0 && rigid_passed_something(s, to, step, touches)) status |= PALPATE_RIGID_TICK_JUMP;
    if (status != 0 || s.known == 0) rigid_release(s);
    if (s.known != 0 && status == 0) track(s.velocity, moved, turned, state.dt, s.config.filter_time);
    rigid_contacts now;
    status = rigid_meet(s, pose, step, status, touches, now);
    s.device = to;
    s.known = 1;
    if ((status & rigid_zero_wrench) != 0) {
        rigid_release(s);
        s.at = to;
        rigid_tell(s, out);
        return out.status = status;
    }
    rigid_render(s, now, to, pose, moved, turned, state.dt, out);
    if (now.count > 0 && h.formation_count > 0 && out.formation == 0xffffffffu) status |= PALPATE_RIGID_TICK_NOT_IN_TABLE;
    double force[3], torque[3];
    for (int i = 0; i < 3; ++i) {
        s.inertia_force[i] = s.inertia_torque[i] = 0.0;
        force[i] = out.contact_force[i] + h.mass * h.gravity[i];
        torque[i] = out.contact_torque[i];
    }
    rigid_lose_kinetic(s, pose);
    if (now.count == 0 && s.config.inertia != 0) {
        rigid_free_inertia(s, pose, moved, turned, state.dt);
        for (int i = 0; i < 3; ++i) {
            force[i] += s.inertia_force[i];
            torque[i] += s.inertia_torque[i];
        }
    }
    double arm[3], about[3];
    for (int i = 0; i < 3; ++i) arm[i] = to.position[i] - state.position[i];
    const double kept = rigid_limit(s, force, torque, arm, status);
    cross(arm, force, about);
    for (int i = 0; i < 3; ++i) {
        s.inertia_force[i] *= kept;
        s.inertia_torque[i] *= kept;
        s.force[i] = force[i];
        s.torque[i] = torque[i];
        out.force[i] = force[i];
        out.torque[i] = torque[i] + about[i];
    }
    s.gravity_on = 1.0;
    s.at = to;
    rigid_tell(s, out);
    return out.status = status;
}

std::uint32_t tick(palpate_rigid_session& s, const palpate_rigid_state& state, palpate_rigid_response& out) noexcept {
    const std::uint32_t size = out.size;
    std::memset(static_cast<void*>(&out), 0, sizeof out);
    out.size = size;
    out.formation = 0xffffffffu;
    if (!usable(state)) {
        rigid_release(s);
        s.known = 0;
        rigid_tell(s, out);
        return out.status = PALPATE_RIGID_TICK_BAD_INPUT;
    }
    const rigid_place device = place_of(state, s.config.grip);
    double moved[3] = {0.0, 0.0, 0.0}, turned[3] = {0.0, 0.0, 0.0}, step = 0.0;
    std::uint32_t status = 0;
    if (s.known != 0) {
        for (int i = 0; i < 3; ++i) moved[i] = device.position[i] - s.device.position[i];
        turn_between(s.device.orientation, device.orientation, turned);
        step = std::sqrt(dot(moved, moved)) + s.scene->head.held_radius * std::sqrt(dot(turned, turned));
        book_step(s, moved, turned);
        if (state.dt > s.config.dt_max) status |= PALPATE_RIGID_TICK_STALE;
        else if (step > (s.config.speed_max > 0.0 ? s.config.speed_max : fastest) * state.dt) status |= PALPATE_RIGID_TICK_JUMP;
    }
    if ((state.flags & PALPATE_INPUT_RELEASE) != 0) status |= PALPATE_RIGID_TICK_RELEASED;
    if (rigid_has_coupling(s)) return rigid_coupled_tick(s, state, device, moved, turned, status, out);
    return direct_tick(s, state, device, moved, turned, step, status, out);
}

}  // namespace

void rigid_release(palpate_rigid_session& s) noexcept {
    s.count = 0;
    s.waiting = 1;
    s.velocity.known = 0;
    for (int i = 0; i < 3; ++i) {
        s.force[i] = s.torque[i] = s.inertia_force[i] = s.inertia_torque[i] = 0.0;
        s.velocity.linear[i] = s.velocity.angular[i] = s.velocity.acceleration[i] = s.velocity.angular_acceleration[i] = 0.0;
    }
    s.stored = 0.0;
    if (s.lent > 0.0) s.lent = 0.0;  // the object's motion is lost; what the hand owes is not
    s.gravity_on = 0.0;
    const double given = s.coupled.given;
    s.coupled = rigid_coupled{};
    s.coupled.given = given;
}

bool rigid_passed_something(const palpate_rigid_session& s, const rigid_place& to, double step, rigid_touches& touches) noexcept {
    const rigid_header& h = s.scene->head;
    if (step <= h.depth_max) return false;
    const double looks = step / h.depth_max;
    if (!(looks <= look_limit)) return true;
    const int count = static_cast<int>(looks) + 1;
    for (int k = 1; k < count; ++k) {
        rigid_find_touches(*s.scene, pose_of(part_way(s.at, to, static_cast<double>(k) / count)), 0.0, h.depth_max, touches);
        if (touches.count > 0) return true;
    }
    return false;
}

std::uint32_t rigid_meet(palpate_rigid_session& s, const rigid_pose& pose, double step, std::uint32_t status, rigid_touches& touches,
                         rigid_contacts& now) noexcept {
    const rigid_header& h = s.scene->head;
    rigid_find_touches(*s.scene, pose, rigid_reach(h), 2.0 * h.depth_max, touches);
    rigid_keys keys;
    keys.count = s.count;
    for (std::uint32_t i = 0; i < s.count; ++i) keys.key[i] = s.contact[i].key;
    rigid_gather(*s.scene, touches, keys, now);
    double deepest = 0.0;
    for (std::uint32_t i = 0; i < touches.count; ++i) deepest = touches.at[i].gap < deepest ? touches.at[i].gap : deepest;
    if (s.waiting != 0) {
        if (now.count == 0 && (status & rigid_zero_wrench) == 0) s.waiting = 0;
        else if (now.count > 0) status |= PALPATE_RIGID_TICK_WAITING;
    } else if (deepest < -h.depth_max) {
        status |= PALPATE_RIGID_TICK_TOO_DEEP;
    } else if (s.count == 0 && now.count > 0) {
        // Coming from free space, no contact is deeper than the step allows; a deeper one is met from inside.
        for (std::uint32_t i = 0; i < now.count; ++i) {
            if (now.at[i].gap < 0.5 * h.threshold - 1.5 * step) status |= PALPATE_RIGID_TICK_WAITING;
        }
    }
    if (now.overflow != 0) status |= PALPATE_RIGID_TICK_OVERFLOW;
    return status;
}

double rigid_limit(const palpate_rigid_session& s, double force[3], double torque[3], const double arm[3], std::uint32_t& status) noexcept {
    double about[3], keep = 1.0;
    cross(arm, force, about);
    for (int i = 0; i < 3; ++i) about[i] += torque[i];
    const double f = std::sqrt(dot(force, force)), t = std::sqrt(dot(about, about));
    if (s.config.force_max > 0.0 && f > s.config.force_max) keep = s.config.force_max / f;
    if (s.config.torque_max > 0.0 && t * keep > s.config.torque_max) keep = s.config.torque_max / t;
    if (keep < 1.0) {
        status |= PALPATE_RIGID_TICK_FORCE_LIMITED;
        for (int i = 0; i < 3; ++i) {
            force[i] *= keep;
            torque[i] *= keep;
        }
    }
    return keep;
}

void rigid_tell(const palpate_rigid_session& s, palpate_rigid_response& out) noexcept {
    for (int i = 0; i < 3; ++i) {
        out.velocity[i] = s.velocity.linear[i];
        out.angular_velocity[i] = s.velocity.angular[i];
        out.acceleration[i] = s.velocity.acceleration[i];
        out.angular_acceleration[i] = s.velocity.angular_acceleration[i];
    }
    const rigid_books& b = s.account;
    out.stored_energy = s.stored + s.coupled.moving + s.coupled.spring;
    out.work_in = b.work;
    out.dissipated_friction = b.friction;
    out.dissipated_damping = b.damping;
    out.inertial = b.inertial;
    out.gravity_work = b.gravity;
    out.unaccounted = b.work - out.stored_energy - b.friction - b.damping - b.inertial - b.gravity;
}

}  // namespace palpate

using namespace palpate;

extern "C" void palpate_rigid_config_default(palpate_rigid_config* config) PALPATE_NOEXCEPT {
    if (config == nullptr) return;
    *config = palpate_rigid_config{};
    config->size = sizeof *config;
    config->inertia = 1;
    config->speed_max = 5.0;
    config->dt_max = 0.1;
    config->filter_time = 0.005;
    config->acceleration_max = rigid_acceleration_max;
}

extern "C" size_t palpate_rigid_session_size(void) PALPATE_NOEXCEPT { return sizeof(palpate_rigid_session); }

extern "C" palpate_status palpate_rigid_session_init(void* memory, size_t size, const palpate_rigid* rigid,
                                                     const palpate_rigid_config* config,
                                                     palpate_rigid_session** session) PALPATE_NOEXCEPT {
    if (session != nullptr) *session = nullptr;
    if (memory == nullptr || rigid == nullptr || session == nullptr || size < sizeof(palpate_rigid_session) ||
        reinterpret_cast<std::uintptr_t>(memory) % alignof(palpate_rigid_session) != 0) {
        return PALPATE_BAD_ARGUMENT;
    }
    palpate_rigid_config chosen;
    palpate_rigid_config_default(&chosen);
    if (config != nullptr) {
        if (config->size < config_size_before_coupling) return PALPATE_BAD_ARGUMENT;
        const palpate_rigid_config absent = chosen;
        std::memcpy(&chosen, config, config->size < sizeof chosen ? config->size : sizeof chosen);
        if (config->size < sizeof chosen) {
            chosen.coupling_stiffness = absent.coupling_stiffness;
            chosen.coupling_damping = absent.coupling_damping;
            chosen.coupling_torsional_stiffness = absent.coupling_torsional_stiffness;
            chosen.coupling_torsional_damping = absent.coupling_torsional_damping;
            chosen.acceleration_max = absent.acceleration_max;
        }
    }
    bool good = chosen.inertia <= 1 && chosen.speed_max >= 0.0 && chosen.speed_max <= 1e6 && chosen.dt_max > 0.0 && chosen.dt_max <= 1e6 &&
                chosen.force_max >= 0.0 && chosen.force_max <= 1e6 && chosen.torque_max >= 0.0 && chosen.torque_max <= 1e6 &&
                chosen.filter_time >= 0.0 && chosen.filter_time <= 10.0 && chosen.coupling_stiffness >= 0.0 &&
                chosen.coupling_stiffness <= 1e6 && chosen.coupling_damping >= 0.0 && chosen.coupling_damping <= 1e5 &&
                chosen.coupling_torsional_stiffness >= 0.0 && chosen.coupling_torsional_stiffness <= 1e5 &&
                chosen.coupling_torsional_damping >= 0.0 && chosen.coupling_torsional_damping <= 1e4;
    const bool straight = chosen.coupling_stiffness > 0.0, turning = chosen.coupling_torsional_stiffness > 0.0;
    good = good && straight == turning && (straight || (chosen.coupling_damping == 0.0 && chosen.coupling_torsional_damping == 0.0)) &&
           (!straight || chosen.acceleration_max > 0.0) && chosen.acceleration_max <= 1e6;
    for (double x : chosen.grip) good = good && std::fabs(x) <= 10.0;
    if (!good) return PALPATE_BAD_ARGUMENT;
    palpate_rigid_session* s = new (memory) palpate_rigid_session{};
    s->scene = rigid;
    s->config = chosen;
    rigid_release(*s);
    *session = s;
    return PALPATE_OK;
}

extern "C" palpate_status palpate_rigid_session_reset(palpate_rigid_session* session) PALPATE_REAL_TIME {
    if (session == nullptr) return PALPATE_BAD_ARGUMENT;
    const palpate_rigid* scene = session->scene;
    const palpate_rigid_config config = session->config;
    *session = palpate_rigid_session{};
    session->scene = scene;
    session->config = config;
    rigid_release(*session);
    return PALPATE_OK;
}

extern "C" palpate_status palpate_rigid_session_place(const palpate_rigid_session* session, double position[3],
                                                      double orientation[4]) PALPATE_REAL_TIME {
    if (session == nullptr || position == nullptr || orientation == nullptr || session->known == 0) return PALPATE_BAD_ARGUMENT;
    for (int i = 0; i < 3; ++i) position[i] = session->at.position[i];
    for (int i = 0; i < 4; ++i) orientation[i] = session->at.orientation[i];
    return PALPATE_OK;
}

extern "C" uint32_t palpate_rigid_tick(palpate_rigid_session* session, const palpate_rigid_state* state,
                                       palpate_rigid_response* response) PALPATE_REAL_TIME {
    if (session == nullptr || state == nullptr || response == nullptr || state->size < sizeof *state || response->size < sizeof *response) {
        return PALPATE_RIGID_TICK_BAD_ARGUMENT;
    }
    return tick(*session, *state, *response);
}

extern "C" uint32_t palpate_rigid_tick_batch(palpate_rigid_session* session, const palpate_rigid_state* states,
                                             palpate_rigid_response* responses, size_t count) PALPATE_REAL_TIME {
    if (session == nullptr || states == nullptr || responses == nullptr || count == 0 || states->size < sizeof *states ||
        responses->size < sizeof *responses || states->size % 8 != 0 || responses->size % 8 != 0) {
        return PALPATE_RIGID_TICK_BAD_ARGUMENT;
    }
    const unsigned char* in = reinterpret_cast<const unsigned char*>(states);
    unsigned char* out = reinterpret_cast<unsigned char*>(responses);
    const std::uint32_t in_step = states->size, out_step = responses->size;
    std::uint32_t all = 0;
    for (size_t i = 0; i < count; ++i) {
        palpate_rigid_response& r = *reinterpret_cast<palpate_rigid_response*>(out + i * out_step);
        r.size = out_step;
        all |= palpate_rigid_tick(session, reinterpret_cast<const palpate_rigid_state*>(in + i * in_step), &r);
    }
    return all;
}

extern "C" palpate_status palpate_rigid_identify(const palpate_rigid* rigid, const palpate_rigid_state* states,
                                                 palpate_rigid_response* responses, size_t count) PALPATE_REAL_TIME {
    if (rigid == nullptr || states == nullptr || responses == nullptr) return PALPATE_BAD_ARGUMENT;
    for (size_t i = 0; i < count; ++i) {
        palpate_rigid_response& out = responses[i];
        std::memset(static_cast<void*>(&out), 0, sizeof out);
        out.size = sizeof out;
        out.formation = 0xffffffffu;
        if (states[i].size < sizeof states[i] || !usable(states[i])) {
            out.status = PALPATE_RIGID_TICK_BAD_INPUT;
            continue;
        }
        const double none[3] = {0.0, 0.0, 0.0};
        rigid_touches touches;
        rigid_contacts now;
        const rigid_keys keys{};
        rigid_find_touches(*rigid, pose_of(place_of(states[i], none)), rigid_reach(rigid->head), 2.0 * rigid->head.depth_max, touches);
        rigid_gather(*rigid, touches, keys, now);
        out.contact_count = now.count;
        out.formation = rigid_formation_index(*rigid, now);
        if (now.overflow != 0) out.status |= PALPATE_RIGID_TICK_OVERFLOW;
        const rigid_held_contact blank{};
        for (std::uint32_t k = 0; k < now.count; ++k) rigid_tell_contact(now.at[k], blank, 0.0, out.contact[k]);
    }
    return PALPATE_OK;
}

extern "C" uint32_t palpate_rigid_add(const double force_a[3], const double torque_a[3], const double force_b[3], const double torque_b[3],
                                      double force_max, double torque_max, double force[3], double torque[3]) PALPATE_REAL_TIME {
    double f[3], t[3], keep = 1.0;
    for (int i = 0; i < 3; ++i) {
        f[i] = force_a[i] + force_b[i];
        t[i] = torque_a[i] + torque_b[i];
    }
    const double size = std::sqrt(dot(f, f)), turn = std::sqrt(dot(t, t));
    const bool finite = size <= 1e12 && turn <= 1e12;
    if (force_max > 0.0 && size > force_max) keep = force_max / size;
    if (torque_max > 0.0 && turn * keep > torque_max) keep = torque_max / turn;
    for (int i = 0; i < 3; ++i) {
        force[i] = finite ? keep * f[i] : 0.0;
        torque[i] = finite ? keep * t[i] : 0.0;
    }
    return keep < 1.0 || !finite ? 1u : 0u;
}

extern "C" const char* palpate_rigid_tick_text(uint32_t status) PALPATE_NOEXCEPT {
    static const char* const text[] = {
        "The held object moved faster than it can be followed: released until it is in free space.",
        "The tick came too late: released until the held object is in free space.",
        "A number is not finite, dt is not above zero, or the orientation is no unit quaternion: released.",
        "A pointer is null or a struct too small: nothing was read or written.",
        "Let go, as asked.",
        "Deeper than contact is followed: released until the held object is in free space.",
        "The held object is among the fixed ones without having come from free space: no wrench until it has been there.",
        "The wrench was kept within the device's limit.",
        "There are more contacts than are kept.",
        "The contact formation is not in the table of valid ones; it is rendered as found.",
        "The coupling gave less than its spring: the hand has not put in the energy."};
    for (unsigned bit = 0; bit < sizeof text / sizeof *text; ++bit) {
        if ((status >> bit & 1u) != 0) return text[bit];
    }
    return "An ordinary tick.";
}
