// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// A moving organ.  The tick works in the organ's axes: with x_world = R x + t the tool's place there is x = R^T (x_world - t),
// and forces go back through R.  Seen from the organ the hand's relative work is -f . dx; in the world it is
// -(R f) . dx_world.  The difference is what whoever moves the organ did, and has an account of its own:
//     organ_work = (R f) . dx_world - f . dx,
// which for short ticks is (R f) . v dt, v being the velocity of the organ's matter at the tool.
//
// Poses come from another thread through a ring of slots with a stamp each: the writer never waits, and a reader that it
// laps (eight poses during one copy) goes on without news until its next tick.
#ifndef PALPATE_SRC_ORGAN_H
#define PALPATE_SRC_ORGAN_H

#include <atomic>
#include <cstdint>

#include "palpate/palpate.h"

namespace palpate {

// Organ axes to world axes.
struct rigid {
    double position[3];     // m
    double orientation[4];  // x y z w, unit
};

struct published_pose {
    rigid pose;
    double duration;  // s
};

// What a session remembers of the organ that it is on.  Trivially copyable.
struct carriage {
    const palpate_organ* source;  // whom to ask for poses, or null
    bool used;                    // false: no pose was ever given or asked for, axes are the world's
    bool started;                 // `tool` and `force` are kept up
    bool posed;                   // `now` is a pose
    bool has_tool;                // `tool` is valid
    std::uint64_t seen;           // number of the last publication
    rigid from, to, now;
    double elapsed, duration;     // s, on the way from `from` to `to`
    double tool[3];               // m, world; the reference point at the last usable tick
    double force[3];              // N, world; sent at the last tick
};

}  // namespace palpate

// The public name palpate_organ.
struct palpate_organ {
    static constexpr std::uint64_t slot_count = 8;
    static constexpr std::uint64_t word_count = sizeof(palpate::published_pose) / 8;
    struct slot {
        std::atomic<std::uint64_t> stamp;  // number of the publication in it; 0 while it is written
        std::atomic<std::uint64_t> words[word_count];
    };
    std::atomic<std::uint64_t> latest;  // number of the last whole publication; 0: none
    slot slots[slot_count];
};

#endif
