/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Timing of the runtime on one field.  Whole ticks through the public functions, single ticks timed on their own with the
 * clock's own cost taken off; each trace runs five times and a tick counts with its fastest run, which takes out the
 * machine's interruptions but not the tick's own worst case.
 */
#ifndef PALPATE_BENCH_BENCH_H
#define PALPATE_BENCH_BENCH_H

#include <stddef.h>

#include "palpate/palpate.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Benches the .rfield at `path` and writes one JSON object to `json` (`size` bytes, 4096 are plenty):
 * stick_ns, slide_ns, free_ns, first_contact_ns, cold_ns, adversarial_ns (each {p50, p99, p999, max, count}), load_ms, bytes, machine.
 * cold: in contact, with 6 MB touched between ticks.  adversarial: a million ticks made to be slow.  On failure `json` holds one
 * sentence. */
PALPATE_API palpate_status palpate_bench(const char* path, char* json, size_t size);

#ifdef __cplusplus
}
#endif

#endif
