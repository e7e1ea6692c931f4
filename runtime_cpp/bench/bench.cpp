// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "bench.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "bench_paths.h"

#if defined(__x86_64__) || defined(__i386__)
#include <x86intrin.h>
#define PALPATE_HAS_TSC 1
#endif

namespace {

using namespace palpate_bench_paths;
using steady = std::chrono::steady_clock;

double seconds_since(steady::time_point start) { return std::chrono::duration<double>(steady::now() - start).count(); }

#if PALPATE_HAS_TSC
std::uint64_t stamp() {
    unsigned unused = 0;
    const std::uint64_t t = __rdtscp(&unused);
    _mm_lfence();
    return t;
}
double nanoseconds_per_stamp() {
    const auto start = steady::now();
    const std::uint64_t first = stamp();
    while (seconds_since(start) < 0.05) {
    }
    const std::uint64_t last = stamp();
    return seconds_since(start) * 1e9 / static_cast<double>(last - first);
}
#else
std::uint64_t stamp() {
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(steady::now().time_since_epoch()).count());
}
double nanoseconds_per_stamp() { return 1.0; }
#endif

constexpr int pass_count = 5;
constexpr double dt = 1e-3;                     // s
constexpr std::size_t flush_bytes = 6u << 20u;  // touched between cold ticks

struct stopwatch {
    double unit;      // ns
    double overhead;  // ns, of two stamps with nothing between
    stopwatch() : unit(nanoseconds_per_stamp()), overhead(0.0) {
        std::vector<std::uint64_t> empty(2001);
        for (auto& e : empty) {
            const std::uint64_t a = stamp();
            e = stamp() - a;
        }
        std::nth_element(empty.begin(), empty.begin() + 1000, empty.end());
        overhead = static_cast<double>(empty[1000]) * unit;
    }
};

enum class ticks_wanted { contact, free, all };

// Fastest of the passes for each timed tick that ended as wanted, ns, sorted.
std::vector<double> time_ticks(const palpate_field* field, const std::vector<tick>& path, ticks_wanted wanted, bool cold,
                               const stopwatch& watch) {
    std::vector<std::uint64_t> memory((palpate_session_size() + 7) / 8);
    std::vector<unsigned char> flush(cold ? flush_bytes : 0, 1);
    unsigned long sum = 0;
    std::vector<double> best(path.size(), std::numeric_limits<double>::infinity());
    for (int pass = 0; pass < pass_count; ++pass) {
        palpate_session* session = nullptr;
        palpate_config config;
        palpate_config_default(&config);
        // From one contact to the next is a jump that the bench makes on purpose.
        if (wanted != ticks_wanted::all) config.speed_max = 0.0;
        palpate_session_init(memory.data(), memory.size() * 8, field, &config, &session);
        palpate_tool_state state{};
        state.size = sizeof state;
        state.flags = PALPATE_INPUT_POSITION_ONLY;
        state.dt = dt;
        palpate_tool_response response{};
        response.size = sizeof response;
        for (std::size_t i = 0; i < path.size(); ++i) {
            std::copy(path[i].q.begin(), path[i].q.end(), state.position);
            if (cold && path[i].timed) {
                for (std::size_t b = 0; b < flush.size(); b += 64) sum += flush[b];
            }
            const std::uint64_t start = stamp();
            palpate_tick(session, &state, &response);
            const std::uint64_t end = stamp();
            const bool felt = response.region == PALPATE_REGION_CONTACT && response.normal_force != 0.0;
            const bool as_wanted = wanted == ticks_wanted::all || felt == (wanted == ticks_wanted::contact);
            if (!path[i].timed || !as_wanted) continue;
            best[i] = std::min(best[i], static_cast<double>(end - start) * watch.unit - watch.overhead);
        }
    }
    if (sum == 1) std::puts("");  // keeps the flush
    std::vector<double> kept;
    for (double t : best) {
        if (t < std::numeric_limits<double>::infinity()) kept.push_back(std::max(t, 0.0));
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

std::string summary(const std::vector<double>& sorted) {
    if (sorted.empty()) return "null";
    const auto at = [&](double share) { return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]; };
    char text[200];
    std::snprintf(text, sizeof text, "{\"p50\": %.1f, \"p99\": %.1f, \"p999\": %.1f, \"max\": %.1f, \"count\": %zu}", at(0.5),
                  at(0.99), at(0.999), sorted.back(), sorted.size());
    return text;
}

std::string machine() {
    std::string name = "unknown processor";
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.compare(0, 10, "model name") == 0) {
            name = line.substr(line.find(':') + 2);
            break;
        }
    }
#if defined(__VERSION__)
    name += ", compiler " __VERSION__;
#endif
    std::replace(name.begin(), name.end(), '"', '\'');
    return name;
}

}  // namespace

extern "C" palpate_status palpate_bench(const char* path, char* json, size_t size) {
    if (path == nullptr || json == nullptr || size == 0) return PALPATE_BAD_ARGUMENT;
    double load = std::numeric_limits<double>::infinity();
    palpate_field* field = nullptr;
    for (int i = 0; i < pass_count; ++i) {
        palpate_field_close(field);
        const auto start = steady::now();
        const palpate_status status = palpate_field_open_file(path, &field, json, size);
        if (status != PALPATE_OK) return status;
        load = std::min(load, seconds_since(start) * 1e3);
    }
    palpate_field_info info{};
    info.size = sizeof info;
    palpate_field_describe(field, &info);

    const stopwatch watch;
    const auto at = contacts(field, 200, 1);
    const std::vector<contact> few(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(at.size(), 8)));
    const std::string stick = summary(time_ticks(field, sticking(at), ticks_wanted::contact, false, watch));
    const std::string slide = summary(time_ticks(field, sliding(field, at), ticks_wanted::contact, false, watch));
    const std::string hover = summary(time_ticks(field, hovering(field, at), ticks_wanted::free, false, watch));
    const std::string first = summary(time_ticks(field, tapping(field, at), ticks_wanted::contact, false, watch));
    const std::string cold = summary(time_ticks(field, sliding(field, few), ticks_wanted::contact, true, watch));
    const std::string hard = summary(time_ticks(field, adversarial(field, at, 1000000), ticks_wanted::all, false, watch));
    palpate_field_close(field);
    std::snprintf(json, size,
                  "{\"stick_ns\": %s, \"slide_ns\": %s, \"free_ns\": %s, \"first_contact_ns\": %s, \"cold_ns\": %s, "
                  "\"adversarial_ns\": %s, \"load_ms\": %.3f, \"bytes\": %llu, \"machine\": \"%s\"}",
                  stick.c_str(), slide.c_str(), hover.c_str(), first.c_str(), cold.c_str(), hard.c_str(), load,
                  static_cast<unsigned long long>(info.bytes), machine().c_str());
    return PALPATE_OK;
}
