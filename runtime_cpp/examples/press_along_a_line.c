/* SPDX-FileCopyrightText: 2026 The palpate authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * press_along_a_line FIELD.rfield X Y Z  X Y Z: moves the tool from the first point to the second (m) at 1 kHz in one
 * second and prints time, depth and force. */
#include <stdio.h>
#include <stdlib.h>

#include <palpate/palpate.h>

int main(int argc, char** argv) {
    if (argc != 8) {
        fprintf(stderr, "usage: %s FIELD.rfield X Y Z X Y Z\n", argv[0]);
        return 2;
    }
    char why[256];
    palpate_field* field = NULL;
    if (palpate_field_open_file(argv[1], &field, why, sizeof why) != PALPATE_OK) {
        fprintf(stderr, "%s\n", why);
        return 2;
    }
    palpate_session* session = NULL;
    void* memory = malloc(palpate_session_size());
    if (palpate_session_init(memory, palpate_session_size(), field, NULL, &session) != PALPATE_OK) return 3;

    palpate_tool_state state = {0};
    state.size = sizeof state;
    state.flags = PALPATE_INPUT_POSITION_ONLY;
    state.dt = 1e-3;
    palpate_tool_response response = {0};
    response.size = sizeof response;
    for (int tick = 0; tick <= 1000; ++tick) {
        for (int a = 0; a < 3; ++a) {
            double from = atof(argv[2 + a]), to = atof(argv[5 + a]);
            state.position[a] = from + (to - from) * tick / 1000.0;
        }
        unsigned status = palpate_tick(session, &state, &response);
        if (tick % 50 == 0) {
            printf("%5.3f s  depth %8.5f m  force %8.4f %8.4f %8.4f N  %s\n", tick * 1e-3, response.depth,
                   response.force[0], response.force[1], response.force[2], palpate_tick_text(status));
        }
    }
    printf("hand's work %g J, dissipated %g J\n", response.work_in, response.dissipated_friction);
    free(memory);
    palpate_field_close(field);
    return 0;
}
