/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * palpate runtime: renders a cooked response field (.rfield) inside a haptic servo loop.
 *
 *   palpate_field    immutable; opened from memory or a file; shared by any number of threads.
 *   palpate_session  one per tool in a hand; lives in memory that the caller supplies; one thread at a time.
 *   palpate_tick     one servo tick: where the tool is -> force on the hand.
 *
 * Units and axes: SI (m, s, N, J, rad), the organ's own right-handed axes, quaternions x y z w.  Forces and torques
 * are those ON the tool, hence on the hand that holds it.  A host with other units or axes converts outside.
 *
 * Energy: with q_k the tool's reference point and f_k the force sent at tick k, the hand's work is
 * W = - sum f_k . (q_{k+1} - q_k).  Over any path, for any friction and any field that opens,
 *     W + organ_work + hold_leak = stored_energy(end) - stored_energy(start) + dissipated_friction + dissipated_rule,
 * both dissipations >= 0; organ_work is what whoever moves the organ put in (0 while it rests); hold_leak is what holding
 * the force constant over a tick gave or took, at most 1/2 stiffness_max |dq|^2 for each tick within depth_max, dq being
 * the tool's step as the organ sees it.  Nothing else is created (PALPATE_RESPONSE_AXIAL_UNGUARDED excepted, which exists
 * to show that it creates: `injected`, on the left side).
 *
 * Axes: an organ that was never given a pose has the world's axes.  With a pose, positions, forces, torques and normals are in
 * world axes; palpate_field_sample always is in the organ's.
 *
 * Threads: a field may be used by any number of threads at once.  Calls on one session must not overlap; calls on
 * different sessions may.  palpate_tick, palpate_tick_batch, palpate_field_sample and the palpate_session_* functions
 * do not allocate, lock, throw, wait, print or enter the operating system; palpate_field_open* and _close may.
 *
 * Structs begin with their size: set `size` to sizeof the struct as compiled.  A struct smaller than the library's
 * own is refused; a larger one is accepted and its tail left alone.
 */
