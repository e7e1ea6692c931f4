// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Every allocation of the test program, counted by tick_test.cpp where PALPATE_COUNT_ALLOCATIONS is defined.
#ifndef PALPATE_TESTS_COUNTED_ALLOCATIONS_H
#define PALPATE_TESTS_COUNTED_ALLOCATIONS_H

#include <atomic>

extern std::atomic<long> allocations;

#endif
