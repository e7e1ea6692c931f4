// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// palpate_compare FIELD.rfield LIBRARY...: ticks of several builds of libpalpate in one process, in turns, so that the machine's load and
// speed are the same for all.  For each kind of tick: single ticks (the fastest of 15 turns each) and ns a tick of the whole trace in a
// row.
// Two links to one file are one library: give copies.
#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench_paths.h"

using namespace palpate_bench_paths;

namespace {

using steady = std::chrono::steady_clock;
constexpr int turns = 15;

struct build {
    std::string name;
    decltype(&palpate_tick) one_tick;
    decltype(&palpate_session_init) init;
    decltype(&palpate_session_size) session_size;
    decltype(&palpate_config_default) config_default;
    palpate_field* field;
    std::vector<double> fastest;  // ns, by tick
    double in_a_row;              // ns
};

template <class Function>
void find(void* library, const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, name));
    if (function == nullptr) {
        std::fprintf(stderr, "%s: %s\n", name, dlerror());
        std::exit(2);
    }
}

build load(const char* path, const char* field_path) {
    build b{};
    b.name = path;
    void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
        std::fprintf(stderr, "%s\n", dlerror());
        std::exit(2);
    }
    find(library, "palpate_tick", b.one_tick);
    find(library, "palpate_session_init", b.init);
    find(library, "palpate_session_size", b.session_size);
    find(library, "palpate_config_default", b.config_default);
    decltype(&palpate_field_open_file) open = nullptr;
    find(library, "palpate_field_open_file", open);
    char why[512];
    if (open(field_path, &b.field, why, sizeof why) != PALPATE_OK) {
        std::fprintf(stderr, "%s: %s\n", path, why);
        std::exit(2);
    }
    return b;
}

double nanoseconds(steady::duration d) { return std::chrono::duration<double, std::nano>(d).count(); }

// One turn; `wanted` gets which of the timed ticks ended in contact (or free).
void run(build& b, const std::vector<tick>& path, bool contact_wanted, bool single, std::vector<bool>& wanted) {
    std::vector<std::uint64_t> memory((b.session_size() + 7) / 8);
    palpate_session* session = nullptr;
    palpate_config config;
    b.config_default(&config);
    config.speed_max = 0.0;
    b.init(memory.data(), memory.size() * 8, b.field, &config, &session);
    palpate_tool_state state{};
    state.size = sizeof state;
    state.flags = PALPATE_INPUT_POSITION_ONLY;
    state.dt = 1e-3;
    palpate_tool_response response{};
    response.size = sizeof response;
    const auto began = steady::now();
    for (std::size_t i = 0; i < path.size(); ++i) {
        std::copy(path[i].q.begin(), path[i].q.end(), state.position);
        if (!single) {
            b.one_tick(session, &state, &response);
            continue;
        }
        const auto start = steady::now();
        b.one_tick(session, &state, &response);
        b.fastest[i] = std::min(b.fastest[i], nanoseconds(steady::now() - start));
        const bool felt = response.region == PALPATE_REGION_CONTACT && response.normal_force != 0.0;
        wanted[i] = path[i].timed && felt == contact_wanted;
    }
    if (!single) b.in_a_row = std::min(b.in_a_row, nanoseconds(steady::now() - began) / static_cast<double>(path.size()));
}

}  // namespace

int main(int count, char** arguments) {
    palpate_field* field = nullptr;
    char why[512] = "usage: palpate_compare FIELD.rfield LIBRARY...";
    if (count < 3 || palpate_field_open_file(arguments[1], &field, why, sizeof why) != PALPATE_OK) {
        std::fprintf(stderr, "%s\n", why);
        return 2;
    }
    std::vector<build> builds;
    for (int i = 2; i < count; ++i) builds.push_back(load(arguments[i], arguments[1]));
    double clock = 1e9;  // ns, of asking for the time
    for (int i = 0; i < 10000; ++i) {
        const auto start = steady::now();
        clock = std::min(clock, nanoseconds(steady::now() - start));
    }
    const auto at = contacts(field, 200, 1);
    const struct {
        const char* name;
        std::vector<tick> path;
        bool contact;
    } kinds[] = {{"stick", sticking(at), true},
                 {"slide", sliding(field, at), true},
                 {"free", hovering(field, at), false},
                 {"first", tapping(field, at), true}};
    for (const auto& kind : kinds) {
        std::vector<bool> wanted(kind.path.size());
        for (build& b : builds) {
            b.fastest.assign(kind.path.size(), 1e9);
            b.in_a_row = 1e9;
        }
        for (int turn = 0; turn < 2 * turns; ++turn) {
            for (build& b : builds) run(b, kind.path, kind.contact, turn % 2 == 0, wanted);
        }
        for (const build& b : builds) {
            std::vector<double> kept;
            for (std::size_t i = 0; i < kind.path.size(); ++i) {
                if (wanted[i]) kept.push_back(b.fastest[i] - clock);
            }
            std::sort(kept.begin(), kept.end());
            const auto share = [&kept](double s) {
                return kept.empty() ? 0.0 : kept[static_cast<std::size_t>(s * static_cast<double>(kept.size() - 1))];
            };
            std::printf("%-6s p50 %4.0f ns, p99.9 %4.0f ns, in a row %5.1f ns a tick: %s\n", kind.name, share(0.5), share(0.999), b.in_a_row,
                        b.name.c_str());
        }
    }
    palpate_field_close(field);
    return 0;
}
