// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// How many instructions that fetch memory ahead a call executes.  A compiler may drop them, for they change nothing: gcc did, while they
// still stood in the library.  So the processor stops after each instruction (trap flag) and the next one is looked at.  Linux on x86-64.
#ifndef PALPATE_TESTS_EXECUTED_FETCHES_H
#define PALPATE_TESTS_EXECUTED_FETCHES_H

#if defined(__linux__) && defined(__x86_64__)
#define PALPATE_COUNTS_FETCHES 1

#include <csignal>
#include <cstdint>
#include <ucontext.h>

namespace palpate_test {

struct stepping {
    volatile std::sig_atomic_t wanted = 0;
    volatile long fetches = 0;
};
inline stepping& step_by_step() {
    static stepping state;
    return state;
}

inline void look_at_next(int, siginfo_t*, void* context) {
    constexpr greg_t trap_flag = 0x100;
    auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
    stepping& state = step_by_step();
    if (state.wanted == 0) {
        registers[REG_EFL] &= ~trap_flag;
        return;
    }
    registers[REG_EFL] |= trap_flag;
    const auto* code = reinterpret_cast<const unsigned char*>(registers[REG_RIP]);
    if ((code[0] & 0xF0) == 0x40) ++code;  // a prefix for more registers
    if (code[0] == 0x0F && code[1] == 0x18) state.fetches = state.fetches + 1;  // prefetcht0 and its kin
}

template <class Call>
long executed_fetches(const Call& call) {
    struct sigaction stop{}, before{};
    stop.sa_sigaction = look_at_next;
    stop.sa_flags = SA_SIGINFO;
    sigaction(SIGTRAP, &stop, &before);
    stepping& state = step_by_step();
    state.fetches = 0;
    state.wanted = 1;
    raise(SIGTRAP);
    call();
    state.wanted = 0;
    raise(SIGTRAP);  // the last one
    sigaction(SIGTRAP, &before, nullptr);
    return state.fetches;
}

// Whether one that is certainly executed is counted.
inline bool can_step() {
    static int somewhere = 0;
    return executed_fetches([] { asm volatile("prefetcht0 %0" : : "m"(somewhere)); }) == 1;
}

}  // namespace palpate_test

#endif
#endif
