// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// What a session remembers between ticks.  Trivially copyable: a copy of the bytes is a snapshot.
#ifndef PALPATE_SRC_SESSION_H
#define PALPATE_SRC_SESSION_H

#include <cstdint>

#include "cell.h"
#include "friction.h"
#include "guard.h"
#include "layers/texture.h"
#include "layers/transient.h"
#include "organ.h"
#include "palpate/palpate.h"
#include "rfield_layout.h"

namespace palpate {

// When contact may begin.
enum class gate : std::uint32_t {
    open,         // the tool came from free space
    zero_energy,  // it came from where nothing was pressed: only where U = 0, so that no energy appears
    closed,       // it was released, or just made: only after it has been free
};

}  // namespace palpate

// The public name palpate_session.
struct palpate_session {
    const palpate_field* field;
    const palpate_field* next_field;  // to change to in the next tick, or null
    palpate_config config;

    double q[3];      // m; last usable reference point
    double force[3];  // N; sent at the last tick
    double energy;    // J; U at the last tick, without the spring
    double offset;    // m; how far the surface has yielded
    palpate::friction_spring spring;
    palpate::accounts books;
    palpate::gate entry;
    bool has_q;       // q is valid
    bool touching;
    bool has_arm;     // config.reference_point is not 0

    double cosine;                                  // of tool axis and normal, within the field's ways; see ways.h
    double amplitude[palpate::rfield_channel_limit];  // that axial's stored energy is made of
    palpate::carriage organ;

    palpate::distance_cell under_distance;      // of `field`; where the last tick was
    palpate::amplitude_cell under_amplitudes;  // of `field`
    palpate::fetched_cells fetched;            // of `field`
    std::uint32_t ticks_since_look;            // in contact; ahead.h

    palpate::transient_state transients;
    palpate::texture_state texture;
    palpate::mask_cell under_masks;  // of `field`; where the last tick in contact was
};

namespace palpate {

// No cell of a lattice is kept any more: the next one may be another field's.
inline void forget_cells(palpate_session& session) noexcept {
    forget(session.under_distance);
    forget(session.under_amplitudes);
    forget(session.under_masks);
    forget(session.fetched.distance);
    forget(session.fetched.amplitudes);
}

// State of a fresh session; keeps field and config.
void begin(palpate_session& session) PALPATE_REAL_TIME;

// One tick with arguments known to be good, in the organ's axes.
std::uint32_t tick(palpate_session& session, const palpate_tool_state& state, palpate_tool_response& out) PALPATE_REAL_TIME;

// The same in world axes, on an organ that has a pose or may get one.
std::uint32_t tick_on_organ(palpate_session& session, const palpate_tool_state& state, palpate_tool_response& out) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
