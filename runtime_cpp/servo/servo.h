/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * A session in a servo thread of its own (servo_thread.hpp), for demonstrations and live views in languages that cannot
 * keep a kilohertz themselves.  Whoever leads the tool says a few times a second where it is to be; the thread goes
 * there steadily, tick by tick, and publishes what it feels.  Neither waits for the other.
 *
 * Between targets position goes linearly and orientation by normalised interpolation, over the duration that came with
 * the target.  Not a device: nothing pushes the tool back.
 */
#ifndef PALPATE_SERVO_SERVO_H
#define PALPATE_SERVO_SERVO_H

#include "palpate/palpate.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palpate_servo palpate_servo;

/* What the thread has done, as of its latest tick. */
typedef struct palpate_servo_state {
    uint32_t size;
    uint32_t real_time;          /* 1: the thread runs at a real-time priority; 0: the system did not allow it */
    uint64_t ticks;              /* count, since the start */
    uint64_t missed;             /* ticks that did not happen, each because a call was a whole period late or more */
    uint64_t contact_ticks;      /* ticks in contact */
    uint64_t slip_ticks;         /* ticks in which the friction spring yielded */
    double longest;              /* s; the longest time between two ticks */
    double position[3];          /* m; where the tool is */
    double orientation[4];       /* x y z w */
    palpate_tool_response response; /* last: it may grow */
} palpate_servo_state;

/* Starts a thread that ticks a new session on `field` at `rate` (10 to 1e5 Hz), the tool resting at `position` (m) and
 * `orientation` (x y z w, length 1 within 1 %).  `config` may be null.  Asks for a real-time priority and does without
 * where the system says no.  On success *servo is to be stopped by palpate_servo_stop; the field must outlive it. */
PALPATE_API palpate_status palpate_servo_start(const palpate_field* field, const palpate_config* config, double rate,
                                               const double position[3], const double orientation[4], palpate_servo** servo);

/* From the next tick on the tool goes from where it is to `position` and `orientation` within `duration` s (0 to 1e3).
 * flags: PALPATE_INPUT_RELEASE lets go until another target comes; other bits are refused.  One thread at a time; does not wait. */
PALPATE_API palpate_status palpate_servo_move(palpate_servo* servo, const double position[3], const double orientation[4],
                                              double duration, uint32_t flags);

/* palpate_session_set_field before the next tick.  Every field that was given must outlive the servo. */
PALPATE_API palpate_status palpate_servo_set_field(palpate_servo* servo, const palpate_field* field);

/* palpate_session_reset before the next tick; the counts stay. */
PALPATE_API palpate_status palpate_servo_reset(palpate_servo* servo);

/* Fills *state (whose size must be set).  Any thread.  PALPATE_BAD_ARGUMENT also where there was no tick yet, and in
 * the rare moment in which the system holds the thread up while it publishes: keep what was read before. */
PALPATE_API palpate_status palpate_servo_read(const palpate_servo* servo, palpate_servo_state* state);

/* Ends the thread and frees everything.  Null is allowed. */
PALPATE_API void palpate_servo_stop(palpate_servo* servo);

#ifdef __cplusplus
}
#endif

#endif
