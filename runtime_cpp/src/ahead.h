// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What the tool is about to need is fetched into the caches, so that the tick that enters a cell need not wait for memory: the slowest
// ticks were those.  No answer depends on it.  In contact the tool is taken to go on as it went in this tick.  It looks every few
// ticks, not in those that enter a cell, so a fast tool enters some cells unasked; a wrong guess costs its lines and no more.
#ifndef PALPATE_SRC_AHEAD_H
#define PALPATE_SRC_AHEAD_H

#include "contact.h"
#include "session.h"

namespace palpate {

constexpr std::uint32_t ticks_a_look = 4;  // each tick would be 3 % more instructions
constexpr double ticks_ahead = 8.0;        // more is too far for a fast tool, less is too late for what comes from memory

// Near the surface: where the tool would be a little deep if it went straight down.
inline void look_below(palpate_session& s, double x, double y, double z, const location& at) noexcept {
    s.under_distance.entered = false;
    const double spacing = s.field->geometry.spacing;
    if (at.region != PALPATE_REGION_FREE || at.depth < -spacing || !plain(s)) return;
    const double down = at.depth - 0.25 * spacing;
    s.field->contract->fetch_cells(*s.field, x + down * at.gradient[0], y + down * at.gradient[1], z + down * at.gradient[2],
                                   s.fetched);
}

inline void look_ahead(palpate_session& s, const motion& m, const location& at) noexcept {
    bool& entered = s.under_distance.entered;
    if (m.in_cell && s.touching) {  // where it slides
        if (++s.ticks_since_look < ticks_a_look) return;
        if (entered | s.under_amplitudes.entered) {  // perhaps in this tick, which then has done enough
            entered = s.under_amplitudes.entered = false;
            return;
        }
        s.ticks_since_look = 0;
        s.field->contract->fetch_cells(*s.field, m.q[0] + ticks_ahead * m.step[0], m.q[1] + ticks_ahead * m.step[1],
                                       m.q[2] + ticks_ahead * m.step[2], s.fetched);
    } else if (entered) {
        look_below(s, m.q[0], m.q[1], m.q[2], at);
    }
}

}  // namespace palpate

#endif