#ifndef PALPATE_PALPATE_H
#define PALPATE_PALPATE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#if defined(PALPATE_BUILD)
#define PALPATE_API __declspec(dllexport)
#else
#define PALPATE_API __declspec(dllimport)
#endif
#else
#define PALPATE_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
#define PALPATE_NOEXCEPT noexcept
extern "C" {
#else
#define PALPATE_NOEXCEPT
#endif

/* What a servo loop may call: neither waits nor asks the system for anything.  clang 20 and later check it (-Wfunction-effects). */
#if defined(__cplusplus) && defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::nonblocking)
#define PALPATE_REAL_TIME noexcept [[clang::nonblocking]]
#endif
#endif
#ifndef PALPATE_REAL_TIME
#define PALPATE_REAL_TIME PALPATE_NOEXCEPT
#endif

/* Changes when a struct or a function changes in a way that compiled code would notice. */
#define PALPATE_ABI_VERSION 4u

typedef struct palpate_field palpate_field;
typedef struct palpate_session palpate_session;

/* What a call that can fail returns.  palpate_status_text has one sentence for each. */
typedef enum palpate_status {
    PALPATE_OK = 0,
    PALPATE_BAD_ARGUMENT = 1,    /* a null pointer, a struct of the wrong size, memory too small or misaligned */
    PALPATE_FILE_UNREADABLE = 2, /* the file is not there or cannot be read */
    PALPATE_OUT_OF_MEMORY = 3,
    PALPATE_TRUNCATED = 4,    /* fewer or more bytes than the header says */
    PALPATE_NOT_RFIELD = 5,   /* the first bytes are not those of an .rfield */
    PALPATE_WRONG_VERSION = 6, /* cooked by a version with another layout: cook again */
    PALPATE_DAMAGED = 7,      /* the checksum does not fit */
    PALPATE_BAD_LAYOUT = 8,   /* sizes, counts or offsets contradict each other */
    PALPATE_BAD_INDEX = 9,    /* a block index points outside the stored blocks */
    PALPATE_NOT_FINITE = 10,  /* a number is not finite or beyond any physical size */
    PALPATE_BAD_CURVE = 11,   /* a depth curve does not start at zero or is not continuous */
    PALPATE_LAYER_MISSING = 12, /* the file has an effect that this library was built without */
    PALPATE_BAD_LAYER = 13    /* an effect in the file contradicts itself */
} palpate_status;

/* ---- library ------------------------------------------------------------------------------------------------- */

/* PALPATE_ABI_VERSION as compiled into the library. */
PALPATE_API uint32_t palpate_abi_version(void) PALPATE_NOEXCEPT;

/* "major.minor.patch"; static. */
PALPATE_API const char* palpate_version(void) PALPATE_NOEXCEPT;

/* One sentence for a status; static; never null, unknown values included. */
PALPATE_API const char* palpate_status_text(palpate_status status) PALPATE_NOEXCEPT;

/* One sentence for the lowest PALPATE_TICK_ bit set in `tick_status`; static; never null. */
PALPATE_API const char* palpate_tick_text(uint32_t tick_status) PALPATE_NOEXCEPT;

/* A row of palpate_abi_table: where a field of a struct of this header lies, in bytes.  Rows with an empty
 * field_name give a struct's whole size.  For bindings in other languages to check themselves against. */
typedef struct palpate_abi_row {
    const char* struct_name;
    const char* field_name;
    size_t offset;
    size_t size;
} palpate_abi_row;

/* The table; static; its length in *count.  Null when count is null. */
PALPATE_API const palpate_abi_row* palpate_abi_table(size_t* count) PALPATE_NOEXCEPT;

/* ---- field --------------------------------------------------------------------------------------------------- */

/* Flag for palpate_field_open: use `data` in place instead of copying it.  It must be aligned to 64 bytes, stay
 * unchanged and outlive the field.  Mapping a file is the caller's choice: if someone truncates a mapped file, the
 * reader dies (SIGBUS). */
#define PALPATE_OPEN_IN_PLACE 1u

/* Opens a field from `size` bytes of an .rfield (copied unless PALPATE_OPEN_IN_PLACE), proving everything that a
 * tick relies on: sizes, checksum, block indices, finite numbers, curves that start at zero and are continuous.
 * On success *field is the field, to be closed by palpate_field_close.  On failure *field is null and `message`
 * (when not null) holds one sentence, cut to message_size bytes with its NUL. */
PALPATE_API palpate_status palpate_field_open(const void* data, size_t size, uint32_t flags, palpate_field** field,
                                              char* message, size_t message_size) PALPATE_NOEXCEPT;

/* The same, reading the whole file `path` (UTF-8; on Windows the active code page). */
PALPATE_API palpate_status palpate_field_open_file(const char* path, palpate_field** field, char* message,
                                                   size_t message_size) PALPATE_NOEXCEPT;

/* Frees the field.  No session may use it afterwards.  Null is allowed. */
PALPATE_API void palpate_field_close(palpate_field* field) PALPATE_NOEXCEPT;

typedef struct palpate_field_info {
    uint32_t size;
    uint32_t channel_count;      /* amplitude channels: energy, stiffness and friction curves together */
    const char* tool_name;       /* strings live as long as the field */
    const char* tool_shape;
    const char* tool_hash;
    const char* field_hash;
    const char* provenance;      /* JSON, UTF-8, not NUL-terminated */
    uint64_t provenance_size;    /* bytes */
    uint64_t bytes;              /* of the whole .rfield */
    double tool_offset;          /* rho, m: depth = rho - phi(q) */
    double depth_max;            /* m; deepest press; beyond, curves continue and the tick says so */
    double stiffness_max;        /* sigma, N/m; largest stiffness up to depth_max */
    double band[2];              /* m; smallest and largest signed distance meant to be read */
    double box_min[3];           /* m; the geometry lattice's box; space beyond it is free */
    double box_max[3];
    double geometry_spacing;     /* m */
    double amplitude_spacing;    /* m */
    double geometry_error_p99;   /* m */
    double geometry_flagged_share; /* fraction of the band where |grad phi| < 0.9 */
    uint64_t geometry_blocks_stored;
    uint64_t amplitude_blocks_stored; /* the zero block included */
    uint32_t way_count;          /* ways of touching (tilts): 1 to 4 */
    uint32_t reserved;
    double way_cosine[4];        /* of the angle between tool axis and outward normal, falling; way_count of them */
    double way_offset[4];        /* rho of each way, m; tool_offset is the largest */
} palpate_field_info;

/* Fills *info; info->size must be set. */
PALPATE_API palpate_status palpate_field_describe(const palpate_field* field, palpate_field_info* info) PALPATE_NOEXCEPT;

/* Where a point is. */
typedef enum palpate_region {
    PALPATE_REGION_OUTSIDE = 0,   /* free space where nothing is stored */
    PALPATE_REGION_FREE = 1,      /* in the band, not touching: depth <= 0 */
    PALPATE_REGION_CONTACT = 2,   /* depth > 0 */
    PALPATE_REGION_DEEP = 3,      /* in the tissue, deeper than anything stored */
    PALPATE_REGION_UNREACHED = 4, /* near a surface that the scene declares out of reach; no force there */
    PALPATE_REGION_UNKNOWN = 5    /* the input was not usable */
} palpate_region;

/* The field at a point, without state and without friction's history. */
typedef struct palpate_sample {
    uint32_t size;
    uint32_t region;             /* palpate_region */
    double depth;                /* m; rho - phi(q); 0 where region is not FREE or CONTACT */
    double normal[3];            /* unit, out of the tissue; 0 where undefined */
    double distance_gradient[3]; /* grad phi, not normalised */
    double stored_energy;        /* U(q), J */
    double force[3];             /* -grad U(q), N */
    double normal_force;         /* force . normal, N */
    double stiffness;            /* d2U/dd2 at fixed amplitudes, N/m */
    double friction_stiffness;   /* k(q), N/m, >= 0 */
    double friction_coefficient; /* mu(q), >= 0 */
} palpate_sample;

/* Samples the field at `count` reference points q (count x 3, m).  samples[0].size must be set; it is the distance in
 * bytes from one sample to the next, and every sample's size is set on return.  For validation, not for servo loops:
 * it uses the tick's own arithmetic.  A point that is not finite has region UNKNOWN and zeros. */
PALPATE_API palpate_status palpate_field_sample(const palpate_field* field, const double* q, size_t count,
                                                palpate_sample* samples) PALPATE_NOEXCEPT;

/* The same for a tool held so that its axis has `cosine` with the outward normal (clamped to the field's ways); the function above
 * takes the first way. */
PALPATE_API palpate_status palpate_field_sample_tilted(const palpate_field* field, const double* q, double cosine, size_t count,
                                                       palpate_sample* samples) PALPATE_NOEXCEPT;

/* ---- session ------------------------------------------------------------------------------------------------- */

/* How a stretched contact slips (Hayward and Armstrong's adhesion functions): whatever is chosen, slip dissipates. */
typedef enum palpate_adhesion {
    PALPATE_ADHESION_STICK_SLIP = 1,   /* sticks up to the limit, then slips (default) */
    PALPATE_ADHESION_SMOOTH = 2,       /* sticks up to adhesion_start of the limit, then slips more and more, smoothly */
    PALPATE_ADHESION_PROPORTIONAL = 3, /* the same in proportion to the stretch */
    PALPATE_ADHESION_DAHL = 4          /* never quite sticks: a held contact that is shaken drifts.  For comparison only */
} palpate_adhesion;

/* What is felt along the surface. */
typedef enum palpate_response_kind {
    PALPATE_RESPONSE_POTENTIAL = 0, /* the gradient of one energy, lateral push included (default) */
    /* For comparison: the published scheme, which interpolates forces at the contact point and pushes along the normal alone. */
    PALPATE_RESPONSE_AXIAL = 1,           /* guarded: where sliding would raise stored energy the surface yields */
    PALPATE_RESPONSE_AXIAL_UNGUARDED = 2  /* as published: press soft, drag to stiff, lift creates energy.  Never for a hand */
} palpate_response_kind;

typedef struct palpate_config {
    uint32_t size;
    uint32_t adhesion;            /* palpate_adhesion */
    double reference_point[3];    /* m, in the grip's frame: the tool's reference point (ball: its centre) */
    double friction_coefficient;  /* >= 0 replaces the field's mu; negative: the field's own (default) */
    double speed_max;             /* m/s; a faster move is a jump (default 10); 0: no limit */
    double dt_max;                /* s; a longer tick is stale (default 0.1) */
    double adhesion_start;        /* 0 to 0.999; of SMOOTH and PROPORTIONAL, as a fraction of the limit (default 0.5) */
    double force_max;             /* N; the device's limit: the surface yields there, and comes back with the tool; 0: none */
    uint32_t passivity_control;   /* 1: the surface yields by what the hold has given and nothing has dissipated; 0: off */
    uint32_t response;            /* palpate_response_kind */
    double tool_axis[3];          /* unit, in the grip's frame: the tool's axis, out of the tissue (default 0 0 1); read by fields
                                     with several ways of touching */
} palpate_config;

/* Sets *config to the defaults above, reference point at the grip; sets config->size. */
PALPATE_API void palpate_config_default(palpate_config* config) PALPATE_NOEXCEPT;

/* Bytes that a session needs (about 4.6 kB), aligned to 8.  Its state is trivially copyable: a copy of the bytes is a
 * snapshot that can be ticked, replayed or restored in the same process while the field is open. */
PALPATE_API size_t palpate_session_size(void) PALPATE_NOEXCEPT;

/* Makes a session in `memory` (`size` >= palpate_session_size() bytes, aligned to 8) and returns it in *session.
 * The field must outlive it.  `config` may be null for the defaults.  There is nothing to free.
 * A fresh session feels nothing until its tool has been outside the tissue once. */
PALPATE_API palpate_status palpate_session_init(void* memory, size_t size, const palpate_field* field,
                                                const palpate_config* config, palpate_session** session) PALPATE_NOEXCEPT;

/* Back to the state after palpate_session_init, accounts at zero. */
PALPATE_API palpate_status palpate_session_reset(palpate_session* session) PALPATE_REAL_TIME;

/* Gives the session another field (another tool, tilt or state of the same organ, in the same axes) from the next tick
 * on; that tick moves in the old field first, then changes, and takes up to 45 further evaluations of curves.  While
 * touching, stored energy does not rise: where the new field would hold more, its surface yields (surface_offset) until it
 * does not, and comes back with the tool.  The force may step.  Where the new field has no contact, or a surface that faces
 * away, contact is released.  A change of way of touching (tilt) within one field follows the same rule, every tick.  The old field must stay open
 * until a tick has returned without PALPATE_TICK_BAD_INPUT and PALPATE_TICK_BAD_ARGUMENT, which leave before they change. */
PALPATE_API palpate_status palpate_session_set_field(palpate_session* session, const palpate_field* field) PALPATE_REAL_TIME;

/* Copies the session's bytes to `memory` (as in palpate_session_init) and returns the copy in *snapshot. */
PALPATE_API palpate_status palpate_session_snapshot(const palpate_session* session, void* memory, size_t size,
                                                    palpate_session** snapshot) PALPATE_REAL_TIME;

/* What the effect transient did since init or reset: account[0] J given to the hand, account[1] J taken from it, account[2]
 * events.  What it gives is at most energy_max for each event, and what the force of one tick does in the next. */
PALPATE_API palpate_status palpate_session_transient(const palpate_session* session, double account[3]) PALPATE_REAL_TIME;

/* ---- organ ---------------------------------------------------------------------------------------------------- */

/* Where an organ is, for any number of sessions on it (two hands feel the same motion).  One thread moves it, other threads tick;
 * neither waits for the other.  Sessions go from pose to pose at a steady rate: a 60 Hz staircase would shake the hand. */
typedef struct palpate_organ palpate_organ;

/* Bytes that an organ needs, aligned to 8. */
PALPATE_API size_t palpate_organ_size(void) PALPATE_NOEXCEPT;

/* Makes an organ in `memory` (`size` >= palpate_organ_size() bytes, aligned to 8), without a pose.  There is nothing to free. */
PALPATE_API palpate_status palpate_organ_init(void* memory, size_t size, palpate_organ** organ) PALPATE_NOEXCEPT;

/* Publishes a pose: organ axes to world axes, x_world = R(orientation) x_organ + position.  Sessions get there `duration` seconds
 * of their own ticks later (the time until the next pose comes: 1/60 for a 60 Hz scene; 0: at once), position linearly,
 * orientation by normalised interpolation; without a pose before, at once.  Wait-free; one thread at a time.
 * position: |x| <= 1e3 m.  orientation: x y z w, length 1 within 1 %.  duration: 0 to 1e3 s. */
PALPATE_API palpate_status palpate_organ_move(palpate_organ* organ, const double position[3], const double orientation[4],
                                              double duration) PALPATE_REAL_TIME;

/* From the next tick on the session's organ is where `organ` is, which must outlive it; null: it stays where it is. */
PALPATE_API palpate_status palpate_session_set_organ(palpate_session* session, const palpate_organ* organ) PALPATE_REAL_TIME;

/* ---- tick ---------------------------------------------------------------------------------------------------- */

/* Input flags. */
#define PALPATE_INPUT_POSITION_ONLY 1u /* orientation is not read; the grip's axes are the world's */
#define PALPATE_INPUT_RELEASE 2u       /* let go: zero force now, contact again only from outside (a clutch) */
#define PALPATE_INPUT_ORGAN_POSE 4u    /* the organ is where organ_position and organ_orientation say, from this tick on, until
                                          another tick or a moved palpate_organ says otherwise */

typedef struct palpate_tool_state {
    uint32_t size;
    uint32_t flags;        /* PALPATE_INPUT_ */
    double dt;             /* s since the last tick; > 0 and <= dt_max */
    double position[3];    /* m; the grip */
    double orientation[4]; /* x y z w; length 1 within 1 % (it is normalised) */
    double organ_position[3];    /* m; of the organ's origin; read with PALPATE_INPUT_ORGAN_POSE only */
    double organ_orientation[4]; /* x y z w, likewise */
} palpate_tool_state;

/* Tick status bits; 0 is an ordinary tick.  Those marked * mean zero force. */
#define PALPATE_TICK_EXTRAPOLATED 1u    /* deeper than depth_max: the curves continue beyond the presses */
#define PALPATE_TICK_SLIPPING 2u        /* the friction spring yielded in this tick */
#define PALPATE_TICK_UNREACHED 4u       /* * the tool is where nothing was pressed */
#define PALPATE_TICK_TOO_DEEP 8u        /* * deeper than the stored band: released; back only from outside */
#define PALPATE_TICK_PASSED_THROUGH 16u /* * the stroke went through tissue, or turned its normal over: released */
#define PALPATE_TICK_WAITING 32u        /* * in the tissue without having entered from outside */
#define PALPATE_TICK_JUMP 64u           /* * tool against organ faster than speed_max, or too long a stroke to be checked: released */
#define PALPATE_TICK_STALE 128u         /* * dt longer than dt_max: released */
#define PALPATE_TICK_BAD_INPUT 256u     /* * a number that is not finite, dt <= 0, or no unit quaternion: released */
#define PALPATE_TICK_RELEASED 512u      /* * PALPATE_INPUT_RELEASE was set */
#define PALPATE_TICK_BAD_ARGUMENT 1024u /* a null pointer or a struct too small: nothing was read or written */
#define PALPATE_TICK_FORCE_LIMITED 2048u /* the surface yielded to force_max */
#define PALPATE_TICK_LEAK_COVERED 4096u /* the surface yielded to passivity_control */
#define PALPATE_TICK_RULE_YIELDED 8192u /* the surface yields so that a change of way (or axial sliding) raises no energy */
#define PALPATE_TICK_TRANSIENT 16384u   /* a transient plays: force and torque hold it too, and no account of the response does */
#define PALPATE_TICK_TRANSIENT_LIMITED 32768u /* by the device's limits, its energy, the library's fastest contact or four at once */

#define PALPATE_TICK_TEXTURE_LIMITED 65536u /* some of the texture is faded: the device or the loop cannot render all of it */

typedef struct palpate_tool_response {
    uint32_t size;
    uint32_t status;             /* PALPATE_TICK_ bits */
    uint32_t region;             /* palpate_region of the reference point */
    uint32_t reserved;
    double force[3];             /* N, on the hand: -grad U - k s */
    double torque[3];            /* N m, about the grip: (reference_point - position) x force */
    double reference_point[3];   /* m; q; the last usable one on bad input */
    double anchor[3];            /* m; where the friction spring holds: q - s; q itself when not touching */
    double normal[3];            /* unit, out of the tissue; 0 when not in contact */
    double depth;                /* m; <= 0 when free; 0 where unknown */
    double normal_force;         /* N; -grad U . normal */
    double stiffness;            /* N/m; d2U/dd2 */
    double friction_stiffness;   /* N/m; k */
    double friction_coefficient; /* mu in use */
    double stored_energy;        /* J; U + 1/2 k |s|^2 */
    double spring_energy;        /* J; 1/2 k |s|^2 */
    double surface_offset;       /* m; how far the surface has yielded: the tissue is felt at depth - surface_offset */
    /* Accounts since init or reset, J. */
    double work_in;              /* by the hand: - sum f . dq, in world axes */
    double dissipated_friction;  /* by slip, growing stiffness, lift-off of a stretched spring */
    double dissipated_rule;      /* by releases, yielding surfaces and changed fields */
    double hold_leak;            /* by holding the force constant over ticks; signed */
    double organ_work;           /* by whoever moves the organ; signed */
    double injected;             /* made by PALPATE_RESPONSE_AXIAL_UNGUARDED; else 0 */
    double way_cosine;           /* the way of touching that is felt: cosine of tool axis and normal, within the field's ways */
} palpate_tool_response;

/* One servo tick.  state->size and response->size must be set.  Returns response->status.  Never fails otherwise:
 * on bad input the force is zero and the status says why, and contact comes back only from outside.
 * Time: bounded; one evaluation of the field, and one look along the segment from the last point for each geometry
 * spacing that the tool moved beyond the first (at most 256, then PALPATE_TICK_JUMP). */
PALPATE_API uint32_t palpate_tick(palpate_session* session, const palpate_tool_state* state,
                                  palpate_tool_response* response) PALPATE_REAL_TIME;

/* `count` ticks in a row, for recorded traces.  states[0].size and responses[0].size give the distances in bytes from one
 * element to the next; the size in every state must be set.  Returns all status bits that occurred, or-ed. */
PALPATE_API uint32_t palpate_tick_batch(palpate_session* session, const palpate_tool_state* states,
                                        palpate_tool_response* responses, size_t count) PALPATE_REAL_TIME;

/* ---- deformation ---------------------------------------------------------------------------------------------- */

/* How the organ's surface moves under the tool, for graphics: of fields whose scene names the effect `deformation`
 * (PALPATE_LAYER_MISSING for others).  Meant for the thread that draws: no allocation, lock or system call, but exponentials, and a time
 * that grows with the vertices.  Zero without contact, continuous in where the tool is; see palpate_deformation_info for how true. */
typedef struct palpate_deformation_info {
    uint32_t size;
    uint32_t node_count;      /* presses that it was made of */
    uint64_t bytes;
    double radius;            /* m; no vertex farther than this from the contact point moves */
    double depth_end;         /* m; deeper, the last slope goes on, up to twice this depth */
    double error_p95;         /* |displacement - FEM's| as a share of the depth, on presses that never built it: 95th percentile */
    double error_max;         /* and worst; -1 where nobody judged */
    double error_p95_length;  /* m; the same two as lengths */
    double error_max_length;
    double error_within;      /* m from the contact point; where they were judged */
} palpate_deformation_info;

/* Fills *info; info->size must be set. */
PALPATE_API palpate_status palpate_deformation_describe(const palpate_field* field, palpate_deformation_info* info) PALPATE_NOEXCEPT;

/* Where the tool is; copy the fields of the same name from a tick's response. */
typedef struct palpate_deformation_input {
    uint32_t size;
    uint32_t flags;              /* PALPATE_INPUT_ORGAN_POSE: the points are in world axes, the organ is where the pose says */
    double reference_point[3];   /* m */
    double anchor[3];            /* m; a stuck contact drags the surface along by reference_point - anchor */
    double surface_offset;       /* m; how far the surface has yielded */
    double organ_position[3];    /* m; read with PALPATE_INPUT_ORGAN_POSE only */
    double organ_orientation[4]; /* x y z w, likewise */
} palpate_deformation_input;

/* What moved, in the organ's axes; zeros where nothing is pressed or the input is not usable. */
typedef struct palpate_deformation_result {
    uint32_t size;
    uint32_t reserved;
    double contact_point[3];     /* m; only vertices within `radius` of it have moved */
    double normal[3];
    double depth;                /* m */
    double radius;               /* m */
    uint64_t moved_count;        /* of the vertices asked for */
} palpate_deformation_result;

/* Displacements of vertices at rest (x y z, m, the organ's axes, any mesh of its surface) to `displacement`, likewise.
 * indices: the `count` vertices to look at, from a host that knows which are near; null: the first `count`.  Vertices that do not
 * move get zeros.  result: may be null.  A vertex never ends inside the tool; between the vertices of a coarse mesh it may show. */
PALPATE_API palpate_status palpate_deformation(const palpate_field* field, const palpate_deformation_input* input, const float* vertices,
                                               const uint32_t* indices, size_t count, float* displacement,
                                               palpate_deformation_result* result) PALPATE_NOEXCEPT;

/* ---- texture --------------------------------------------------------------------------------------------------- */

/* A small height that enters depth inside U, of fields whose scene names the effect `texture`: conservative, without velocity, still
 * while the tool is.  What a device cannot render is faded (PALPATE_TICK_TEXTURE_LIMITED), by the six limits of V. Hayward,
 * Physically-Based Haptic Synthesis (2008), table 1, for a wave of spatial frequency k and force amplitude A (palpate_texture_info) at the
 * speed v along it in a loop of T (the tick's dt).  Waves that only a fast tool cannot have come back as it slows down.  Fading raises no energy: it is
 * done where it lowers U, into dissipated_rule, and only while the tool moves. */
typedef struct palpate_texture_limits {
    uint32_t size;
    uint32_t reserved;
    double time_factor;          /* alpha: alpha k v T < 1, alpha k delta < 1; at least 2, better 10.  0 in any field: no limit */
    double space_factor;         /* beta: beta k delta < 1; at least 2, better 10 */
    double force_factor;         /* gamma: gamma b < A; at least 10 */
    double resolution;           /* delta, m; of position */
    double force_resolution;     /* b, N */
    double stiffness_max;        /* A_0, N/m: A k < A_0 */
    double structural_frequency; /* F_0, Hz; the device's first mode: v k < F_0 */
} palpate_texture_limits;

typedef struct palpate_texture_info {
    uint32_t size;
    uint32_t wave_count;
    uint64_t bytes;
    double height_max;           /* m; no height is larger */
    double fade_depth;           /* m; from here on the whole height is felt, fading to nothing at the surface */
    double spatial_frequency_max; /* 1/m; of the finest wave */
    double stiffness;            /* N/m; of the response: A is a wave's amplitude times this or 2 pi k normal_force, whichever is larger */
    double time_factor;          /* of the device that the scene was made for, likewise */
    double space_factor;
    double force_factor;
    double resolution;
    double force_resolution;
    double stiffness_max;
    double structural_frequency;
    double normal_force;         /* N; largest of the response; 0: not known (files of older versions) */
} palpate_texture_info;

/* Fills *info; info->size must be set.  PALPATE_LAYER_MISSING for fields without the effect. */
PALPATE_API palpate_status palpate_texture_describe(const palpate_field* field, palpate_texture_info* info) PALPATE_NOEXCEPT;

/* The limits of the device at hand, for this session and every field that it changes to; null: those in the field.  While touching, what
 * they change comes as the tool moves. */
PALPATE_API palpate_status palpate_session_set_texture_limits(palpate_session* session,
                                                              const palpate_texture_limits* limits) PALPATE_REAL_TIME;

/* How much of each wave is rendered, 0 to 1, in the order of the file; 1 where there is no wave. */
PALPATE_API palpate_status palpate_session_texture(const palpate_session* session, double gain[16]) PALPATE_REAL_TIME;

#ifdef __cplusplus
}
#endif

#endif
