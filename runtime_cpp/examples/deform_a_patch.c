/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * deform_a_patch FIELD.rfield X Y Z NX NY NZ DEPTH [OUT.obj]: presses the tool DEPTH (m) deep at the surface point X Y Z
 * along the normal NX NY NZ, in a session, and shows how a flat patch of vertices there has moved: what a host does each
 * frame with the last response of its servo thread. */
#include <stdio.h>
#include <stdlib.h>

#include <palpate/palpate.h>

enum { side = 61 };
static float rest[side * side * 3], moved[side * side * 3];

int main(int argc, char** argv) {
    if (argc < 9) {
        fprintf(stderr, "usage: %s FIELD.rfield X Y Z NX NY NZ DEPTH [OUT.obj]\n", argv[0]);
        return 2;
    }
    double c[3], n[3], depth = atof(argv[8]);
    for (int a = 0; a < 3; ++a) {
        c[a] = atof(argv[2 + a]);
        n[a] = atof(argv[5 + a]);
    }
    char why[256];
    palpate_field* field = NULL;
    if (palpate_field_open_file(argv[1], &field, why, sizeof why) != PALPATE_OK) {
        fprintf(stderr, "%s\n", why);
        return 2;
    }
    palpate_deformation_info info = {0};
    info.size = sizeof info;
    palpate_status status = palpate_deformation_describe(field, &info);
    if (status != PALPATE_OK) {
        fprintf(stderr, "%s\n", palpate_status_text(status));
        return 2;
    }
    palpate_field_info about = {0};
    about.size = sizeof about;
    palpate_field_describe(field, &about);

    /* The servo thread's part: straight down, 0.1 mm a tick. */
    palpate_session* session = NULL;
    void* memory = malloc(palpate_session_size());
    if (palpate_session_init(memory, palpate_session_size(), field, NULL, &session) != PALPATE_OK) return 3;
    palpate_tool_state state = {0};
    palpate_tool_response response = {0};
    state.size = sizeof state;
    state.flags = PALPATE_INPUT_POSITION_ONLY;
    state.dt = 1e-3;
    response.size = sizeof response;
    for (double way = -1e-3; way < depth + 1e-4; way += 1e-4) {
        double d = way < depth ? way : depth;
        for (int a = 0; a < 3; ++a) state.position[a] = c[a] + (about.tool_offset - d) * n[a];
        palpate_tick(session, &state, &response);
    }

    /* The graphics thread's part. */
    for (int i = 0; i < side * side; ++i) {
        double x = info.radius * (2.0 * (i % side) / (side - 1) - 1.0), y = info.radius * (2.0 * (i / side) / (side - 1) - 1.0);
        int k = n[0] * n[0] < n[1] * n[1] ? (n[0] * n[0] < n[2] * n[2] ? 0 : 2) : (n[1] * n[1] < n[2] * n[2] ? 1 : 2);
        double e[3] = {k == 0, k == 1, k == 2}; /* an axis that the normal avoids gives two tangents */
        double t[3] = {e[0] - n[k] * n[0], e[1] - n[k] * n[1], e[2] - n[k] * n[2]};
        double b[3] = {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]};
        for (int a = 0; a < 3; ++a) rest[3 * i + a] = (float)(c[a] + x * t[a] + y * b[a]);
    }
    palpate_deformation_input input = {0};
    palpate_deformation_result result = {0};
    input.size = sizeof input;
    result.size = sizeof result;
    for (int a = 0; a < 3; ++a) {
        input.reference_point[a] = response.reference_point[a];
        input.anchor[a] = response.anchor[a];
    }
    input.surface_offset = response.surface_offset;
    status = palpate_deformation(field, &input, rest, NULL, side * side, moved, &result);
    double along = 0.0;
    for (int a = 0; a < 3; ++a) along -= moved[3 * (side * side / 2) + a] * n[a];
    printf("%s\n%zu of %d vertices moved, within %.1f mm; depth %.3f mm, the middle went down %.3f mm\n", palpate_status_text(status),
           (size_t)result.moved_count, side * side, 1e3 * result.radius, 1e3 * result.depth, 1e3 * along);
    if (argc > 9) {
        FILE* out = fopen(argv[9], "w");
        if (out == NULL) return 3;
        for (int i = 0; i < 3 * side * side; i += 3) {
            fprintf(out, "v %g %g %g\n", (double)(rest[i] + moved[i]), (double)(rest[i + 1] + moved[i + 1]),
                    (double)(rest[i + 2] + moved[i + 2]));
        }
        for (int i = 0; i + side < side * side; ++i) {
            if (i % side < side - 1) fprintf(out, "f %d %d %d %d\n", i + 1, i + 2, i + side + 2, i + side + 1);
        }
        fclose(out);
    }
    free(memory);
    palpate_field_close(field);
    return 0;
}
