// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// palpate_bench_main FIELD.rfield: prints one JSON object (see bench.h).
#include <cstdio>

#include "bench.h"

int main(int count, char** arguments) {
    if (count != 2) {
        std::fputs("usage: palpate_bench_main FIELD.rfield\n", stderr);
        return 2;
    }
    static char json[4096];
    const palpate_status status = palpate_bench(arguments[1], json, sizeof json);
    std::fprintf(status == PALPATE_OK ? stdout : stderr, "%s\n", json);
    return status == PALPATE_OK ? 0 : 2;
}
