// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// One tick of a held object that a virtual coupling pulls after the device; the equations and the ledger are in rigid_coupling.h.
#include <cmath>

#include "rigid_session.h"

namespace palpate {
namespace {

constexpr int part_passes = 4;  // of solving for the coupling's part

double length(const double a[3]) noexcept { return std::sqrt(dot(a, a)); }

rigid_coupling coupling_of(const palpate_rigid_config& c) noexcept {
    return {c.coupling_stiffness, c.coupling_damping, c.coupling_torsional_stiffness, c.coupling_torsional_damping};
}

// J that the hand has put in, or been given, and that nothing but the coupling may hold.
double ledger_of(const palpate_rigid_session& s) noexcept {
    const rigid_books& b = s.account;
    return s.coupled.given + b.work - s.stored - s.coupled.moving - b.friction - b.damping - b.inertial - b.gravity;
}

struct tie {  // from the object's grip to the device's
    double stretch[3], turn[3], arm[3], device_arm[3];
};

tie tie_between(const rigid_place& at, const rigid_place& device, const double grip[3]) noexcept {
    tie t;
    rotate(at.orientation, grip, t.arm);
    rotate(device.orientation, grip, t.device_arm);
    for (int i = 0; i < 3; ++i) t.stretch[i] = device.position[i] + t.device_arm[i] - at.position[i] - t.arm[i];
    turn_between(at.orientation, device.orientation, t.turn);
    return t;
}

void inertia_of(const rigid_header& h, const rigid_pose& pose, rigid_matrix& m) noexcept {
    m = rigid_matrix{};
    for (int i = 0; i < 3; ++i) {
        const double axis[3] = {i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
        double column[3];
        inertia_times(h.inertia, pose, axis, column);
        m.at[i][i] = h.mass;
        for (int k = 0; k < 3; ++k) m.at[3 + k][3 + i] = column[k];
    }
}

double kinetic(const rigid_header& h, const rigid_pose& pose, const double speed[6]) noexcept {
    double spin[3];
    inertia_times(h.inertia, pose, speed + 3, spin);
    return 0.5 * (h.mass * dot(speed, speed) + dot(spin, speed + 3));
}

struct hand_step {
    double moved[3], turned[3];  // of the device since the last tick
    double surprise;             // m; how much the next step may differ
};

// How much of this wrench may be sent, 0 to 1: what the hand can take with it out of `left` J, and the device's limits.
double allowed(const palpate_rigid_session& s, const rigid_step& step, const tie& t, double left, const hand_step& hand) noexcept {
    const double force = length(step.force), torque = length(step.torque);
    double about[3];
    cross(t.device_arm, step.force, about);
    for (int i = 0; i < 3; ++i) about[i] += step.torque[i];
    const double turning = length(about) / s.scene->head.held_radius, size = force > turning ? force : turning;
    const double taken = dot(step.force, hand.moved) + dot(about, hand.turned) + size * hand.surprise;
    double keep = 1.0;
    if (taken > rigid_ledger_share * left) keep = left > 0.0 ? rigid_ledger_share * left / taken : 0.0;
    if (s.config.force_max > 0.0 && keep * force > s.config.force_max) keep = s.config.force_max / force;
    if (s.config.torque_max > 0.0 && keep * torque > s.config.torque_max) keep = s.config.torque_max / torque;
    return keep;
}

// Steps the object; `part`: how much of the coupling it took.
rigid_place follow(const palpate_rigid_session& s, const tie& t, const hand_step& hand, double left, double dt, rigid_step& step,
                   double& part) noexcept {
    const rigid_header& h = s.scene->head;
    const rigid_pose pose = pose_of(s.at);
    rigid_drive q;
    q.mass = h.mass;
    q.radius = h.held_radius;
    double spin[3];
    inertia_times(h.inertia, pose, s.coupled.speed + 3, spin);
    cross(s.coupled.speed + 3, spin, q.gyro);
    for (int i = 0; i < 3; ++i) {
        q.weight[i] = h.mass * h.gravity[i];
        q.arm[i] = t.arm[i];
        q.stretch[i] = t.stretch[i];
        q.turn[i] = t.turn[i];
    }
    double swung[3];  // grip of the device, to first order
    cross(hand.turned, t.device_arm, swung);
    for (int i = 0; i < 3; ++i) {
        q.hand[i] = (hand.moved[i] + swung[i]) / dt;
        q.hand[3 + i] = hand.turned[i] / dt;
    }
    for (int i = 0; i < 6; ++i) {
        q.wrench[i] = s.coupled.wrench[i];
        q.speed[i] = s.coupled.speed[i];
    }
    inertia_of(h, pose, q.inertia);
    q.stiffness = s.coupled.stiffness;
    q.damping = s.coupled.damping;
    const rigid_coupling coupling = coupling_of(s.config);
    part = 1.0;
    for (int pass = 0; pass < part_passes; ++pass) {
        rigid_advance(q, coupling, part, dt, step);
        const double keep = allowed(s, step, t, left, hand);
        if (keep >= 1.0) break;
        part *= keep;
    }
    rigid_place to;
    double half[4] = {0.5 * dt * step.speed[3], 0.5 * dt * step.speed[4], 0.5 * dt * step.speed[5], 1.0};
    const double scale = 1.0 / std::sqrt(1.0 + dot(half, half));
    for (double& x : half) x *= scale;
    multiply(half, s.at.orientation, to.orientation);
    double square = 0.0;
    for (double x : to.orientation) square += x * x;
    for (double& x : to.orientation) x /= std::sqrt(square);
    for (int i = 0; i < 3; ++i) to.position[i] = s.at.position[i] + dt * step.speed[i];
    return to;
}

// Stiffness and damping of the contacts for the next step: bounds from above, so that it stays stable.
void linearise(palpate_rigid_session& s, const rigid_contacts& now, const palpate_rigid_response& out) noexcept {
    const rigid_header& h = s.scene->head;
    rigid_matrix &k = s.coupled.stiffness, &d = s.coupled.damping;
    k = d = rigid_matrix{};
    for (std::uint32_t i = 0; i < now.count; ++i) {
        const rigid_principal& pc = now.at[i];
        const rigid_held_contact& c = s.contact[i];
        double arm[3], speed[3];
        for (int a = 0; a < 3; ++a) arm[a] = pc.point[a] - s.at.position[a];
        if (!(pc.gap < h.threshold)) continue;
        if (pc.region == PALPATE_RIGID_POINT || pc.hull_count == 0) rigid_add_point(k, pc.normal, arm, h.stiffness);
        for (std::uint32_t j = 0; j < pc.hull_count && pc.region != PALPATE_RIGID_POINT; ++j) {
            double corner[3];
            for (int a = 0; a < 3; ++a) corner[a] = arm[a] + pc.hull[j][0] * pc.across[a] + pc.hull[j][1] * pc.tangent[a];
            rigid_add_point(k, pc.normal, corner, h.stiffness / pc.hull_count);
        }
        if (out.contact[i].normal_force > 0.0) rigid_add_point(d, pc.normal, arm, h.damping);
        cross(s.coupled.speed + 3, arm, speed);
        for (int a = 0; a < 3; ++a) speed[a] += s.coupled.speed[a];
        const double through = dot(speed, pc.normal), spin = dot(s.coupled.speed + 3, pc.normal);
        for (int a = 0; a < 3; ++a) speed[a] -= through * pc.normal[a];
        const double fast = length(speed) + c.gyration * std::fabs(spin);
        const double drag = length(c.friction) / (fast > h.speed_static ? fast : h.speed_static);  // N s/m, of kinetic friction
        const bool slides = c.grip.sliding != 0;
        rigid_add_point(slides ? d : k, pc.across, arm, slides ? drag : h.tangential_stiffness);
        rigid_add_point(slides ? d : k, pc.tangent, arm, slides ? drag : h.tangential_stiffness);
        const double twist = c.gyration * c.gyration * (slides ? drag : h.tangential_stiffness);
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) (slides ? d : k).at[3 + a][3 + b] += twist * pc.normal[a] * pc.normal[b];
        }
    }
    for (int a = 0; a < 3; ++a) {
        s.coupled.wrench[a] = out.contact_force[a];
        s.coupled.wrench[3 + a] = out.contact_torque[a];
    }
}

// Brings the object from its place to `to` with `speed`: contacts, accounts, energies.  Status bits.
std::uint32_t arrive(palpate_rigid_session& s, const rigid_place& to, const double speed[6], double dt, palpate_rigid_response& out) noexcept {
    const rigid_header& h = s.scene->head;
    const rigid_pose pose = pose_of(to);
    double moved[3], turned[3];
    for (int i = 0; i < 3; ++i) {
        moved[i] = to.position[i] - s.at.position[i];
        out.contact_force[i] = out.contact_torque[i] = 0.0;
    }
    turn_between(s.at.orientation, to.orientation, turned);
    const double step = length(moved) + h.held_radius * length(turned);
    rigid_touches touches;
    if (rigid_passed_something(s, to, step, touches)) return PALPATE_RIGID_TICK_JUMP;
    track(s.velocity, moved, turned, dt, s.config.filter_time);
    rigid_contacts now;
    const std::uint32_t status = rigid_meet(s, pose, step, 0, touches, now);
    if ((status & rigid_zero_wrench) != 0) return status;
    rigid_render(s, now, to, pose, moved, turned, dt, out);
    for (std::uint32_t i = now.count; i < PALPATE_RIGID_CONTACT_LIMIT; ++i) out.contact[i] = palpate_rigid_contact{};
    s.account.gravity -= h.mass * dot(h.gravity, moved);
    s.at = to;
    for (int i = 0; i < 6; ++i) s.coupled.speed[i] = speed[i];
    s.coupled.moving = kinetic(h, pose, speed);
    linearise(s, now, out);
    return status;
}

// Nothing is felt until the device is in free space; the object waits with it.
std::uint32_t let_go(palpate_rigid_session& s, const rigid_place& device, std::uint32_t status, palpate_rigid_response& out) noexcept {
    rigid_release(s);
    s.device = s.at = device;
    s.known = 1;
    rigid_tell(s, out);
    return out.status = status;
}

}  // namespace

