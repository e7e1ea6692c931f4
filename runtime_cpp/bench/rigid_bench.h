/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PALPATE_BENCH_RIGID_BENCH_H
#define PALPATE_BENCH_RIGID_BENCH_H

#include "palpate/rigid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Times `count` ticks of a recorded motion one by one, five times over; each counts with its fastest run.  Per tick, in ns, the clock's
 * own cost taken off: identify_ns[i], finding the contact formation alone where the tick put the object; tick_ns[i], the whole tick.
 * config: null: the default one. */
PALPATE_API palpate_status palpate_bench_rigid(const palpate_rigid* rigid, const palpate_rigid_config* config,
                                               const palpate_rigid_state* states, size_t count, double* identify_ns, double* tick_ns);

#ifdef __cplusplus
}
#endif

#endif
