#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
# The golden trace with each compiler at -O0, -O2 and -O3, without and with AVX2.  Needs g++, clang++ and GoogleTest.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root/runtime_cpp"
failed=0
for compiler in ${COMPILERS:-g++ clang++}; do
  for level in -O0 -O2 -O3; do
    for isa in baseline avx2; do
      flags=(-std=c++17 "$level" -w -ffp-contract=off -Iinclude -Isrc '-DPALPATE_VERSION_TEXT="golden"')
      sources=(src/*.cpp)
      if [ $isa = avx2 ]; then
        flags+=(-DPALPATE_HAS_AVX2)
      else
        sources=($(ls src/*.cpp | grep -v avx2))
      fi
      rm -f "$work"/*.o
      for source in "${sources[@]}"; do
        extra=()
        [[ $source == *avx2* ]] && extra=(-mavx2)
        "$compiler" "${flags[@]}" "${extra[@]}" -c "$source" -o "$work/$(basename "$source").o"
      done
      "$compiler" "${flags[@]}" '-DPALPATE_TEST_FIELDS=""' ../tests/runtime_cpp/golden_test.cpp "$work"/*.o \
        -lgtest -lgtest_main -lpthread -o "$work/golden"
      if "$work/golden" >"$work/log" 2>&1; then answer=same; else answer=DIFFERENT failed=1; fi
      echo "$compiler $level $isa: $answer"
    done
  done
done
exit $failed
