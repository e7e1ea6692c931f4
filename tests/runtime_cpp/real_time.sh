#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
# Clang's function effects: nothing that a servo loop may call (PALPATE_REAL_TIME) allocates, locks, throws or calls what might.  Needs a
# clang of 20 or later: $REAL_TIME_CXX, clang++, clang++-20 and on, or the one in the `ziglang` wheel of $PYTHON (default python3).
# Exits with 77 where there is none.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../runtime_cpp"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

checks() { # COMPILER...: it knows the attribute, and refuses a function that breaks it
  command -v "$1" >/dev/null || return 1
  echo 'extern "C" void* malloc(unsigned long); int f() noexcept [[clang::nonblocking]] { return 1; }' >"$work/good.cpp"
  echo 'extern "C" void* malloc(unsigned long); void* f() noexcept [[clang::nonblocking]] { return malloc(8); }' >"$work/bad.cpp"
  "$@" -c -Wfunction-effects -Werror "$work/good.cpp" -o "$work/o" 2>/dev/null &&
    ! "$@" -c -Wfunction-effects -Werror "$work/bad.cpp" -o "$work/o" 2>/dev/null
}

compiler=()
for candidate in "${REAL_TIME_CXX:-}" clang++ clang++-{20..30} "${PYTHON:-python3} -m ziglang c++"; do
  read -ra words <<<"$candidate"
  if [ ${#words[@]} -gt 0 ] && checks "${words[@]}"; then
    compiler=("${words[@]}")
    break
  fi
done
if [ ${#compiler[@]} -eq 0 ]; then
  echo "no clang of 20 or later here, so function effects are NOT checked (pip install ziglang brings one)"
  exit 77
fi
echo "function effects by ${compiler[*]}: $("${compiler[@]}" --version | head -n 1)"
failed=0
for source in src/*.cpp src/layers/*.cpp; do
  flags=(-std=c++17 -ffp-contract=off -Iinclude -Isrc -DPALPATE_HAS_AVX2 '-DPALPATE_VERSION_TEXT="effects"')
  [[ $source == *avx2* ]] && flags+=(-mavx2)
  "${compiler[@]}" "${flags[@]}" -Wfunction-effects -Werror -c "$source" -o "$work/o" || failed=1
done
[ $failed -eq 0 ] && echo "nothing that a tick does blocks"
exit $failed
