// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// How a place is touched, where that can change at the place itself: by which way (tilt), and for axial responses at which
// contact point.  Fields with one way and a potential need none of this.
#ifndef PALPATE_SRC_TOUCH_H
#define PALPATE_SRC_TOUCH_H

#include "contact.h"
#include "locate.h"
#include "rule.h"
#include "session.h"

namespace palpate {

// The amplitudes of `under` for m.q and m.cosine in its field.
void touch(palpate_session& s, const motion& m, tissue& under) PALPATE_REAL_TIME;

// `found`: the response at m.q with the way of touching and (axial) the amplitudes of the last tick, at the offset that is
// returned.  Depth and amplitudes of `under` become those of this tick.
double touch_as_before(palpate_session& s, const motion& m, const location& at, tissue& under, response& found) PALPATE_REAL_TIME;

// From there to this tick's way of touching, at one place: by the energy rule, or (unguarded) as it comes.
void change_touch(palpate_session& s, const motion& m, const tissue& under, double& offset, response& r,
                  std::uint32_t& status) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
