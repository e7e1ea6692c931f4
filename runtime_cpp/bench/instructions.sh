#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
# instructions.sh BUILD FIELD.rfield [FOLDER_OF_ANOTHER_LIBPALPATE]: instructions a tick, by kind of tick, on the traces of the bench.
# Counts do not depend on what else the machine does.  Needs valgrind and palpate_counted_ticks in BUILD.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for kind in stick slide free first; do
  ticks=$(LD_LIBRARY_PATH=${3:-$1} valgrind --tool=callgrind --toggle-collect=counted_tick --callgrind-out-file="$work/$kind" \
    "$1/palpate_counted_ticks" "$2" $kind 2>"$work/log") || { cat "$work/log" >&2; exit 1; }
  awk -v kind=$kind -v ticks="$ticks" \
    '/^(summary|totals):/ { printf "%s: %.0f instructions (%d ticks)\n", kind, $2 / ticks, ticks; exit }' "$work/$kind"
done
