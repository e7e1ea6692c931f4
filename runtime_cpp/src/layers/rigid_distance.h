// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Where two surface elements are closest: gap, normal and point, for the pairs that together find every contact of a formation.
#ifndef PALPATE_SRC_LAYERS_RIGID_DISTANCE_H
#define PALPATE_SRC_LAYERS_RIGID_DISTANCE_H

#include "rigid_scene.h"

namespace palpate {

// An object's frame in the world: x = R x_object + position; rows of R.
struct rigid_pose {
    double rotation[3][3];
    double position[3];
};

struct rigid_touch {
    std::uint32_t held, fixed;
    double point[3];   // on the held object's surface, m
    double normal[3];  // unit, out of the fixed object
    double gap;        // m
};

constexpr std::uint32_t rigid_touch_limit = 64;

struct rigid_touches {
    std::uint32_t count, overflow;
    rigid_touch at[rigid_touch_limit];
};

// All elementary contacts with -deepest <= gap <= reach of the held object at `pose`.
void rigid_find_touches(const palpate_rigid& scene, const rigid_pose& pose, double reach, double deepest, rigid_touches& found) PALPATE_REAL_TIME;

}  // namespace palpate

#endif
