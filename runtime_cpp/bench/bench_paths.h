// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Traces that a hand could make on any field, found by sampling it.
#ifndef PALPATE_BENCH_BENCH_PATHS_H
#define PALPATE_BENCH_BENCH_PATHS_H

#include <array>
#include <cstdint>
#include <vector>

#include "palpate/palpate.h"

namespace palpate_bench_paths {

using point = std::array<double, 3>;

struct tick {
    point q;      // m
    bool timed;   // false: only there to bring the session into the state wanted
};

struct contact {
    point q;       // m; at 40 % of depth_max
    point normal;  // unit
};

// Places in contact, spread over the reach; fewer than `count` where the field is small, none where nothing is found.
std::vector<contact> contacts(const palpate_field* field, std::size_t count, std::uint64_t seed);

// In from outside, then micrometre moves: the friction spring holds.
std::vector<tick> sticking(const std::vector<contact>& at);
// In from outside, then 0.1 mm a tick along the surface at constant depth.
std::vector<tick> sliding(const palpate_field* field, const std::vector<contact>& at);
// Within 2 mm of contact, never touching.
std::vector<tick> hovering(const palpate_field* field, const std::vector<contact>& at);
// Just outside, just inside (timed), again and again.
std::vector<tick> tapping(const palpate_field* field, const std::vector<contact>& at);

// Every tick meant to be slow: on and beside cell borders, at first contact and the band's edges, with strokes between places,
// moves along a stroke as long as speed_max allows, and jumps of 1 m.
std::vector<tick> adversarial(const palpate_field* field, const std::vector<contact>& at, std::size_t count);

}  // namespace palpate_bench_paths

#endif
