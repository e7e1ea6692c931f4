// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// One tick of rigid contact: where the object is, what it touches, how it came there, which wrench that gives.
#include <cmath>
#include <cstring>
#include <new>

#include "rigid_friction.h"
#include "rigid_motion.h"

namespace palpate {
namespace {

constexpr std::uint32_t zero_wrench = PALPATE_RIGID_TICK_JUMP | PALPATE_RIGID_TICK_STALE | PALPATE_RIGID_TICK_BAD_INPUT |
                                      PALPATE_RIGID_TICK_RELEASED | PALPATE_RIGID_TICK_TOO_DEEP | PALPATE_RIGID_TICK_WAITING;
constexpr double position_limit = 1e3;
constexpr int look_limit = 16;  // looks between two ticks

struct held_contact {
    std::uint32_t key, reserved;
    rigid_grip grip;
    double point[3], normal[3];
    double friction[3], torque, energy;  // sent in the last tick
    double damped;                       // N; the damping part of the normal force
    double gyration;
};

struct books {
    double work, friction, damping, inertial, gravity, start;
};

}  // namespace
}  // namespace palpate

struct palpate_rigid_session {
    const palpate_rigid* scene;
    palpate_rigid_config config;
    palpate::rigid_place at;
    std::uint32_t known, waiting;  // whether `at` is a place; not come from free space
    palpate::rigid_velocity velocity;
    std::uint32_t count, reserved;
    palpate::held_contact contact[palpate::rigid_contact_limit];
    double force[3], torque[3];             // sent: on the hand; torque about the centre of mass
    double inertia_force[3], inertia_torque[3];
    double stored, gravity_on;              // J; 1 while gravity is rendered
    palpate::books account;
};

