// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "rule.h"

namespace palpate {
namespace {

constexpr int search_limit = 40;  // evaluations of curves; 2^-40 of a depth is below rounding
constexpr double tolerance = 1e-12;  // of the energy

}  // namespace

double offset_for(const tissue& under, double energy, double guess, response& found) PALPATE_REAL_TIME {
    respond_at(under, 0.0, found);
    if (found.energy <= energy) return 0.0;
    // U falls with the offset: too strong at 0, nothing at the depth.  The end that is kept is always the weak one.
    double strong = 0.0, weak = under.depth;
    double strong_excess = found.energy - energy, weak_excess = -energy;
    double tried = guess;
    int side = 0;
    respond_at(under, weak, found);
    if (!(energy > 0.0)) return weak;
    for (int i = 0; i < search_limit; ++i) {
        // The Illinois rule; the last steps halve, so that the end is bounded whatever the curve.
        if (i > 0) tried = strong + (i < search_limit / 2 ? strong_excess / (strong_excess - weak_excess) : 0.5) * (weak - strong);
        if (!(tried > strong && tried < weak)) tried = 0.5 * (strong + weak);
        response r;
        respond_at(under, tried, r);
        const double excess = r.energy - energy;
        if (excess > 0.0) {
            strong = tried;
            strong_excess = excess;
            if (side == 1) weak_excess *= 0.5;
            side = 1;
        } else {
            weak = tried;
            weak_excess = excess;
            found = r;
            if (excess >= -tolerance * energy) break;
            if (side == -1) strong_excess *= 0.5;
            side = -1;
        }
    }
    return weak;
}

}  // namespace palpate
