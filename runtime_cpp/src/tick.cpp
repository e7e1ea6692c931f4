// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// One tick: locate, respond, friction, guard.  Stored energy E = U(q) + 1/2 k |s|^2; the hand moved the tool by dq under
// the force that was sent, f = -grad U - k s, and did w = -f . dq.  In this order:
//   1. at fixed k and anchor, E goes to U(q') + 1/2 k |s + P dq|^2: w plus the zero-order hold's share (the leak);
//   2. the way of touching changes: rule.h; the normal turns, the stiffness changes, the spring yields: friction.h shows that none
//      raises E;
//   3. the surface yields to the device's limit, to a covered leak, to a changed field: contact.cpp; none raises E;
//   4. contact that cannot go on (too deep, through, jumped, bad input) gives up E as a whole: dissipated.
// First contact sets the spring down unstretched; lift-off has U = k = 0, so E ends at zero by itself.
#include <cmath>
#include <cstddef>
#include <cstring>

#include "ahead.h"
#include "contact.h"
#include "locate.h"
#include "respond.h"
#include "session.h"
#include "vec.h"
#include "ways.h"

namespace palpate {
namespace {

// Doubles in a row, from one member up to another.
#define PALPATE_ROW(from, to) static_cast<int>((offsetof(palpate_tool_response, to) - offsetof(palpate_tool_response, from)) / sizeof(double))
static_assert(PALPATE_ROW(force, reference_point) == 6 && PALPATE_ROW(normal, stiffness) == 5 && PALPATE_ROW(stiffness, work_in) == 6 &&
                  PALPATE_ROW(work_in, way_cosine) * sizeof(double) == sizeof(accounts),
              "rows that nothing interrupts");
#define PALPATE_IN_PLACE(m) (offsetof(accounts, m) == PALPATE_ROW(work_in, m) * sizeof(double))
static_assert(PALPATE_IN_PLACE(work_in) && PALPATE_IN_PLACE(dissipated_friction) && PALPATE_IN_PLACE(dissipated_rule) &&
                  PALPATE_IN_PLACE(hold_leak) && PALPATE_IN_PLACE(organ_work) && PALPATE_IN_PLACE(injected),
              "the accounts in their order");

// The response part of *out for a session that sends no force.  The depth, which is among it, is written later.
// In short rows: gcc clears these in pairs, 88 bytes by a string instruction.
PALPATE_INLINE void write_free(double x, double y, double z, palpate_tool_response& out) noexcept {
    auto* const bytes = reinterpret_cast<unsigned char*>(&out);
    std::memset(bytes + offsetof(palpate_tool_response, force), 0, PALPATE_ROW(force, reference_point) * sizeof(double));
    std::memset(bytes + offsetof(palpate_tool_response, normal), 0, PALPATE_ROW(normal, stiffness) * sizeof(double));
    std::memset(bytes + offsetof(palpate_tool_response, stiffness), 0, PALPATE_ROW(stiffness, work_in) * sizeof(double));
    out.reference_point[0] = out.anchor[0] = x;
    out.reference_point[1] = out.anchor[1] = y;
    out.reference_point[2] = out.anchor[2] = z;
}

void write_books(const palpate_session& s, palpate_tool_response& out) noexcept {
    out.work_in = s.books.work_in;
    out.dissipated_friction = s.books.dissipated_friction;
    out.dissipated_rule = s.books.dissipated_rule;
    out.hold_leak = s.books.hold_leak;
    out.organ_work = s.books.organ_work;
    out.injected = s.books.injected;
    out.way_cosine = s.cosine;
}

// The way of touching at m.q, from `before` (the last tick's cosine); the location's depth becomes that of the larger rho of the two.
void tilt(const palpate_field& field, double before, motion& m, location& at) noexcept {
    m.cosine = field.header.way_cosine[0];
    m.shift_before = m.shift = 0.0;
    if (field.way_count == 1) return;
    const double c0 = m.cosine = clamped_cosine(field, before);
    const double length = std::sqrt(dot(at.gradient, at.gradient));
    if (length > 0.0) m.cosine = clamped_cosine(field, dot(m.axis, at.gradient) / length);
    const double rho_before = offset_of_way(field, c0), rho = offset_of_way(field, m.cosine);
    const double larger = rho_before > rho ? rho_before : rho;
    m.shift_before = larger - rho_before;
    m.shift = larger - rho;
    if (at.region != PALPATE_REGION_CONTACT && at.region != PALPATE_REGION_FREE) return;
    at.depth -= field.tool_offset - larger;
    at.region = at.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
}

// A stroke longer than the geometry's spacing: what lies between its ends?  Returns the bits that end contact; may
// itself account for the whole step, leaving no work to account for.
std::uint32_t check_stroke(palpate_session& s, motion& m, const location& at) noexcept {
    stroke seen;
    look_along(*s.field, s.q, m.q, s.touching ? s.spring.normal : nullptr, seen);
    if (seen.too_long) return PALPATE_TICK_JUMP;
    const bool ends_in_contact = at.region == PALPATE_REGION_CONTACT;
    const bool ends_turned = ends_in_contact && dot(seen.normal, at.gradient) < 0.0;
    const bool went_through = !s.touching && seen.touched && (seen.left || !ends_in_contact);
    if (seen.deep || seen.turned || ends_turned || went_through) return PALPATE_TICK_PASSED_THROUGH;
    if (seen.unreached) {
        if (s.touching) give_up(s, m.work);
        m.work = 0.0;
        s.entry = gate::zero_energy;
    } else if (s.touching && seen.left && ends_in_contact) {  // off and on again: the new contact starts unstretched
        lift_off(s, m.work, m.step);
        m.work = 0.0;
    }
    return 0;
}

// The field changes at m.q, where `at` becomes what the new one says; true when contact goes on.
bool change_field(palpate_session& s, motion& m, location& at, std::uint32_t& status, palpate_tool_response& out) noexcept {
    forget_cells(s);
    begin_texture(s.texture, *s.next_field);
    locate(*s.next_field, m.q[0], m.q[1], m.q[2], s.under_distance, at);
    tilt(*s.next_field, 1.0, m, at);
    if (at.region == PALPATE_REGION_CONTACT || at.region == PALPATE_REGION_FREE) {  // only the new way counts
        at.depth -= m.shift;
        m.shift = 0.0;
        at.region = at.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
    }
    s.cosine = m.cosine;
    const bool touching = s.touching && change_field_in_contact(s, m, at, status, out);
    s.field = s.next_field;
    s.next_field = nullptr;
    status &= ~static_cast<std::uint32_t>(PALPATE_TICK_UNREACHED | PALPATE_TICK_TOO_DEEP);
    if (at.region == PALPATE_REGION_UNREACHED) status |= PALPATE_TICK_UNREACHED;
    if (at.region == PALPATE_REGION_DEEP) status |= PALPATE_TICK_TOO_DEEP;
    if (!touching) {  // from outside of the new tissue only
        const bool outside = at.region == PALPATE_REGION_FREE || at.region == PALPATE_REGION_OUTSIDE;
        s.entry = outside ? gate::open : gate::closed;
        if (at.region == PALPATE_REGION_CONTACT && status == 0) status |= PALPATE_TICK_WAITING;
    }
    return touching;
}

// Any tick.  `known`: where the reference point is in s.field, for a usable input; null where nobody has looked.
PALPATE_APART std::uint32_t any_tick(palpate_session& s, const palpate_tool_state& state, const location* known,
                                     palpate_tool_response& out) PALPATE_REAL_TIME {
    std::uint32_t status = known == nullptr ? input_fault(state) : 0;
    if (status != 0) {
        give_up(s, 0.0);  // where the hand went is not known, so neither is its work
        s.entry = gate::closed;
        s.has_q = false;
        write_free(s.q[0], s.q[1], s.q[2], out);
        write_books(s, out);
        out.depth = 0.0;
        out.region = PALPATE_REGION_UNKNOWN;
        out.status = status;
        return status;
    }

    motion m;
    double q[3];  // its numbers go on without waiting for memory
    reference_point(state, s.config.reference_point, q);
    m.in_cell = s.touching && plain(s);
    if (m.in_cell) go_to(*s.field, q[0], q[1], q[2], s.under_amplitudes);
    location at;
    if (known == nullptr) {
        locate(*s.field, q[0], q[1], q[2], s.under_distance, at);
    } else {
        at.region = known->region;
        at.depth = known->depth;
        for (int a = 0; a < 3; ++a) at.gradient[a] = known->gradient[a];
    }
    for (int a = 0; a < 3; ++a) {
        m.q[a] = q[a];
        m.step[a] = s.has_q ? q[a] - s.q[a] : 0.0;
        m.arm[a] = q[a] - state.position[a];
    }
    m.work = -dot(s.force, m.step);
    m.dt = state.dt;
    const double length_squared = dot(m.step, m.step);
    const double reach = s.config.speed_max * state.dt;
    if (s.config.speed_max > 0.0 && length_squared > reach * reach) status |= PALPATE_TICK_JUMP;
    if (state.dt > s.config.dt_max) status |= PALPATE_TICK_STALE;
    if ((state.flags & PALPATE_INPUT_RELEASE) != 0) status |= PALPATE_TICK_RELEASED;

    m.cosine = s.cosine;
    m.shift_before = m.shift = 0.0;
    if (s.field->way_count > 1 || s.next_field != nullptr) {
        turn_with_tool(state, s.config.tool_axis, m.axis);
        tilt(*s.field, s.cosine, m, at);
    }
    const double spacing = s.field->geometry.spacing;
    if (status == 0 && s.entry == gate::open && length_squared > spacing * spacing) {
        status |= check_stroke(s, m, at);
    }
    if (at.region == PALPATE_REGION_DEEP) status |= PALPATE_TICK_TOO_DEEP;
    if (status != 0) {
        give_up(s, m.work);
        m.work = 0.0;
        s.entry = gate::closed;
    }

    bool touching = false;
    switch (at.region) {
        case PALPATE_REGION_CONTACT:
            touching = contact(s, m, at, status, out);
            if (!touching && s.touching) give_up(s, m.work);
            break;
        case PALPATE_REGION_UNREACHED:
            status |= PALPATE_TICK_UNREACHED;
            if (s.touching) give_up(s, m.work);
            if (s.entry == gate::open) s.entry = gate::zero_energy;
            break;
        case PALPATE_REGION_DEEP:
            break;  // given up above
        default:
            if (s.touching) lift_off(s, m.work, m.step);
            s.entry = gate::open;
            break;
    }

    for (int a = 0; a < 3; ++a) s.q[a] = m.q[a];
    s.has_q = true;
    s.cosine = m.cosine;
    if (s.next_field != nullptr) touching = change_field(s, m, at, status, out);
    if (!touching) write_free(s.q[0], s.q[1], s.q[2], out);
    write_books(s, out);
    out.depth = at.depth - m.shift;
    out.region = at.region;
    out.status = status;
    look_ahead(s, m, at);
    return status;
}

// Most ticks in free space: the tool was free and is, the field has one way of touching, and nobody asks for anything.  Then there is no
// force, no work and no energy, and this leaves out what the long way would find to be zero; the answer has the same bits.
// The distance comes first, whatever the input (a point that is none lies in no box): what is asked meanwhile costs no time.
PALPATE_APART std::uint32_t free_tick(palpate_session& s, const palpate_tool_state& state, palpate_tool_response& out) PALPATE_REAL_TIME {
    const palpate_field& field = *s.field;
    double x = state.position[0], y = state.position[1], z = state.position[2];  // not an array, which would wait for memory
    if (!PALPATE_EXPECTED(!s.has_arm)) {
        double q[3];
        reference_point(state, s.config.reference_point, q);
        x = q[0], y = q[1], z = q[2];
    }
    location at;
    if (!PALPATE_EXPECTED(field.contract->distance(field, x, y, z, s.under_distance, &at.depth))) {
        if (input_fault(state) != 0) return any_tick(s, state, nullptr, out);
        locate_unknown(field, x, y, z, at);
        return any_tick(s, state, &at, out);
    }
    const double step[3] = {x - s.q[0], y - s.q[1], z - s.q[2]};
    const double length_squared = dot(step, step), reach = s.config.speed_max * state.dt, spacing = field.geometry.spacing;
    const bool jump = s.config.speed_max > 0.0 && length_squared > reach * reach;
    at.region = at.depth > 0.0 ? PALPATE_REGION_CONTACT : PALPATE_REGION_FREE;
    if (!PALPATE_EXPECTED(input_fault(state) == 0)) return any_tick(s, state, nullptr, out);
    if (!PALPATE_EXPECTED(at.region == PALPATE_REGION_FREE && s.has_q && s.next_field == nullptr && field.way_count == 1 && !jump &&
                          state.dt <= s.config.dt_max && (state.flags & PALPATE_INPUT_RELEASE) == 0 &&
                          length_squared <= spacing * spacing)) {
        return any_tick(s, state, &at, out);
    }
    s.entry = gate::open;
    s.q[0] = x, s.q[1] = y, s.q[2] = z;
    write_free(x, y, z, out);
    // The accounts were written long ago, or pairs would wait for them.
    std::memcpy(reinterpret_cast<unsigned char*>(&out) + offsetof(palpate_tool_response, work_in), &s.books, sizeof s.books);
    out.way_cosine = s.cosine;
    out.depth = at.depth;
    out.region = PALPATE_REGION_FREE;
    out.status = 0;
    if (s.under_distance.entered) look_below(s, x, y, z, at);
    return 0;
}

}  // namespace

void begin(palpate_session& s) PALPATE_REAL_TIME {
    let_go(s);
    s.books = accounts{};
    s.transients = transient_state{};
    begin_texture(s.texture, *s.field);
    s.entry = gate::closed;
    s.has_q = false;
    for (double& x : s.q) x = 0.0;
    s.cosine = clamped_cosine(*s.field, 1.0);
    const palpate_organ* source = s.organ.source;
    s.organ = carriage{};
    s.organ.source = source;
    s.organ.used = source != nullptr;
    forget_cells(s);
}

std::uint32_t tick(palpate_session& s, const palpate_tool_state& state, palpate_tool_response& out) PALPATE_REAL_TIME {
    return s.touching ? any_tick(s, state, nullptr, out) : free_tick(s, state, out);
}

}  // namespace palpate
