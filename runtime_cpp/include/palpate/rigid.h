/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * palpate rigid contact: the wrench that a held rigid object feels from fixed rigid objects, gravity and its own inertia.
 * After Luo and Xiao, Physically Accurate Haptic Rendering with Dynamic Effects, IEEE CG&A 24(6), 2004.
 *
 *   palpate_rigid          immutable; opened from cooked bytes (.rigid); shared by any number of threads.
 *   palpate_rigid_session  one held object in a hand; lives in memory that the caller supplies.
 *   palpate_rigid_tick     one servo tick: where the hand holds the object -> wrench on the hand.
 *
 * It touches no response field: a scene with both ticks both and adds the wrenches (palpate_rigid_add).
 * Units and axes: SI; the fixed objects' axes are the world's; the held object's origin is its centre of mass.  Wrenches are
 * those ON the hand.  Without a coupling (default) the held object is where the device is.  With one, a spring and damper of six
 * directions pull it there: it moves by contacts, its weight and its own inertia, and the hand feels the coupling.
 *
 * Accounts: W = - sum of f . dx + m . dtheta is the hand's work.  Over any path
 *     work_in = stored_energy(end) - stored_energy(start) + dissipated_friction + dissipated_damping + inertial + gravity_work + unaccounted,
 * where `unaccounted` is what holding wrenches over ticks, changing formations and limits gave (< 0: created) or took.  Luo and
 * Xiao's law is not the gradient of one energy, so unaccounted is not zero; it is told instead of hidden.
 * Inertia is felt in free motion only (not with a coupling), and gives back no more than the hand put into it.  Over ticks of one length, and
 * a hand that accelerates by at most acceleration_max (of any point of the object), with the object's mass m,
 *     inertial >= -(1 + 1e-9 n) m a 10 m/s2   after n ticks, a = acceleration_max dt^2 / 0.9.
 * With a coupling, stored_energy has the spring's and the kinetic energy (inertial stays 0, gravity_work is the object's), and over any
 * path of ticks of one length dt whose hand accelerates by at most acceleration_max (of any point of the object)
 *     unaccounted >= -1.01 a (k a / 2 + 0.3 m/s b),   a = acceleration_max dt^2 / 0.9
 * at every tick (k = max(coupling_stiffness, coupling_torsional_stiffness / R^2), b alike, R: the held object's radius about its centre of
 * mass): whatever the contacts do, no more than this reserve ever comes out that was not put in.  A wrench is therefore sent only as far
 * as the energy at hand covers it over the next step (PALPATE_RIGID_TICK_ENERGY_LIMITED where that is less than the coupling's).  A hand
 * that accelerates more and takes out more is let go (PALPATE_RIGID_TICK_JUMP).
 *
 * palpate_rigid_tick and the palpate_rigid_session_* functions do not allocate, lock, throw, wait or print.
 */
#ifndef PALPATE_RIGID_H
#define PALPATE_RIGID_H

#include "palpate/palpate.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct palpate_rigid palpate_rigid;
typedef struct palpate_rigid_session palpate_rigid_session;

#define PALPATE_RIGID_CONTACT_LIMIT 8u /* principal contacts in a formation */

/* Opens cooked bytes (copied), proving all that a tick relies on.  On failure *rigid is null and `message` has one sentence. */
PALPATE_API palpate_status palpate_rigid_open(const void* data, size_t size, palpate_rigid** rigid, char* message,
                                              size_t message_size) PALPATE_NOEXCEPT;
PALPATE_API void palpate_rigid_close(palpate_rigid* rigid) PALPATE_NOEXCEPT;

typedef struct palpate_rigid_config {
    uint32_t size;
    uint32_t inertia;         /* 1: in free motion the object's own inertia is felt (default); 0: not */
    double grip[3];           /* m, in the held object's frame: where the device holds it */
    double speed_max;         /* m/s, of any point of the object; a faster move is a jump (default 5); 0: 1e6 */
    double dt_max;            /* s; a longer tick is stale (default 0.1) */
    double force_max;         /* N; the device's limit; 0: none */
    double torque_max;        /* N m, about the grip; 0: none */
    double filter_time;       /* s; first-order filter of velocities and accelerations (default 0.005); 0: none */
    double coupling_stiffness;            /* N/m, at the grip; 0 (default): no coupling */
    double coupling_damping;              /* N s/m */
    double coupling_torsional_stiffness;  /* N m/rad; above 0 exactly where coupling_stiffness is */
    double coupling_torsional_damping;    /* N m s/rad */
    double acceleration_max;              /* m/s2, of the hand (default 300); what the energy accounts count on */
} palpate_rigid_config;

PALPATE_API void palpate_rigid_config_default(palpate_rigid_config* config) PALPATE_NOEXCEPT;

/* Bytes that a session needs, aligned to 8; trivially copyable. */
PALPATE_API size_t palpate_rigid_session_size(void) PALPATE_NOEXCEPT;
PALPATE_API palpate_status palpate_rigid_session_init(void* memory, size_t size, const palpate_rigid* rigid,
                                                      const palpate_rigid_config* config,
                                                      palpate_rigid_session** session) PALPATE_NOEXCEPT;
PALPATE_API palpate_status palpate_rigid_session_reset(palpate_rigid_session* session) PALPATE_REAL_TIME;

/* Where the held object is after the last tick: centre of mass (m) and orientation (x y z w); without a coupling where the device is.
 * PALPATE_BAD_ARGUMENT before the first tick. */
PALPATE_API palpate_status palpate_rigid_session_place(const palpate_rigid_session* session, double position[3],
                                                       double orientation[4]) PALPATE_REAL_TIME;

/* What kind of region a principal contact has. */
typedef enum palpate_rigid_region {
    PALPATE_RIGID_POINT = 0,
    PALPATE_RIGID_LINE = 1,
    PALPATE_RIGID_PLANE = 2
} palpate_rigid_region;

/* Prior motion, between the last tick and this one. */
typedef enum palpate_rigid_motion {
    PALPATE_RIGID_FREE = 0,    /* no contact now */
    PALPATE_RIGID_GUARDED = 1, /* MT1: contact gained from none */
    PALPATE_RIGID_KEPT = 2,    /* MT2: the formation is kept */
    PALPATE_RIGID_GAINED = 3,  /* MT3: a principal contact gained */
    PALPATE_RIGID_CHANGED = 4  /* MT4: principal contacts changed or broken */
} palpate_rigid_motion;

/* How the object moves against what it touches: MT2's cases. */
typedef enum palpate_rigid_case {
    PALPATE_RIGID_NO_CASE = 0,
    PALPATE_RIGID_STATIC = 1,   /* a */
    PALPATE_RIGID_ROLLING = 2,  /* b */
    PALPATE_RIGID_TURNING = 3,  /* c: about contact points that rest */
    PALPATE_RIGID_SLIDING = 4   /* d */
} palpate_rigid_case;

typedef struct palpate_rigid_state {
    uint32_t size;
    uint32_t flags;        /* PALPATE_INPUT_RELEASE, or 0 */
    double dt;             /* s */
    double position[3];    /* m; the grip */
    double orientation[4]; /* x y z w */
} palpate_rigid_state;

/* Status bits; those marked * mean zero wrench. */
#define PALPATE_RIGID_TICK_JUMP 1u           /* * faster than speed_max, or further than contacts can be followed: released */
#define PALPATE_RIGID_TICK_STALE 2u          /* * dt longer than dt_max: released */
#define PALPATE_RIGID_TICK_BAD_INPUT 4u      /* * not finite, dt < 1e-9 s, no unit quaternion: released */
#define PALPATE_RIGID_TICK_BAD_ARGUMENT 8u   /* a null pointer or a struct too small: nothing was read or written */
#define PALPATE_RIGID_TICK_RELEASED 16u      /* * PALPATE_INPUT_RELEASE was set */
#define PALPATE_RIGID_TICK_TOO_DEEP 32u      /* * deeper than depth_max: released */
#define PALPATE_RIGID_TICK_WAITING 64u       /* * among the fixed objects without having come from free space */
#define PALPATE_RIGID_TICK_FORCE_LIMITED 128u
#define PALPATE_RIGID_TICK_OVERFLOW 256u     /* more contacts than are kept: the ones least deep are left out */
#define PALPATE_RIGID_TICK_NOT_IN_TABLE 512u /* the formation is not in the table of valid ones; rendered as found */
#define PALPATE_RIGID_TICK_ENERGY_LIMITED 1024u /* the coupling gave less than its spring: the hand has not put in the energy */

typedef struct palpate_rigid_contact {
    uint32_t held_element;   /* index of the element of the held object */
    uint32_t fixed_element;
    uint32_t region;         /* palpate_rigid_region */
    uint32_t sliding;        /* 1: kinetic friction */
    double point[3];         /* m; equivalent contact point: where the normal force acts */
    double normal[3];        /* unit; y-axis of the task frame: of the contact plane, to the held object */
    double tangent[3];       /* unit; x-axis of the task frame; z = x cross y */
    double gap;              /* m; d_i */
    double normal_force;     /* N */
    double friction[3];      /* N */
} palpate_rigid_contact;

typedef struct palpate_rigid_response {
    uint32_t size;
    uint32_t status;
    uint32_t motion;         /* palpate_rigid_motion */
    uint32_t motion_case;    /* palpate_rigid_case */
    uint32_t contact_count;
    uint32_t formation;      /* index in the table of valid formations; 0xffffffff: none, or not in it */
    double force[3];         /* N */
    double torque[3];        /* N m, about the grip */
    double contact_force[3]; /* N; F_c */
    double contact_torque[3];/* N m, about the centre of mass; M_c */
    double velocity[3];      /* m/s, of the centre of mass; filtered */
    double angular_velocity[3];
    double acceleration[3];
    double angular_acceleration[3];
    double stored_energy;    /* J */
    double work_in;          /* J, accounts since init or reset */
    double dissipated_friction;
    double dissipated_damping;
    double inertial;         /* taken by the rendered inertia, which gives back no more than it took */
    double gravity_work;     /* done against gravity; signed */
    double unaccounted;
    palpate_rigid_contact contact[8];
} palpate_rigid_response;

PALPATE_API uint32_t palpate_rigid_tick(palpate_rigid_session* session, const palpate_rigid_state* state,
                                        palpate_rigid_response* response) PALPATE_REAL_TIME;

/* `count` ticks in a row; sizes in states[0] and responses[0] are the distances between elements.  All status bits, or-ed. */
PALPATE_API uint32_t palpate_rigid_tick_batch(palpate_rigid_session* session, const palpate_rigid_state* states,
                                              palpate_rigid_response* responses, size_t count) PALPATE_REAL_TIME;

/* One sentence for the lowest status bit; static; never null. */
PALPATE_API const char* palpate_rigid_tick_text(uint32_t status) PALPATE_NOEXCEPT;

/* Both worlds: one wrench about the grip from a tissue's force and torque (about the same grip) and a rigid one's, kept together
 * within force_max and torque_max (0: none) by one common factor.  Returns 1 where it was limited. */
PALPATE_API uint32_t palpate_rigid_add(const double force_a[3], const double torque_a[3], const double force_b[3],
                                       const double torque_b[3], double force_max, double torque_max, double force[3],
                                       double torque[3]) PALPATE_REAL_TIME;

/* The formation at a pose, without state, history or forces: for tables and tests. 
 * Poses are those of the centre of mass.  Fills responses' contacts, contact_count, formation and status. */
PALPATE_API palpate_status palpate_rigid_identify(const palpate_rigid* rigid, const palpate_rigid_state* states,
                                                  palpate_rigid_response* responses, size_t count) PALPATE_REAL_TIME;

#ifdef __cplusplus
}
#endif

#endif
