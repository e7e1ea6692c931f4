// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// A servo loop for demonstrations and live views: a thread of its own that calls a function at a steady rate, counts the
// ticks that it missed, and a way to publish what happened without locks.  Header-only; needs threads.  Devices that
// come with a loop of their own (most do) need none of this: call palpate_tick in theirs.  C++14.
#ifndef PALPATE_SERVO_THREAD_HPP
#define PALPATE_SERVO_THREAD_HPP

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <thread>
#include <type_traits>
#include <utility>

namespace palpate {

// The latest value of one writer for any number of readers (a sequence lock over atomic words).  Writing takes a bounded
// number of steps, whatever readers do; a reader that was overtaken tries again.
template <class T>
class latest {
    static_assert(std::is_trivially_copyable<T>::value, "it is copied word by word");
    static constexpr std::size_t word_count = (sizeof(T) + 7) / 8;

  public:
    // One thread at a time.
    void publish(const T& value) noexcept {
        std::uint64_t words[word_count] = {};
        std::memcpy(words, &value, sizeof value);
        const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
        sequence_.store(sequence + 1, std::memory_order_relaxed);
        // Whoever sees one of the new words sees the odd number.  Not a fence: the thread sanitizer does not know fences.
        for (std::size_t i = 0; i < word_count; ++i) words_[i].store(words[i], std::memory_order_release);
        sequence_.store(sequence + 2, std::memory_order_release);
    }

    // Any thread.  False where nothing was published yet, or the writer was faster `tries` times; `value` is then unchanged.
    bool read(T& value, int tries = 100) const noexcept {
        for (; tries > 0; --tries) {
            const std::uint64_t before = sequence_.load(std::memory_order_acquire);
            if (before == 0) return false;
            if ((before & 1u) != 0) continue;
            std::uint64_t words[word_count];
            for (std::size_t i = 0; i < word_count; ++i) words[i] = words_[i].load(std::memory_order_acquire);
            if (sequence_.load(std::memory_order_relaxed) != before) continue;
            std::memcpy(&value, words, sizeof value);
            return true;
        }
        return false;
    }

  private:
    std::atomic<std::uint64_t> sequence_{0};
    std::atomic<std::uint64_t> words_[word_count] = {};
};

// Calls step(dt) every `period` on the monotonic clock from construction to destruction, dt (s) being the time since the
// call before (the period, at first).  A call that comes a whole period late or more skips the ticks that it missed: the
// loop does not run after them.  `step` must not throw.
class servo_thread {
  public:
    template <class Step>
    servo_thread(std::chrono::nanoseconds period, Step step)
        : thread_([this, period, step = std::move(step)]() mutable noexcept { run(period, step); }) {}
    servo_thread(const servo_thread&) = delete;
    servo_thread& operator=(const servo_thread&) = delete;
    ~servo_thread() { stop(); }

    // Ends the loop and waits for it.
    void stop() {
        stopping_.store(true, std::memory_order_relaxed);
        if (thread_.joinable()) thread_.join();
    }

    std::uint64_t ticks() const noexcept { return ticks_.load(std::memory_order_relaxed); }
    std::uint64_t missed() const noexcept { return missed_.load(std::memory_order_relaxed); }

  private:
    template <class Step>
    void run(std::chrono::nanoseconds period, Step& step) noexcept {
        using clock = std::chrono::steady_clock;
        auto last = clock::now() - period;
        auto due = clock::now();
        while (!stopping_.load(std::memory_order_relaxed)) {
            const auto now = clock::now();
            step(std::chrono::duration<double>(now - last).count());
            last = now;
            ticks_.fetch_add(1, std::memory_order_relaxed);
            due += period;
            const auto late = clock::now() - due;
            if (late >= period) {
                const auto skipped = late / period;
                missed_.fetch_add(static_cast<std::uint64_t>(skipped), std::memory_order_relaxed);
                due += skipped * period;
            }
            std::this_thread::sleep_until(due);
        }
    }

    std::atomic<bool> stopping_{false};
    std::atomic<std::uint64_t> ticks_{0};
    std::atomic<std::uint64_t> missed_{0};
    std::thread thread_;  // last: it uses the others
};

}  // namespace palpate

#endif
