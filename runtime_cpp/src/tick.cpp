// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// One tick: locate, respond, friction, guard.  Stored energy E = U(q) + 1/2 k |s|^2; the hand moved the tool by dq under
// the force that was sent, f = -grad U - k s, and did w = -f . dq.  In this order:
//   1. at fixed k and anchor, E goes to U(q') + 1/2 k |s + P dq|^2: w plus the zero-order hold's share (the leak);
//   2. the normal turns, the stiffness changes, the spring yields: friction.h shows that none raises E;
//   3. contact that cannot go on (too deep, through, jumped, bad input) gives up E as a whole: dissipated.
// First contact sets the spring down unstretched; lift-off has U = k = 0, so E ends at zero by itself.
#include <cmath>

#include "locate.h"
#include "respond.h"
#include "session.h"
#include "vec.h"

namespace palpate {
namespace {

// |grad phi| below which a normal means nothing (a medial plane); the spring then keeps its old one.
constexpr double gradient_least = 1e-3;

constexpr std::uint32_t zero_force_bits = PALPATE_TICK_UNREACHED | PALPATE_TICK_TOO_DEEP | PALPATE_TICK_PASSED_THROUGH |
                                          PALPATE_TICK_JUMP | PALPATE_TICK_STALE | PALPATE_TICK_BAD_INPUT |
                                          PALPATE_TICK_RELEASED;

bool unit(const double v[3], double n[3]) noexcept {
    const double length = std::sqrt(dot(v, v));
    if (!(length > gradient_least)) return false;
    const double scale = 1.0 / length;
    for (int a = 0; a < 3; ++a) n[a] = v[a] * scale;
    return true;
}

// Nothing is stored and nothing is sent any more.
void let_go(palpate_session& s) noexcept {
    s.touching = false;
    s.energy = 0.0;
    s.spring = friction_spring{};
    for (double& f : s.force) f = 0.0;
}

void give_up(palpate_session& s, double work) noexcept {
    release(s.books, work, s.energy + spring_energy(s.spring));
    let_go(s);
}

void lift_off(palpate_session& s, double work, const double step[3]) noexcept {
    const double before = s.energy + spring_energy(s.spring);
    carry(s.spring, step);
    const double spring = spring_energy(s.spring);
    hold(s.books, work, before, spring);
    s.books.dissipated_friction += spring;
    let_go(s);
}

// The response part of *out for a session that sends no force.
void write_free(const palpate_session& s, palpate_tool_response& out) noexcept {
    for (int a = 0; a < 3; ++a) {
        out.force[a] = out.torque[a] = out.normal[a] = 0.0;
        out.reference_point[a] = out.anchor[a] = s.q[a];
    }
    out.normal_force = out.stiffness = out.friction_stiffness = out.friction_coefficient = 0.0;
    out.stored_energy = out.spring_energy = 0.0;
}

void write_books(const palpate_session& s, palpate_tool_response& out) noexcept {
    out.work_in = s.books.work_in;
    out.dissipated_friction = s.books.dissipated_friction;
    out.dissipated_rule = s.books.dissipated_rule;
    out.hold_leak = s.books.hold_leak;
}

// Contact at q, `arm` from the grip, coming from s.q by `step`; false (with a status bit) where it cannot be.  What needs the normal alone
// is done before the response, so that the processor can do both at once.
bool contact(palpate_session& s, const double q[3], const double arm[3], const location& at, const double step[3],
             double work, std::uint32_t& status, palpate_tool_response& out) noexcept {
    friction_spring spring = s.spring;
    double n[3] = {spring.normal[0], spring.normal[1], spring.normal[2]};
    const bool has_normal = unit(at.gradient, n);
    const bool turned_over = s.touching ? dot(n, spring.normal) < 0.0 : !has_normal;
    if (s.touching) {
        carry(spring, step);
    } else {
        touch_down(spring, n);
    }
    const double held = spring_energy(spring);
    if (has_normal && !turned_over) turn(spring, n);

    response r;
    respond(*s.field, q, at.depth, at.gradient, r);
    if (s.entry == gate::zero_energy && r.energy == 0.0) s.entry = gate::open;
    if (s.entry != gate::open) {
        if ((status & zero_force_bits) == 0) status |= PALPATE_TICK_WAITING;
        return false;
    }
    if (turned_over) {  // within one tick, or begun without any normal: the middle of a thin lobe
        status |= PALPATE_TICK_PASSED_THROUGH;
        s.entry = gate::closed;
        return false;
    }
    hold(s.books, work, s.energy + spring_energy(s.spring), r.energy + held);

    const double normal_force = -dot(r.gradient, n);
    const double mu = s.config.friction_coefficient >= 0.0 ? s.config.friction_coefficient : r.friction_coefficient;
    stiffen(spring, r.friction_stiffness);
    if (yield(spring, normal_force > 0.0 ? mu * normal_force : 0.0)) status |= PALPATE_TICK_SLIPPING;
    const double stretched = spring_energy(spring);
    s.books.dissipated_friction += held - stretched;
    if (at.depth > s.field->depth_max) status |= PALPATE_TICK_EXTRAPOLATED;

    s.touching = true;
    s.energy = r.energy;
    s.spring = spring;
    double f[3];
    for (int a = 0; a < 3; ++a) f[a] = -r.gradient[a] - spring.stiffness * spring.stretch[a];
    for (int a = 0; a < 3; ++a) {
        s.force[a] = f[a];
        out.force[a] = f[a];
        out.reference_point[a] = q[a];
        out.anchor[a] = q[a] - spring.stretch[a];
        out.normal[a] = n[a];
    }
    out.torque[0] = arm[1] * f[2] - arm[2] * f[1];
    out.torque[1] = arm[2] * f[0] - arm[0] * f[2];
    out.torque[2] = arm[0] * f[1] - arm[1] * f[0];
    out.normal_force = normal_force;
    out.stiffness = r.stiffness;
    out.friction_stiffness = spring.stiffness;
    out.friction_coefficient = mu;
    out.stored_energy = r.energy + stretched;
    out.spring_energy = stretched;
    return true;
}

// A stroke longer than the geometry's spacing: what lies between its ends?  Returns the bits that end contact; may
// itself account for the whole step, leaving no work to account for.
std::uint32_t check_stroke(palpate_session& s, const double q[3], const location& at, const double step[3],
                           double& work) noexcept {
    stroke seen;
    look_along(*s.field, s.q, q, s.touching ? s.spring.normal : nullptr, seen);
    if (seen.too_long) return PALPATE_TICK_JUMP;
    const bool ends_in_contact = at.region == PALPATE_REGION_CONTACT;
    const bool ends_turned = ends_in_contact && dot(seen.normal, at.gradient) < 0.0;
    const bool went_through = !s.touching && seen.touched && (seen.left || !ends_in_contact);
    if (seen.deep || seen.turned || ends_turned || went_through) return PALPATE_TICK_PASSED_THROUGH;
    if (seen.unreached) {
        if (s.touching) give_up(s, work);
        work = 0.0;
        s.entry = gate::zero_energy;
    } else if (s.touching && seen.left && ends_in_contact) {  // off and on again: the new contact starts unstretched
        lift_off(s, work, step);
        work = 0.0;
    }
    return 0;
}

}  // namespace

void begin(palpate_session& s) noexcept {
    let_go(s);
    s.books = accounts{};
    s.entry = gate::closed;
    s.has_q = false;
    for (double& x : s.q) x = 0.0;
}

std::uint32_t tick(palpate_session& s, const palpate_tool_state& state, palpate_tool_response& out) noexcept {
    std::uint32_t status = input_fault(state);
    if (status != 0) {
        give_up(s, 0.0);  // where the hand went is not known, so neither is its work
        s.entry = gate::closed;
        s.has_q = false;
        write_free(s, out);
        write_books(s, out);
        out.depth = 0.0;
        out.region = PALPATE_REGION_UNKNOWN;
        out.status = status;
        return status;
    }

    double q[3];
    reference_point(state, s.config.reference_point, q);
    double step[3] = {0.0, 0.0, 0.0};
    if (s.has_q) {
        for (int a = 0; a < 3; ++a) step[a] = q[a] - s.q[a];
    }
    double work = -dot(s.force, step);
    const double length_squared = dot(step, step);
    const double reach = s.config.speed_max * state.dt;
    if (s.config.speed_max > 0.0 && length_squared > reach * reach) status |= PALPATE_TICK_JUMP;
    if (state.dt > s.config.dt_max) status |= PALPATE_TICK_STALE;
    if ((state.flags & PALPATE_INPUT_RELEASE) != 0) status |= PALPATE_TICK_RELEASED;

    location at;
    locate(*s.field, q, at);
    const double spacing = s.field->geometry.spacing;
    if (status == 0 && s.entry == gate::open && length_squared > spacing * spacing) {
        status |= check_stroke(s, q, at, step, work);
    }
    if (at.region == PALPATE_REGION_DEEP) status |= PALPATE_TICK_TOO_DEEP;
    if (status != 0) {
        give_up(s, work);
        work = 0.0;
        s.entry = gate::closed;
    }

    const double arm[3] = {q[0] - state.position[0], q[1] - state.position[1], q[2] - state.position[2]};
    bool touching = false;
    switch (at.region) {
        case PALPATE_REGION_CONTACT:
            touching = contact(s, q, arm, at, step, work, status, out);
            if (!touching && s.touching) give_up(s, work);
            break;
        case PALPATE_REGION_UNREACHED:
            status |= PALPATE_TICK_UNREACHED;
            if (s.touching) give_up(s, work);
            if (s.entry == gate::open) s.entry = gate::zero_energy;
            break;
        case PALPATE_REGION_DEEP:
            break;  // given up above
        default:
            if (s.touching) lift_off(s, work, step);
            s.entry = gate::open;
            break;
    }

    for (int a = 0; a < 3; ++a) s.q[a] = q[a];
    s.has_q = true;
    if (!touching) write_free(s, out);
    write_books(s, out);
    out.depth = at.depth;
    out.region = at.region;
    out.status = status;
    return status;
}

}  // namespace palpate
