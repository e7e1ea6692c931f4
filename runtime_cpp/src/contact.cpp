// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Contact: what the field answers, what friction and the limits make of it, and where the energy goes.  The tissue is felt
// at the depth d - o; the offset o >= 0 is how far the surface has yielded, and every change of it lowers U:
//   force_max    o grows until |f| <= force_max.  Clipping the force instead would keep the energy and give it back later.
//   passivity    o grows by excess / (dU/dd) when the hold has given more than has been dissipated since.  U is convex in d
//                where tissue stiffens, so that this never takes more than the excess; the rest follows in the next ticks.
//   rule.h       o is as large as a changed field, way of touching or (axial) contact point needs.
// The surface comes back with the tool: o <= d, where U = 0 anyway.
#include "contact.h"

#include <cmath>

#include "respond.h"
#include "rule.h"
#include "touch.h"
#include "vec.h"

namespace palpate {
namespace {

// |grad phi| below which a normal means nothing (a medial plane); the spring then keeps its old one.
constexpr double gradient_least = 1e-3;

// Steps of a search for an offset; 2^-40 of a depth is below rounding.
constexpr int search_limit = 40;
constexpr double force_tolerance = 1e-6;  // of force_max; the search ends below the limit by at most this

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

// What friction makes of a response.
struct outcome {
    friction_spring spring;
    double force[3];  // N
    double normal_force;
    double friction_coefficient;
    bool slipped;
};

PALPATE_INLINE void settle(const palpate_config& config, const tissue& under, const response& r, const double step[3],
                           double length_squared, outcome& o) noexcept {
    o.normal_force = -dot(r.gradient, under.normal);
    o.friction_coefficient = config.friction_coefficient >= 0.0 ? config.friction_coefficient : r.friction_coefficient;
    const double limit = o.normal_force > 0.0 ? o.friction_coefficient * o.normal_force : 0.0;
    o.slipped = settle(o.spring, length_squared, r.friction_stiffness, limit);
    if (config.adhesion != PALPATE_ADHESION_STICK_SLIP) creep(o.spring, config.adhesion, config.adhesion_start, limit, step);
    for (int a = 0; a < 3; ++a) o.force[a] = -r.gradient[a] - o.spring.stiffness * o.spring.stretch[a];
}

// Yields until |f| <= force_max: between the offset that is there (too strong) and the depth (no force at all).  Illinois
// rule on |f| - force_max; the end that is kept is always on the weak side.
PALPATE_APART void limit_force(const palpate_config& config, const tissue& under, const double step[3], const friction_spring& before,
                               double length_squared, double& offset, response& r, outcome& o) noexcept {
    const auto excess = [&config](const double f[3]) { return std::sqrt(dot(f, f)) - config.force_max; };
    double strong = offset, weak = under.depth;
    double strong_excess = excess(o.force), weak_excess = -config.force_max;
    bool found = false;
    int side = 0;
    for (int i = 0; i < search_limit; ++i) {
        // The last steps halve, so that the end is bounded whatever the curve.
        const double share = i < search_limit / 2 ? strong_excess / (strong_excess - weak_excess) : 0.5;
        const double tried = strong + share * (weak - strong);
        response rt;
        respond_at(under, tried, rt);
        outcome ot;
        ot.spring = before;
        settle(config, under, rt, step, length_squared, ot);
        const double e = excess(ot.force);
        if (e > 0.0) {
            strong = tried;
            strong_excess = e;
            if (side == 1) weak_excess *= 0.5;
            side = 1;
        } else {
            weak = tried;
            weak_excess = e;
            r = rt;
            o = ot;
            found = true;
            if (e >= -force_tolerance * config.force_max) break;
            if (side == -1) strong_excess *= 0.5;
            side = -1;
        }
    }
    offset = weak;
    if (!found) {
        offset = under.depth;
        respond_at(under, offset, r);
        o.spring = before;
        settle(config, under, r, step, length_squared, o);
    }
}

// What the turn of a texture's gains changed.
struct gain_turn {
    double gain[4];        // of the group, before
    double height_change;  // m; at m.q
    bool changed;
};

// The texture at m.q after the gains of one group had their turn.
PALPATE_INLINE void turn_gains(palpate_session& s, const motion& m, texture_here& texture, gain_turn& turn) noexcept {
    const texture_ground& ground = s.field->texture;
    double now[4];
    for (std::uint32_t i = 0; i < 4; ++i) turn.gain[i] = s.texture.gain[4 * s.texture.turn + i];
    s.texture.walked += std::sqrt(dot(m.step, m.step));
    turn.changed = s.field->contract->texture_in_turn(ground, s.texture, m.q, m.step, longest_step(s.texture, m.dt), s.under_masks, now,
                                                      &turn.height_change);
    set_here(ground, now, texture);
}

// U there with the old gains.
PALPATE_APART double energy_before(const tissue& under, double offset, const gain_turn& turn) noexcept {
    texture_here before = *under.texture;
    before.height -= turn.height_change;
    return energy_again(*under.field, under.amplitudes, felt_depth(before, under.depth - offset, under.distance_gradient).depth);
}

// What the turn lowered U by, from `before`, is dissipated; where it would have raised it (U falls with depth), it is taken back.
PALPATE_APART void account_for_turn(palpate_session& s, const motion& m, const tissue& under, double offset, const gain_turn& turn,
                                    double before, texture_here& texture, response& r) noexcept {
    if (r.energy <= before) {
        s.books.dissipated_rule += before - r.energy;
        return;
    }
    take_back_turn(s.texture, *s.field, turn.gain);
    texture_at(*s.field, s.texture.amplitude, m.q, s.under_masks, texture);
    respond_at(under, offset, r);
}

// Settles, limits and tells.  On entry `spring` has been carried and turned, and E = r.energy + held is what the accounts say is stored;
// its |s|^2 is `length_squared`.
PALPATE_INLINE void feel(palpate_session& s, const motion& m, const tissue& under, response& r, const friction_spring& spring,
                         double length_squared, double held, double offset, std::uint32_t& status, palpate_tool_response& out) noexcept {
    outcome o;
    copy(spring, o.spring);
    settle(s.config, under, r, m.step, length_squared, o);
    if (s.config.force_max > 0.0 && dot(o.force, o.force) > s.config.force_max * s.config.force_max) {
        const double felt = r.energy;
        friction_spring before;  // copies, so that the ordinary way needs no addresses
        copy(spring, before);
        outcome limited;
        for (int a = 0; a < 3; ++a) limited.force[a] = o.force[a];
        double yielded = offset;
        limit_force(s.config, under, m.step, before, length_squared, yielded, r, limited);
        copy(limited.spring, o.spring);
        for (int a = 0; a < 3; ++a) o.force[a] = limited.force[a];
        o.normal_force = limited.normal_force;
        o.friction_coefficient = limited.friction_coefficient;
        o.slipped = limited.slipped;
        offset = yielded;
        status |= PALPATE_TICK_FORCE_LIMITED;
        s.books.dissipated_rule += felt - r.energy;
    }
    const double stretched = spring_energy(o.spring);
    s.books.dissipated_friction += held - stretched;
    if (o.slipped) status |= PALPATE_TICK_SLIPPING;
    if (under.depth - offset > under.field->depth_max) status |= PALPATE_TICK_EXTRAPOLATED;

    s.touching = true;
    s.energy = r.energy;
    s.offset = offset;
    copy(o.spring, s.spring);
    const double* f = o.force;
    for (int a = 0; a < 3; ++a) {
        s.force[a] = f[a];
        out.force[a] = f[a];
        out.reference_point[a] = m.q[a];
        out.anchor[a] = m.q[a] - o.spring.stretch[a];
        out.normal[a] = under.normal[a];
    }
    out.torque[0] = m.arm[1] * f[2] - m.arm[2] * f[1];
    out.torque[1] = m.arm[2] * f[0] - m.arm[0] * f[2];
    out.torque[2] = m.arm[0] * f[1] - m.arm[1] * f[0];
    out.normal_force = o.normal_force;
    out.stiffness = r.stiffness;
    out.friction_stiffness = o.spring.stiffness;
    out.friction_coefficient = o.friction_coefficient;
    out.stored_energy = r.energy + stretched;
    out.spring_energy = stretched;
    out.surface_offset = offset;
}

}  // namespace

void let_go(palpate_session& s) PALPATE_REAL_TIME {
    s.touching = false;
    s.energy = 0.0;
    s.offset = 0.0;
    s.spring = friction_spring{};
    for (double& f : s.force) f = 0.0;
}

void give_up(palpate_session& s, double work) PALPATE_REAL_TIME {
    release(s.books, work, s.energy + spring_energy(s.spring));
    let_go(s);
}

void lift_off(palpate_session& s, double work, const double step[3]) PALPATE_REAL_TIME {
    const double before = s.energy + spring_energy(s.spring);
    carry(s.spring, step);
    const double spring = spring_energy(s.spring);
    hold(s.books, work, before, spring);
    s.books.dissipated_friction += spring;
    let_go(s);
}

// What needs the normal alone is done before the response, so that the processor can do both at once.
bool contact(palpate_session& s, const motion& m, const location& at, std::uint32_t& status, palpate_tool_response& out) PALPATE_REAL_TIME {
    const bool one_cell = plain(s);
    tissue under;
    under.field = s.field;
    under.distance_gradient = at.gradient;
    under.texture = nullptr;
    friction_spring spring;
    copy(s.spring, spring);
    for (int a = 0; a < 3; ++a) under.normal[a] = spring.normal[a];
    const bool has_normal = unit(at.gradient, under.normal);
    const bool turned_over = s.touching ? dot(under.normal, spring.normal) < 0.0 : !has_normal;
    if (s.touching) {
        carry(spring, m.step);
    } else {
        touch_down(spring, under.normal);
    }
    const double length_squared = dot(spring.stretch, spring.stretch);
    const double held = 0.5 * spring.stiffness * length_squared;
    if (has_normal && !turned_over) turn(spring, under.normal);

    response r;  // at the new place, as it was touched
    double offset;
    texture_here texture;
    const bool textured = !PALPATE_EXPECTED(s.field->texture.group_count == 0);
    gain_turn turn;
    bool turns = false;
    if (textured) {
        turns = s.touching && gains_move(s.texture, s.field->texture, dot(m.step, m.step), m.dt);
        if (turns && one_cell) {
            turn_gains(s, m, texture, turn);
        } else {
            if (!s.touching) touch_texture(s.texture, *s.field, m.step, m.dt);
            texture_at(*s.field, s.texture.amplitude, m.q, s.under_masks, texture);
        }
        under.texture = &texture;
    }
    if (one_cell) {
        under.depth = at.depth;
        offset = s.offset < at.depth ? s.offset : at.depth;
        if (!m.in_cell) go_to(*s.field, m.q[0], m.q[1], m.q[2], s.under_amplitudes);
        if (textured) {
            const felt_depth felt(texture, at.depth - offset, at.gradient);
            respond(*s.field, m.q, felt.depth, felt.gradient, s.under_amplitudes, r, under.amplitudes);
            along_depth(felt, r);
        } else {
            respond(*s.field, m.q, at.depth - offset, at.gradient, s.under_amplitudes, r, under.amplitudes);
        }
    } else {
        offset = touch_as_before(s, m, at, under, r);
    }
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
    double touched = r.energy;  // with the gains that were
    if (textured && turns && one_cell && turn.changed) touched = energy_before(under, offset, turn);
    hold(s.books, m.work, s.energy + spring_energy(s.spring), touched + held);
    if (!one_cell) change_touch(s, m, under, offset, r, status);
    if (textured) {
        if (turns && !one_cell) {
            touched = r.energy;
            turn_gains(s, m, texture, turn);
            if (turn.changed) respond_at(under, offset, r);
        }
        if (turns && turn.changed) account_for_turn(s, m, under, offset, turn, touched, texture, r);
        if (s.texture.limited != 0) status |= PALPATE_TICK_TEXTURE_LIMITED;
    }

    if (s.config.passivity_control != 0) {
        const double excess = s.books.hold_leak - s.books.dissipated_friction - s.books.dissipated_rule;
        if (excess > 0.0 && r.steepness > 0.0) {
            const double room = under.depth - offset;
            const double more = excess / r.steepness;
            const double tried = offset + (more < room ? more : room);
            response weaker;
            respond_at(under, tried, weaker);
            if (weaker.energy < r.energy) {
                s.books.dissipated_rule += r.energy - weaker.energy;
                r = weaker;
                offset = tried;
                status |= PALPATE_TICK_LEAK_COVERED;
            }
        }
    }
    feel(s, m, under, r, spring, length_squared, held, offset, status, out);
    return true;
}

bool change_field_in_contact(palpate_session& s, const motion& m, const location& at, std::uint32_t& status,
                             palpate_tool_response& out) PALPATE_REAL_TIME {
    tissue under;
    under.field = s.next_field;
    under.distance_gradient = at.gradient;
    under.depth = at.depth;
    under.texture = nullptr;
    texture_here texture;
    if (s.next_field->texture.group_count > 0) {
        mask_cell of_next;
        forget(of_next);
        texture_at(*s.next_field, s.texture.amplitude, m.q, of_next, texture);
        under.texture = &texture;
    }
    friction_spring spring = s.spring;
    for (int a = 0; a < 3; ++a) under.normal[a] = spring.normal[a];
    const bool has_normal = unit(at.gradient, under.normal);
    if (at.region != PALPATE_REGION_CONTACT || dot(under.normal, spring.normal) < 0.0) {
        give_up(s, 0.0);
        return false;
    }
    if (has_normal) turn(spring, under.normal);
    touch(s, m, under);
    response r;
    const double offset = offset_for(under, s.energy, 0.0, r);
    s.books.dissipated_rule += s.energy - r.energy;
    const double length_squared = dot(spring.stretch, spring.stretch);
    feel(s, m, under, r, spring, length_squared, 0.5 * spring.stiffness * length_squared, offset, status, out);
    return true;
}

}  // namespace palpate
