// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#ifndef PALPATE_SRC_CONTACT_H
#define PALPATE_SRC_CONTACT_H

#include "locate.h"
#include "session.h"

namespace palpate {

// What a tick knows when it comes to contact.
struct motion {
    double q[3];     // m; where the reference point is now
    double step[3];  // m; from the last tick's; 0 when that is not known
    double arm[3];   // m; from the grip to q
    double work;     // J; by the hand, - f . step
    double axis[3];  // the tool's; read by fields with several ways of touching
    double cosine;   // of axis and normal: the way of touching at q
    // The location's depth is that of the larger rho of the way that was and the way that is; these are what each lacks, m.
    double shift_before, shift;
    double dt;       // s
    bool in_cell;    // the session's amplitude cell is that of q
};

// One way of touching, and forces from the potential: one cell of amplitudes is all that contact reads.
inline bool plain(const palpate_session& s) PALPATE_REAL_TIME {
    return s.field->way_count == 1 && s.config.response == PALPATE_RESPONSE_POTENTIAL;
}

// Contact at m.q; fills `out`.  False (with a status bit) where it cannot be: the caller ends it.
bool contact(palpate_session& s, const motion& m, const location& at, std::uint32_t& status, palpate_tool_response& out) PALPATE_REAL_TIME;

// Contact goes on in s.next_field at s.q; fills `out`.  False (everything given up) where that field has no contact.
bool change_field_in_contact(palpate_session& s, const motion& m, const location& at, std::uint32_t& status,
                             palpate_tool_response& out) PALPATE_REAL_TIME;

// The ends of contact.  Nothing is stored and nothing is sent any more; the accounts are not touched.
void let_go(palpate_session& s) PALPATE_REAL_TIME;
// All that is left is dissipated.
void give_up(palpate_session& s, double work) PALPATE_REAL_TIME;
// The tool came free by itself: U is 0, the spring's rest is dissipated.
void lift_off(palpate_session& s, double work, const double step[3]) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
