// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// A stand-in for libFuzzer where there is none: NAME ITERATIONS [SEED...] runs each seed as it is and then mutates the seeds (or
// noise) at random.  A seed is a file, or a folder of files.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

void add(std::vector<std::filesystem::path>& files, const std::filesystem::path& seed) {
    if (!std::filesystem::is_directory(seed)) {
        files.push_back(seed);
        return;
    }
    for (const auto& entry : std::filesystem::directory_iterator(seed)) files.push_back(entry.path());
}

}  // namespace

int main(int count, char** arguments) {
    const long iterations = count > 1 ? std::atol(arguments[1]) : 1000;
    std::vector<std::filesystem::path> files;
    for (int i = 2; i < count; ++i) add(files, arguments[i]);
    std::sort(files.begin(), files.end());  // the same mutations everywhere
    std::vector<std::vector<std::uint8_t>> seeds;
    for (const auto& path : files) {
        std::ifstream file(path, std::ios::binary);
        if (!file) {
            std::fprintf(stderr, "cannot read the seed %s\n", path.string().c_str());
            return 2;
        }
        seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        LLVMFuzzerTestOneInput(seeds.back().data(), seeds.back().size());
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
    std::printf("%zu seeds and %ld inputs made of them, no law broken\n", seeds.size(), iterations);
    return 0;
}
