// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Opened rigid objects: pointers into proved bytes.
#ifndef PALPATE_SRC_LAYERS_RIGID_SCENE_H
#define PALPATE_SRC_LAYERS_RIGID_SCENE_H

#include "palpate/rigid.h"
#include "rigid_layout.h"

struct palpate_rigid {
    palpate::rigid_header head;
    const palpate::rigid_element* element;
    const palpate::rigid_pair* pair;
    const double* number;
    const std::uint32_t* index;
    const palpate::rigid_merge* merge;
    const palpate::rigid_formation* formation;
    const std::uint32_t* formation_index;
};

#endif
