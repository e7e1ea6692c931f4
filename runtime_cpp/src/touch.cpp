// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Axial is the published scheme's idea on this field's curves: the force at a contact point is interpolated and acts along
// the normal, so the potential's amplitudes are frozen while the tool moves and follow it afterwards.  That change is where
// the published scheme creates energy (press soft, drag to stiff, lift), and where the rule can be put in its way.
#include "touch.h"

#include <cmath>

#include "ways.h"

namespace palpate {
namespace {

// The frozen amplitudes have no gradient.
void freeze(palpate_session& s, amplitude_sums& sums) noexcept {
    for (int i = 0; i < static_cast<int>(rfield_channel_limit); ++i) {
        s.amplitude[i] = sums.value[i];
        sums.dx[i] = sums.dy[i] = sums.dz[i] = 0.0;
    }
}

}  // namespace

void touch(palpate_session& s, const motion& m, tissue& under) PALPATE_REAL_TIME {
    amplitudes_here here;
    amplitudes_at(*under.field, m.q, here);
    blend(*under.field, here, m.cosine, under.amplitudes);
    if (s.config.response != PALPATE_RESPONSE_POTENTIAL) freeze(s, under.amplitudes);
}

double touch_as_before(palpate_session& s, const motion& m, const location& at, tissue& under, response& found) PALPATE_REAL_TIME {
    const palpate_field& field = *s.field;
    tissue before{};
    before.field = &field;
    before.distance_gradient = at.gradient;
    before.texture = under.texture;
    before.depth = std::fmax(0.0, at.depth - m.shift_before);
    under.depth = std::fmax(0.0, at.depth - m.shift);
    if (s.config.response == PALPATE_RESPONSE_POTENTIAL) {
        amplitudes_here here;
        amplitudes_at(field, m.q, here);
        blend(field, here, m.cosine, under.amplitudes);
        blend(field, here, clamped_cosine(field, s.cosine), before.amplitudes);
    } else {
        for (int i = 0; i < static_cast<int>(rfield_channel_limit); ++i) before.amplitudes.value[i] = s.amplitude[i];
        touch(s, m, under);
        if (!s.touching) before.amplitudes = under.amplitudes;
    }
    const double offset = s.offset < before.depth ? s.offset : before.depth;
    respond_at(before, offset, found);
    return offset;
}

void change_touch(palpate_session& s, const motion& m, const tissue& under, double& offset, response& r,
                  std::uint32_t& status) PALPATE_REAL_TIME {
    if (s.config.response == PALPATE_RESPONSE_POTENTIAL && m.cosine == clamped_cosine(*s.field, s.cosine)) {
        if (offset > 0.0) status |= PALPATE_TICK_RULE_YIELDED;  // nothing changed: the offset is the smallest one already
        return;
    }
    response changed;
    if (s.config.response == PALPATE_RESPONSE_AXIAL_UNGUARDED) {
        if (offset > under.depth) offset = under.depth;
        respond_at(under, offset, changed);
        s.books.injected += changed.energy - r.energy;
    } else {
        offset = offset_for(under, r.energy, offset, changed);
        if (offset > 0.0) status |= PALPATE_TICK_RULE_YIELDED;
        s.books.dissipated_rule += r.energy - changed.energy;
    }
    r = changed;
}

}  // namespace palpate
