// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// A stand-in for libFuzzer where there is no clang: NAME ITERATIONS [SEED_FILE...] mutates the seeds (or noise) at random.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int count, char** arguments) {
    const long iterations = count > 1 ? std::atol(arguments[1]) : 1000;
    std::vector<std::vector<std::uint8_t>> seeds;
    for (int i = 2; i < count; ++i) {
        std::ifstream file(arguments[i], std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    std::mt19937_64 random(1);
    for (long n = 0; n < iterations; ++n) {
        std::vector<std::uint8_t> input;
        if (seeds.empty()) {
            input.resize(random() % 20000);
            for (auto& byte : input) byte = static_cast<std::uint8_t>(random());
        } else {
            input = seeds[random() % seeds.size()];
            if (random() % 8 == 0) input.resize(random() % (input.size() + 1));
            const std::uint64_t early = random() % 2;  // half of the mutations hit the header
            for (std::uint64_t m = 1 + random() % 4; m > 0 && !input.empty(); --m) {
                const std::size_t reach = early != 0 ? std::min<std::size_t>(700, input.size()) : input.size();
                const std::size_t at = random() % reach;
                input[at] = random() % 3 == 0 ? static_cast<std::uint8_t>(input[at] ^ (1u << random() % 8))
                                              : static_cast<std::uint8_t>(random() % 2 == 0 ? random() : 0xFFu * (random() % 2));
            }
        }
        LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    std::printf("%ld inputs, no law broken\n", iterations);
    return 0;
}
