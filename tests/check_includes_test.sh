#!/usr/bin/env bash
# The tree keeps to the way of the data and to the public headers, and the check finds a tree that does not.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
check="$root/scripts/check-includes"
"$check" "$root"

tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
# A tree of one public header and one inside beside it, and one file that includes something.
plant() {  # FILE INCLUDE
  rm -rf "${tree:?}"/*
  mkdir -p "$tree/osteomill/volume" "$tree/$(dirname "$1")"
  printf 'osteomill_stage(volume\n  HEADERS\n    public.h  # not inside.h\n  SOURCES inside.cpp)\n' \
    >"$tree/osteomill/volume/CMakeLists.txt"
  echo "#include \"$2\"" >"$tree/$1"
}
expect_taken() {
  plant "$@"
  "$check" "$tree" || { echo "refused: $1 includes $2" >&2; exit 1; }
}
expect_refused() {
  plant "$@"
  if "$check" "$tree" >"$tree/said" 2>/dev/null; then
    echo "not found: $1 includes $2" >&2
    exit 1
  fi
  grep -q "^$1:1: .*${3-}" "$tree/said" || { echo "$1 includes $2; said only: $(cat "$tree/said")" >&2; exit 1; }
}
expect_refused osteomill/volume/x.h osteomill/haptics/haptic_algorithm.h "comes after"
expect_refused osteomill/volume/x_test.cpp osteomill/haptics/haptic_algorithm.h "comes after"
expect_refused osteomill/tool/x.h osteomill/ct/read_scan.h
expect_refused osteomill/haptics/line_proxy/x.h osteomill/haptics/point_shell/point_shell.h "another's"
expect_refused osteomill/milling/x.h osteomill/elsewhere/x.h "not a stage"

expect_refused osteomill/volume/public.h osteomill/volume/inside.h HEADERS
expect_taken osteomill/volume/inside.h osteomill/volume/inside.h
expect_taken osteomill/volume/inside.cpp osteomill/volume/public.h
for room in app verification examples; do
  expect_taken "$room/x.cpp" osteomill/volume/public.h
  expect_refused "$room/x.cpp" osteomill/volume/inside.h HEADERS
done
expect_taken benchmarks/x.cpp osteomill/volume/inside.h
expect_taken app/x_test.cpp osteomill/volume/inside.h
expect_taken tests/support/x.h osteomill/volume/inside.h
expect_refused tests/x.h osteomill/volume/inside.h HEADERS

expect_refused osteomill/geometry/x.h app/main.h
expect_refused osteomill/geometry/x.cpp tests/shapes.h
expect_taken osteomill/geometry/x_test.cpp tests/shapes.h
expect_refused app/x.cpp tests/shapes.h
expect_refused verification/x.cpp app/main.h
expect_refused benchmarks/x.cpp verification/section.h
expect_refused tests/x.cpp benchmarks/bones.h

# What is compiled beforehand hides a header's missing include.
says() { printf '%s\n' "$@" >"$tree/osteomill/volume/x.h"; }
plant osteomill/volume/x.h osteomill/volume/public.h
says '// std::vector is told of.' '#include <string>' 'std::string text(std::string_view from);'
"$check" "$tree" || { echo "refused: a header that includes what it names" >&2; exit 1; }
says '#include <string>' 'std::vector<int> numbers();'
! "$check" "$tree" >"$tree/said" 2>/dev/null && grep -q '^osteomill/volume/x.h:2: .*<vector>' "$tree/said" ||
  { echo "not found: std::vector without <vector>" >&2; exit 1; }
