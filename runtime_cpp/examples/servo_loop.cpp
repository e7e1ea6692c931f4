// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// The shape of a CHAI3D haptics thread, with a device that is simulated: a mass that a hand pushes down and drags aside.
// In CHAI3D the three marked lines are cGenericHapticDevice::getPosition, getRotation and setForceAndTorque.
// With a second argument what was sent is recorded, for `palpate replay`.
#include <palpate/palpate.h>
#include <palpate/trace_recorder.hpp>

#include <cstdio>
#include <vector>

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: %s FIELD.rfield [TRACE.csv] (a surface facing +z near the origin)\n", argv[0]), 2;
    char why[256];
    palpate_field* field = nullptr;
    if (palpate_field_open_file(argv[1], &field, why, sizeof why) != PALPATE_OK) return std::fprintf(stderr, "%s\n", why), 2;
    palpate_field_info info{};
    info.size = sizeof info;
    palpate_field_describe(field, &info);

    std::vector<double> memory(palpate_session_size() / sizeof(double) + 1);
    palpate_session* session = nullptr;
    palpate_session_init(memory.data(), memory.size() * sizeof(double), field, nullptr, &session);

    double p[3] = {0, 0, info.box_max[2] - 1e-3}, v[3] = {0, 0, 0};  // m, m/s
    const double mass = 0.2, damping = 4.0, dt = 1e-3;               // kg, N s/m, s
    palpate::trace_recorder recorder(3000);
    for (int tick = 0; tick < 3000; ++tick) {
        palpate_tool_state tool{sizeof tool, 0, dt, {p[0], p[1], p[2]}, {0, 0, 0, 1}, {0, 0, 0}, {0, 0, 0, 1}};  // getPosition, getRotation
        palpate_tool_response feel{};
        feel.size = sizeof feel;
        recorder.record(tool);
        palpate_tick(session, &tool, &feel);  // feel.force, feel.torque: setForceAndTorque
        const double hand[3] = {tick > 1500 ? 0.15 : 0.0, 0.0, -0.4};  // N
        for (int a = 0; a < 3; ++a) {
            v[a] += dt * (hand[a] + feel.force[a] - damping * v[a]) / mass;
            p[a] += dt * v[a];
        }
        if (tick % 250 == 0) {
            std::printf("%4d ms  z %7.3f mm  depth %6.3f mm  force %6.3f %6.3f %6.3f N  %s\n", tick, p[2] * 1e3, feel.depth * 1e3,
                        feel.force[0], feel.force[1], feel.force[2], palpate_tick_text(feel.status));
        }
    }
    palpate_field_close(field);
    if (argc > 2 && !recorder.write_csv(argv[2])) return std::fprintf(stderr, "cannot write %s\n", argv[2]), 3;
}