std::uint32_t rigid_coupled_tick(palpate_rigid_session& s, const palpate_rigid_state& state, const rigid_place& device,
                                 const double moved[3], const double turned[3], std::uint32_t status,
                                 palpate_rigid_response& out) noexcept {
    const rigid_header& h = s.scene->head;
    const double dt = state.dt;
    if (status != 0 || s.known == 0) rigid_release(s);
    if (s.waiting != 0) {
        rigid_touches touches;
        rigid_contacts now;
        status = rigid_meet(s, pose_of(device), 0.0, status, touches, now);
        const std::uint32_t waits = s.waiting;
        let_go(s, device, status, out);
        s.waiting = waits;
        return status;
    }
    const rigid_coupling coupling = coupling_of(s.config);
    hand_step hand;
    for (int i = 0; i < 3; ++i) {
        hand.moved[i] = moved[i];
        hand.turned[i] = turned[i];
    }
    hand.surprise = s.config.acceleration_max * dt * dt;
    const double reserve = rigid_reserve(coupling, h.held_radius, hand.surprise);
    if (!(s.coupled.given > 0.0)) s.coupled.given = reserve;
    double left = ledger_of(s);
    if (left < 0.0) {  // the hand took more than it was given
        s.coupled.given += reserve - left;
        return let_go(s, device, PALPATE_RIGID_TICK_JUMP, out);
    }
    const double short_of = rigid_ledger_floor * reserve - left;
    if (short_of > 0.0 && s.coupled.given + short_of <= (1.0 + rigid_loan) * reserve) s.coupled.given += short_of;
    const palpate_rigid_session before = s;
    const tie t = tie_between(s.at, device, s.config.grip);
    rigid_step step;
    double part;
    const rigid_place to = follow(s, t, hand, ledger_of(s), dt, step, part);
    status = arrive(s, to, step.speed, dt, out);
    if ((status & rigid_zero_wrench) != 0) return let_go(s, device, status, out);
    if (ledger_of(s) < 0.0) {  // more than the hand has put in: the object stays where it was, at rest
        s = before;
        const double rest[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
        const rigid_place there = s.at;
        status = arrive(s, there, rest, dt, out) | PALPATE_RIGID_TICK_ENERGY_LIMITED;
        if ((status & rigid_zero_wrench) != 0) return let_go(s, device, status, out);
    }
    if (h.formation_count > 0 && out.contact_count > 0 && out.formation == 0xffffffffu) status |= PALPATE_RIGID_TICK_NOT_IN_TABLE;
    const tie after = tie_between(s.at, device, s.config.grip);
    left = ledger_of(s);
    const double full = rigid_spring_energy(coupling, after.stretch, after.turn);
    s.coupled.spring = part * full < left ? part * full : (left > 0.0 ? left : 0.0);
    double over = left - s.coupled.spring - reserve;
    if (over > 0.0) {
        left -= over;
        const double lent = s.coupled.given - reserve, back = lent > 0.0 ? (lent < over ? lent : over) : 0.0;
        s.coupled.given -= back;
        s.account.damping += over - back;
    }
    const double keep = allowed(s, step, after, left, hand);
    double force[3], torque[3], about[3];
    for (int i = 0; i < 3; ++i) {
        force[i] = keep * step.force[i];
        torque[i] = keep * step.torque[i];
    }
    cross(after.device_arm, force, about);
    for (int i = 0; i < 3; ++i) {
        out.force[i] = s.force[i] = force[i];
        out.torque[i] = torque[i];
        s.torque[i] = torque[i] + about[i];
    }
    if (part * keep < 1.0) {
        const bool device_full = (s.config.force_max > 0.0 && length(force) > 0.999 * s.config.force_max) ||
                                 (s.config.torque_max > 0.0 && length(torque) > 0.999 * s.config.torque_max);
        status |= device_full ? PALPATE_RIGID_TICK_FORCE_LIMITED : PALPATE_RIGID_TICK_ENERGY_LIMITED;
    }
    s.device = device;
    s.known = 1;
    rigid_tell(s, out);
    return out.status = status;
}

}  // namespace palpate
