// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Records what a servo loop sends to palpate_tick, for `palpate replay`: room is taken once, a tick copies one state into it, and
// any thread may write what there is so far as CSV.  Numbers keep all their digits: a replay gives the same bits.  Header-only.
#ifndef PALPATE_TRACE_RECORDER_HPP
#define PALPATE_TRACE_RECORDER_HPP

#include <atomic>
#include <cstdio>
#include <memory>

#include "palpate.h"

namespace palpate {

class trace_recorder {
  public:
    // Room for `capacity` ticks, 128 bytes each; the only allocation.
    explicit trace_recorder(std::size_t capacity) : states_(new palpate_tool_state[capacity]()), capacity_(capacity) {}

    // One thread, once for each tick.  Does not wait or allocate; when the room is full the state is counted as dropped.
    void record(const palpate_tool_state& state) noexcept {
        const std::size_t count = count_.load(std::memory_order_relaxed);
        if (count == capacity_) {
            dropped_.fetch_add(1, std::memory_order_relaxed);
            return;
        }
        states_[count] = state;
        count_.store(count + 1, std::memory_order_release);
    }

    std::size_t recorded() const noexcept { return count_.load(std::memory_order_acquire); }
    std::size_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

    // Writes what was recorded so far, a row for each tick; false where the file cannot be written.  Ticks without an orientation get
    // that of the world; columns of an organ are there when any tick gave its pose, which holds until the next one.
    bool write_csv(const char* path) const {
        const std::size_t count = recorded();
        std::FILE* file = std::fopen(path, "w");
        if (file == nullptr) return false;
        bool posed = false;
        for (std::size_t i = 0; i < count; ++i) posed = posed || (states_[i].flags & PALPATE_INPUT_ORGAN_POSE) != 0;
        std::fputs("dt,x,y,z,qx,qy,qz,qw,release", file);
        std::fputs(posed ? ",ox,oy,oz,oqx,oqy,oqz,oqw\n" : "\n", file);
        double organ[7] = {0, 0, 0, 0, 0, 0, 1};
        for (std::size_t i = 0; i < count; ++i) {
            const palpate_tool_state& s = states_[i];
            const double* p = s.position;
            const double world[4] = {0, 0, 0, 1};
            const double* q = (s.flags & PALPATE_INPUT_POSITION_ONLY) != 0 ? world : s.orientation;
            std::fprintf(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%d", s.dt, p[0], p[1], p[2], q[0], q[1], q[2], q[3],
                         (s.flags & PALPATE_INPUT_RELEASE) != 0 ? 1 : 0);
            if ((s.flags & PALPATE_INPUT_ORGAN_POSE) != 0) {
                for (int a = 0; a < 3; ++a) organ[a] = s.organ_position[a];
                for (int a = 0; a < 4; ++a) organ[3 + a] = s.organ_orientation[a];
            }
            for (int a = 0; posed && a < 7; ++a) std::fprintf(file, ",%.17g", organ[a]);
            std::fputc('\n', file);
        }
        const bool written = std::ferror(file) == 0;
        return std::fclose(file) == 0 && written;
    }

  private:
    std::unique_ptr<palpate_tool_state[]> states_;
    std::size_t capacity_;
    std::atomic<std::size_t> count_{0};
    std::atomic<std::size_t> dropped_{0};
};

}  // namespace palpate

#endif
