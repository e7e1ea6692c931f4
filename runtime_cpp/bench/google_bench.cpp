// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// palpate_google_bench FIELD.rfield... [--benchmark_...]: whole ticks in a row (not timed one by one, as palpate_bench does), for
// each field: stick, slide, free, first contact, potential against axial, 1 to 64 sessions in turn, a moving organ, a tilting tool;
// and how fast this machine reads memory.  Flushed caches are palpate_bench's: a timer that is paused costs microseconds.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "bench_paths.h"

namespace {

using namespace palpate_bench_paths;

struct session {
    std::vector<std::uint64_t> bytes = std::vector<std::uint64_t>((palpate_session_size() + 7) / 8);
    palpate_session* handle = nullptr;
    session(const palpate_field* field, std::uint32_t response) {
        palpate_config config;
        palpate_config_default(&config);
        config.speed_max = 0.0;
        config.response = response;
        palpate_session_init(bytes.data(), bytes.size() * 8, field, &config, &handle);
    }
};

struct how {
    std::uint32_t response = PALPATE_RESPONSE_POTENTIAL;
    std::size_t sessions = 1;
    bool moving = false;   // the organ
    bool tilting = false;  // the tool
};

void run(benchmark::State& state, const palpate_field* field, const std::vector<tick>& path, const how& h) {
    std::vector<session> sessions;
    for (std::size_t i = 0; i < h.sessions; ++i) sessions.emplace_back(field, h.response);
    palpate_tool_state s{};
    s.size = sizeof s;
    s.dt = 1e-3;
    s.flags = h.tilting ? 0u : PALPATE_INPUT_POSITION_ONLY;
    if (h.moving) s.flags |= PALPATE_INPUT_ORGAN_POSE;
    s.orientation[3] = s.organ_orientation[3] = 1.0;
    palpate_tool_response r{};
    r.size = sizeof r;
    std::size_t i = 0, turn = 0;
    for (auto _ : state) {
        std::memcpy(s.position, path[i].q.data(), sizeof s.position);
        if (h.tilting) {  // up to 0.5 rad, then upright again
            s.orientation[0] = 4e-3 * static_cast<double>(i % 64);
            s.orientation[3] = 1.0 - 0.5 * s.orientation[0] * s.orientation[0];
        }
        if (h.moving) s.organ_position[0] = 1e-9 * static_cast<double>(i % 16);
        palpate_tick(sessions[turn].handle, &s, &r);
        if (++turn == sessions.size()) {
            turn = 0;
            if (++i == path.size()) i = 0;
        }
    }
    benchmark::DoNotOptimize(r);
}

// Bytes a second that one core reads from memory far larger than its caches.
void memory(benchmark::State& state) {
    const std::vector<std::uint64_t> data((256u << 20u) / 8, 1);
    std::uint64_t sum = 0;
    for (auto _ : state) {
        for (std::size_t i = 0; i < data.size(); i += 8) sum += data[i];  // one word of each cache line
    }
    benchmark::DoNotOptimize(sum);
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(data.size() * 8));
}

}  // namespace

int main(int count, char** arguments) {
    std::vector<palpate_field*> fields;
    int kept = 1;
    for (int i = 1; i < count; ++i) {
        if (arguments[i][0] == '-') {
            arguments[kept++] = arguments[i];
            continue;
        }
        palpate_field* field = nullptr;
        char why[256];
        if (palpate_field_open_file(arguments[i], &field, why, sizeof why) != PALPATE_OK) {
            std::fprintf(stderr, "%s: %s\n", arguments[i], why);
            return 2;
        }
        palpate_field_info info{};
        info.size = sizeof info;
        palpate_field_describe(field, &info);
        const auto at = contacts(field, 200, 1);
        char name[64];
        std::snprintf(name, sizeof name, "%.2f MB, %u way%s", 1e-6 * static_cast<double>(info.bytes), info.way_count,
                      info.way_count > 1 ? "s" : "");
        const auto add = [&, label = std::string(name)](const char* what, const std::vector<tick>& path, const how& h) {
            if (!path.empty()) benchmark::RegisterBenchmark((label + "/" + what).c_str(), run, field, path, h);
        };
        const auto stick = sticking(at), slide = sliding(field, at);
        add("stick", stick, {});
        add("slide", slide, {});
        add("free", hovering(field, at), {});
        add("first contact", tapping(field, at), {});
        how h;
        h.response = PALPATE_RESPONSE_AXIAL;
        add("slide, axial", slide, h);
        h = {};
        h.moving = true;
        add("slide, organ moves", slide, h);
        h = {};
        h.tilting = true;
        add("slide, tool tilts", slide, h);
        for (std::size_t sessions : {4u, 16u, 64u}) {
            h = {};
            h.sessions = sessions;
            add(("slide, sessions:" + std::to_string(sessions)).c_str(), slide, h);
        }
        fields.push_back(field);
    }
    benchmark::RegisterBenchmark("memory read", memory);
    benchmark::Initialize(&kept, arguments);
    benchmark::RunSpecifiedBenchmarks();
    for (palpate_field* field : fields) palpate_field_close(field);
    return 0;
}
