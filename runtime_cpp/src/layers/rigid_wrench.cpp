// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The wrench of a contact formation: prior motion (MT1 to MT4, cases a to d of MT2), normal forces, friction, their energies.
#include <cmath>

#include "rigid_session.h"

namespace palpate {
namespace {

// Step of the held object's material at x (m) between two places.
void material_step(const rigid_place& before, const rigid_place& now, const double turned[3], const double x[3], double step[3]) noexcept {
    const double arm[3] = {x[0] - now.position[0], x[1] - now.position[1], x[2] - now.position[2]};
    cross(turned, arm, step);  // to first order in the tick's turn
    for (int i = 0; i < 3; ++i) step[i] += now.position[i] - before.position[i];
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

const rigid_held_contact* last_of(const palpate_rigid_session& s, const rigid_principal& pc, const bool used[], std::uint32_t& which) noexcept {
    for (std::uint32_t i = 0; i < s.count; ++i) {
        if (!used[i] && s.contact[i].key == pc.key) {
            which = i;
            return &s.contact[i];
        }
    }
    return nullptr;
}

// The same place and normal under another name: a principal contact that changed.
const rigid_held_contact* changed_from(const palpate_rigid_session& s, const rigid_principal& pc, const bool used[], std::uint32_t& which) noexcept {
    const rigid_held_contact* best = nullptr;
    double least = 1e18;
    for (std::uint32_t i = 0; i < s.count; ++i) {
        const rigid_held_contact& c = s.contact[i];
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
}  // namespace

void rigid_tell_contact(const rigid_principal& pc, const rigid_held_contact& c, double normal_force, palpate_rigid_contact& out) noexcept {
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

void rigid_render(palpate_rigid_session& s, const rigid_contacts& now, const rigid_place& to, const rigid_pose& pose, const double moved[3],
            const double turned[3], double dt, palpate_rigid_response& out) noexcept {
    const rigid_header& h = s.scene->head;
    rigid_held_contact next[rigid_contact_limit];
    const rigid_held_contact* from[rigid_contact_limit];
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
        next[i] = rigid_held_contact{};
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
        rigid_held_contact& c = next[i];
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
        rigid_tell_contact(pc, c, normal_force[i], out.contact[i]);
    }
    dissipated += left;  // springs of contacts that broke
    if (dissipated > 0.0) s.account.friction += dissipated;
    s.stored = stored;
    s.count = now.count;
    for (std::uint32_t i = 0; i < now.count; ++i) s.contact[i] = next[i];
    out.contact_count = now.count;
    out.formation = rigid_formation_index(*s.scene, now);
}

}  // namespace palpate