namespace palpate {
namespace {

bool usable(const palpate_rigid_state& s) noexcept {
    bool good = s.dt > 0.0 && s.dt <= 1e9;
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

double reach_of(const rigid_header& h) noexcept { return h.threshold * (1.0 + h.hysteresis); }

// Step of the held object's material at x (m) between two places.
void material_step(const rigid_place& before, const rigid_place& now, const double turned[3], const double x[3], double step[3]) noexcept {
    const double arm[3] = {x[0] - now.position[0], x[1] - now.position[1], x[2] - now.position[2]};
    cross(turned, arm, step);  // to first order in the tick's turn
    for (int i = 0; i < 3; ++i) step[i] += now.position[i] - before.position[i];
}

void release(palpate_rigid_session& s) noexcept {
    s.count = 0;
    s.waiting = 1;
    s.velocity.known = 0;
    for (int i = 0; i < 3; ++i) {
        s.force[i] = s.torque[i] = s.inertia_force[i] = s.inertia_torque[i] = 0.0;
        s.velocity.linear[i] = s.velocity.angular[i] = s.velocity.acceleration[i] = s.velocity.angular_acceleration[i] = 0.0;
    }
    s.stored = 0.0;
    s.gravity_on = 0.0;
}

// What the hand did over the step with the wrench sent before.
void book_step(palpate_rigid_session& s, const double moved[3], const double turned[3]) noexcept {
    s.account.work -= dot(s.force, moved) + dot(s.torque, turned);
    s.account.inertial -= dot(s.inertia_force, moved) + dot(s.inertia_torque, turned);
    s.account.gravity -= s.gravity_on * s.scene->head.mass * dot(s.scene->head.gravity, moved);
}

// Whether a look between two ticks met something that neither end shows.
bool passed_something(const palpate_rigid_session& s, const rigid_place& to, double step, rigid_touches& touches, bool& too_far) noexcept {
    const rigid_header& h = s.scene->head;
    too_far = false;
    if (step <= h.depth_max) return false;
    const double looks = step / h.depth_max;
    too_far = looks > look_limit;
    const int count = too_far ? look_limit : static_cast<int>(looks) + 1;
    for (int k = 1; k < count; ++k) {
        rigid_find_touches(*s.scene, pose_of(part_way(s.at, to, static_cast<double>(k) / count)), 0.0, h.depth_max, touches);
        if (touches.count > 0) return true;
    }
    return false;
}

// MT1 (equations 1 and 2): friction at the moment of contact, from the impulse and the accelerations before it.  Sets whether it sticks.
void guarded(const palpate_rigid_session& s, const rigid_pose& pose, const rigid_principal& pc, double normal_force,
             rigid_grip& grip) noexcept {
    const rigid_header& h = s.scene->head;
    const rigid_velocity& v = s.velocity;
    double arm[3], speed[3], applied[3], torque[3];
    for (int i = 0; i < 3; ++i) arm[i] = pc.point[i] - s.at.position[i];
    cross(v.angular, arm, speed);
    double spin[3] = {speed[0], speed[1], speed[2]};
    for (int i = 0; i < 3; ++i) {
        speed[i] += v.linear[i];
        applied[i] = h.mass * v.acceleration[i];
    }
    inertia_times(h.inertia, pose, v.angular_acceleration, torque);
    const double size = std::sqrt(dot(torque, torque)), turning = std::sqrt(dot(spin, spin));
    if (size > 1e-12 && turning > 1e-12) {
        double lever[3];
        cross(torque, arm, lever);
        const double r = std::sqrt(dot(lever, lever)) / size;  // from the point to the axis of torque
        if (r > 1e-6) {
            for (int i = 0; i < 3; ++i) applied[i] += size / r * spin[i] / turning;
        }
    }
    const double fast = std::sqrt(dot(speed, speed));
    grip = rigid_grip{};
    if (!(fast > 1e-12)) return;
    double u[3], down = 0.0;
    for (int i = 0; i < 3; ++i) u[i] = speed[i] / fast;
    down = dot(u, pc.normal);
    double impulse = down < -1e-9 ? -(normal_force + dot(applied, pc.normal)) / down : 0.0;
    if (impulse < 0.0) impulse = 0.0;  // an impulse does not pull
    double friction[3];
    for (int i = 0; i < 3; ++i) friction[i] = -(applied[i] + impulse * u[i]);
    const double through = dot(friction, pc.normal);
    for (int i = 0; i < 3; ++i) friction[i] -= through * pc.normal[i];
    const double along = std::sqrt(dot(friction, friction)), most = h.static_friction * normal_force;
    if (along <= most) {
        for (int i = 0; i < 3; ++i) grip.slip[i] = -friction[i] / h.tangential_stiffness;
        return;
    }
    grip.sliding = 1;
    double flat[3];
    for (int i = 0; i < 3; ++i) flat[i] = u[i] - down * pc.normal[i];
    const double aside = std::sqrt(dot(flat, flat));
    for (int i = 0; i < 3; ++i) {
        grip.slip[i] = aside > 1e-9 ? h.kinetic_friction * normal_force * flat[i] / aside / h.tangential_stiffness : 0.0;
    }
}

const held_contact* last_of(const palpate_rigid_session& s, const rigid_principal& pc, const bool used[], std::uint32_t& which) noexcept {
    for (std::uint32_t i = 0; i < s.count; ++i) {
        if (!used[i] && s.contact[i].key == pc.key) {
            which = i;
            return &s.contact[i];
        }
    }
    return nullptr;
}

// The same place and normal under another name: a principal contact that changed.
const held_contact* changed_from(const palpate_rigid_session& s, const rigid_principal& pc, const bool used[], std::uint32_t& which) noexcept {
    const held_contact* best = nullptr;
    double least = 1e18;
    for (std::uint32_t i = 0; i < s.count; ++i) {
        const held_contact& c = s.contact[i];
        double d[3];
        for (int k = 0; k < 3; ++k) d[k] = c.point[k] - pc.point[k];
        if (used[i] || dot(c.normal, pc.normal) < 0.9 || std::fabs(dot(d, pc.normal)) > 3.0 * s.scene->head.threshold) continue;
        if (dot(d, d) < least) {
            least = dot(d, d);
            best = &c;
            which = i;
        }
    }
    return best;
}

std::uint32_t case_of(const palpate_rigid& scene, const rigid_contacts& now, const double slow[], const double slips[], const double migrations[],
                      double moved, double turned_rim) noexcept {
    std::uint32_t resting = 0, rolling = 0;
    const double still = slow[0];
    for (std::uint32_t i = 0; i < now.count; ++i) {
        const std::uint32_t held = scene.element[now.at[i].key >> 16].kind, fixed = scene.element[now.at[i].key & 0xffffu].kind;
        const bool curved = held >= rigid_sphere || fixed >= rigid_sphere;
        const bool pointed = held == rigid_vertex || fixed == rigid_vertex;
        if (slips[i] <= still) ++resting;
        if (curved && !pointed && now.at[i].region != PALPATE_RIGID_PLANE && migrations[i] > still && slips[i] < 0.1 * migrations[i]) ++rolling;
    }
    if (moved <= still && turned_rim <= still) return PALPATE_RIGID_STATIC;
    if (rolling > 0 && now.count <= 2) return PALPATE_RIGID_ROLLING;
    if (resting == now.count && turned_rim <= still) return PALPATE_RIGID_STATIC;
    if (resting > 0 && now.count <= 2) return PALPATE_RIGID_TURNING;
    return resting == now.count ? PALPATE_RIGID_STATIC : PALPATE_RIGID_SLIDING;
}

void limit(const palpate_rigid_session& s, double force[3], double torque[3], const double arm[3], std::uint32_t& status) noexcept {
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
}

void tell_contact(const rigid_principal& pc, const held_contact& c, double normal_force, palpate_rigid_contact& out) noexcept {
    out.held_element = pc.key >> 16;
    out.fixed_element = pc.key & 0xffffu;
    out.region = pc.region;
    out.sliding = c.grip.sliding;
    out.gap = pc.gap;
    out.normal_force = normal_force;
    for (int i = 0; i < 3; ++i) {
        out.point[i] = pc.point[i];
        out.normal[i] = pc.normal[i];
        out.tangent[i] = pc.tangent[i];
        out.friction[i] = c.friction[i];
    }
}

// Motion type, forces and friction of the formation; fills contact_force, contact_torque and the session's contacts.
void render(palpate_rigid_session& s, const rigid_contacts& now, const rigid_place& to, const rigid_pose& pose, const double moved[3],
            const double turned[3], double dt, palpate_rigid_response& out) noexcept {
    const rigid_header& h = s.scene->head;
    held_contact next[rigid_contact_limit];
    const held_contact* from[rigid_contact_limit];
    bool used[rigid_contact_limit] = {};
    std::uint32_t kept = 0, gained = 0, changed = 0;
    for (std::uint32_t i = 0; i < now.count; ++i) {
        std::uint32_t which = 0;
        from[i] = last_of(s, now.at[i], used, which);
        if (from[i] != nullptr) {
            used[which] = true;
            ++kept;
        }
    }
    bool is_new[rigid_contact_limit] = {};
    for (std::uint32_t i = 0; i < now.count; ++i) {
        if (from[i] != nullptr) continue;
        std::uint32_t which = 0;
        from[i] = changed_from(s, now.at[i], used, which);
        if (from[i] != nullptr) {
            used[which] = true;
            ++changed;
        } else {
            is_new[i] = true;
            ++gained;
        }
    }
    if (now.count == 0) out.motion = PALPATE_RIGID_FREE;
    else if (s.count == 0) out.motion = PALPATE_RIGID_GUARDED;
    else if (changed > 0 || kept + changed < s.count) out.motion = PALPATE_RIGID_CHANGED;
    else out.motion = gained > 0 ? PALPATE_RIGID_GAINED : PALPATE_RIGID_KEPT;
    double steps[rigid_contact_limit][3], slips[rigid_contact_limit], migrations[rigid_contact_limit];
    for (std::uint32_t i = 0; i < now.count; ++i) {
        const rigid_principal& pc = now.at[i];
        material_step(s.at, to, turned, pc.point, steps[i]);
        double flat[3], went[3];
        const double through = dot(steps[i], pc.normal);
        for (int k = 0; k < 3; ++k) {
            flat[k] = steps[i][k] - through * pc.normal[k];
            went[k] = from[i] != nullptr ? pc.point[k] - from[i]->point[k] : 0.0;
        }
        slips[i] = std::sqrt(dot(flat, flat));
        migrations[i] = std::sqrt(dot(went, went));
    }
    const double slow[1] = {h.speed_static * dt};
    out.motion_case = now.count == 0 ? static_cast<std::uint32_t>(PALPATE_RIGID_NO_CASE)
                                     : case_of(*s.scene, now, slow, slips, migrations, std::sqrt(dot(moved, moved)),
                                               std::sqrt(dot(turned, turned)) * h.held_radius);
    // MT3: where the new contact sticks, the others rest.
    bool rest = false;
    double normal_force[rigid_contact_limit];
    for (std::uint32_t i = 0; i < now.count; ++i) {
        const rigid_principal& pc = now.at[i];
        const double spring = pc.gap < h.threshold ? h.stiffness * (h.threshold - pc.gap) : 0.0;
        double f = spring - h.damping * dot(steps[i], pc.normal) / dt;
        if (!(f > 0.0) || spring == 0.0) f = 0.0;
        normal_force[i] = f;
        next[i] = held_contact{};
        next[i].key = pc.key;
        next[i].damped = f - spring;
        next[i].gyration = pc.gyration;
        if (is_new[i]) {
            guarded(s, pose, pc, f, next[i].grip);
            if (out.motion == PALPATE_RIGID_GAINED && next[i].grip.sliding == 0) rest = true;
        } else {
            next[i].grip = from[i]->grip;
        }
    }
    double stored = 0.0, dissipated = 0.0, left = 0.0;
    for (std::uint32_t i = 0; i < s.count; ++i) left += s.contact[i].energy;
    for (std::uint32_t i = 0; i < now.count; ++i) {
        const rigid_principal& pc = now.at[i];
        held_contact& c = next[i];
        const double turn_about = dot(turned, pc.normal);
        rigid_friction_force f{};
        if (is_new[i]) {  // equations 1 and 2 have said how it begins
            for (int k = 0; k < 3; ++k) f.force[k] = -h.tangential_stiffness * c.grip.slip[k];
            f.energy = 0.5 * h.tangential_stiffness * dot(c.grip.slip, c.grip.slip);
        } else {
            f = rigid_rub(h, pc, normal_force[i], steps[i], turn_about, dt, !rest, c.grip);
        }
        if (from[i] != nullptr) {  // what the hand lost to the friction sent before and is not stored
            dissipated += -dot(from[i]->friction, steps[i]) - from[i]->torque * turn_about + from[i]->energy - f.energy;
            left -= from[i]->energy;
            const double damping = -from[i]->damped * dot(steps[i], pc.normal);
            if (damping > 0.0) s.account.damping += damping;
        }
        c.torque = f.torque;
        c.energy = f.energy;
        const double deep = pc.gap < h.threshold ? h.threshold - pc.gap : 0.0;
        stored += 0.5 * h.stiffness * deep * deep + f.energy;
        double total[3], arm[3], moment[3];
        for (int k = 0; k < 3; ++k) {
            c.friction[k] = f.force[k];
            c.point[k] = pc.point[k];
            c.normal[k] = pc.normal[k];
            total[k] = f.force[k] + normal_force[i] * pc.normal[k];
            arm[k] = pc.point[k] - to.position[k];
        }
        cross(arm, total, moment);
        for (int k = 0; k < 3; ++k) {
            out.contact_force[k] += total[k];
            out.contact_torque[k] += moment[k] + f.torque * pc.normal[k];
        }
        tell_contact(pc, c, normal_force[i], out.contact[i]);
    }
    dissipated += left;  // springs of contacts that broke
    if (dissipated > 0.0) s.account.friction += dissipated;
    s.stored = stored;
    s.count = now.count;
    for (std::uint32_t i = 0; i < now.count; ++i) s.contact[i] = next[i];
}

void tell(const palpate_rigid_session& s, palpate_rigid_response& out) noexcept {
    for (int i = 0; i < 3; ++i) {
        out.velocity[i] = s.velocity.linear[i];
        out.angular_velocity[i] = s.velocity.angular[i];
        out.acceleration[i] = s.velocity.acceleration[i];
        out.angular_acceleration[i] = s.velocity.angular_acceleration[i];
    }
    const books& b = s.account;
    out.stored_energy = s.stored;
    out.work_in = b.work;
    out.dissipated_friction = b.friction;
    out.dissipated_damping = b.damping;
    out.inertial = b.inertial;
    out.gravity_work = b.gravity;
    out.unaccounted = b.work - s.stored - b.friction - b.damping - b.inertial - b.gravity;
}

std::uint32_t tick(palpate_rigid_session& s, const palpate_rigid_state& state, palpate_rigid_response& out) noexcept {
    const palpate_rigid& scene = *s.scene;
    const rigid_header& h = scene.head;
    const std::uint32_t size = out.size;
    std::memset(static_cast<void*>(&out), 0, sizeof out);
    out.size = size;
    out.formation = 0xffffffffu;
    std::uint32_t status = 0;
    if (!usable(state)) {
        release(s);
        s.known = 0;
        tell(s, out);
        return out.status = PALPATE_RIGID_TICK_BAD_INPUT;
    }
    const rigid_place to = place_of(state, s.config.grip);
    const rigid_pose pose = pose_of(to);
    double moved[3] = {0.0, 0.0, 0.0}, turned[3] = {0.0, 0.0, 0.0}, step = 0.0;
    rigid_touches touches;
    if (s.known != 0) {
        for (int i = 0; i < 3; ++i) moved[i] = to.position[i] - s.at.position[i];
        turn_between(s.at.orientation, to.orientation, turned);
        step = std::sqrt(dot(moved, moved)) + h.held_radius * std::sqrt(dot(turned, turned));
        book_step(s, moved, turned);
        bool too_far;
        if (state.dt > s.config.dt_max) status |= PALPATE_RIGID_TICK_STALE;
        else if (s.config.speed_max > 0.0 && step > s.config.speed_max * state.dt) status |= PALPATE_RIGID_TICK_JUMP;
        else if (s.waiting == 0 && (passed_something(s, to, step, touches, too_far) || too_far)) status |= PALPATE_RIGID_TICK_JUMP;
    }
    if ((state.flags & PALPATE_INPUT_RELEASE) != 0) status |= PALPATE_RIGID_TICK_RELEASED;
    const bool first = s.known == 0;
    if (status != 0 || first) release(s);
    if (s.known != 0 && status == 0) track(s.velocity, moved, turned, state.dt, s.config.filter_time);
    rigid_find_touches(scene, pose, reach_of(h), 2.0 * h.depth_max, touches);
    rigid_contacts now;
    rigid_keys keys;
    keys.count = s.count;
    for (std::uint32_t i = 0; i < s.count; ++i) keys.key[i] = s.contact[i].key;
    rigid_gather(scene, touches, keys, now);
    double deepest = 0.0;
    for (std::uint32_t i = 0; i < touches.count; ++i) deepest = touches.at[i].gap < deepest ? touches.at[i].gap : deepest;
    if (s.waiting != 0) {
        if (now.count == 0 && (status & zero_wrench) == 0) s.waiting = 0;
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
    if ((status & zero_wrench) != 0) {
        release(s);
        s.at = to;
        s.known = 1;
        tell(s, out);
        return out.status = status;
    }
    render(s, now, to, pose, moved, turned, state.dt, out);
    out.contact_count = now.count;
    out.formation = rigid_formation_index(scene, now);
    if (now.count > 0 && h.formation_count > 0 && out.formation == 0xffffffffu) status |= PALPATE_RIGID_TICK_NOT_IN_TABLE;
    double force[3], torque[3];
    for (int i = 0; i < 3; ++i) {
        s.inertia_force[i] = s.inertia_torque[i] = 0.0;
        force[i] = out.contact_force[i] + h.mass * h.gravity[i];
        torque[i] = out.contact_torque[i];
    }
    if (now.count == 0 && s.config.inertia != 0 && s.velocity.known >= 2) {
        double rate[3], spin[3], gyro[3];
        inertia_times(h.inertia, pose, s.velocity.angular_acceleration, rate);
        inertia_times(h.inertia, pose, s.velocity.angular, spin);
        cross(s.velocity.angular, spin, gyro);  // Euler's equations; Luo and Xiao leave this out
        for (int i = 0; i < 3; ++i) {
            s.inertia_force[i] = -h.mass * s.velocity.acceleration[i];
            s.inertia_torque[i] = -(rate[i] + gyro[i]);
            force[i] += s.inertia_force[i];
            torque[i] += s.inertia_torque[i];
        }
    }
    double arm[3], about[3];
    for (int i = 0; i < 3; ++i) arm[i] = to.position[i] - state.position[i];
    limit(s, force, torque, arm, status);
    cross(arm, force, about);
    for (int i = 0; i < 3; ++i) {
        s.force[i] = force[i];
        s.torque[i] = torque[i];
        out.force[i] = force[i];
        out.torque[i] = torque[i] + about[i];
    }
    s.gravity_on = 1.0;
    s.at = to;
    s.known = 1;
    tell(s, out);
    return out.status = status;
}

}  // namespace
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
        if (config->size < sizeof chosen) return PALPATE_BAD_ARGUMENT;
        chosen = *config;
    }
    bool good = chosen.inertia <= 1 && chosen.speed_max >= 0.0 && chosen.speed_max <= 1e6 && chosen.dt_max > 0.0 && chosen.dt_max <= 1e6 &&
                chosen.force_max >= 0.0 && chosen.force_max <= 1e6 && chosen.torque_max >= 0.0 && chosen.torque_max <= 1e6 &&
                chosen.filter_time >= 0.0 && chosen.filter_time <= 10.0;
    for (double x : chosen.grip) good = good && std::fabs(x) <= 10.0;
    if (!good) return PALPATE_BAD_ARGUMENT;
    palpate_rigid_session* s = new (memory) palpate_rigid_session{};
    s->scene = rigid;
    s->config = chosen;
    release(*s);
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
    release(*session);
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
        rigid_find_touches(*rigid, pose_of(place_of(states[i], none)), reach_of(rigid->head), 2.0 * rigid->head.depth_max, touches);
        rigid_gather(*rigid, touches, keys, now);
        out.contact_count = now.count;
        out.formation = rigid_formation_index(*rigid, now);
        if (now.overflow != 0) out.status |= PALPATE_RIGID_TICK_OVERFLOW;
        const held_contact blank{};
        for (std::uint32_t k = 0; k < now.count; ++k) tell_contact(now.at[k], blank, 0.0, out.contact[k]);
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
        "The contact formation is not in the table of valid ones; it is rendered as found."};
    for (unsigned bit = 0; bit < sizeof text / sizeof *text; ++bit) {
        if ((status >> bit & 1u) != 0) return text[bit];
    }
    return "An ordinary tick.";
}
