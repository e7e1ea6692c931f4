// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// From elementary contacts to principal contacts: those of the highest surface elements whose closures hold them (Xiao and Ji 2001).
#ifndef PALPATE_SRC_LAYERS_RIGID_FORMATION_H
#define PALPATE_SRC_LAYERS_RIGID_FORMATION_H

#include "rigid_distance.h"

namespace palpate {

constexpr std::uint32_t rigid_contact_limit = PALPATE_RIGID_CONTACT_LIMIT, rigid_hull_limit = 16;

// m; (1 + hysteresis) eps
inline double rigid_reach(const rigid_header& h) noexcept { return h.threshold * (1.0 + h.hysteresis); }

struct rigid_principal {
    std::uint32_t key;     // held << 16 | fixed
    std::uint32_t region;  // palpate_rigid_region
    double gap;            // m; smallest of the region
    double point[3];       // m; where evenly stiff, linearly varying pressure (eps - gap) acts as one force
    double normal[3], tangent[3], across[3];  // task frame y, x, z
    std::uint32_t hull_count;
    double hull[rigid_hull_limit][2];  // m, along tangent and across, from point; counter-clockwise; of a line its two ends
    double gyration;       // m; mean distance of the region's pressure from point: friction torque = mu N gyration
};

struct rigid_contacts {
    std::uint32_t count, overflow;
    rigid_principal at[rigid_contact_limit];
};

struct rigid_keys {
    std::uint32_t count;
    std::uint32_t key[rigid_contact_limit];
};

// Principal contacts among `touches` (all up to rigid_reach), whose gap is up to eps; `last`: those of the tick before, kept up to
// rigid_reach.  With a table of valid formations: where these are none of it and those up to rigid_reach are one, it is the latter.
void rigid_gather(const palpate_rigid& scene, const rigid_touches& touches, const rigid_keys& last, rigid_contacts& found) PALPATE_REAL_TIME;

// Place of the formation in the table of valid ones; 0xffffffff: not there, or no table.
std::uint32_t rigid_formation_index(const palpate_rigid& scene, const rigid_contacts& contacts) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
