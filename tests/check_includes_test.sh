#!/usr/bin/env bash
# The tree keeps to the way of the data, and the check finds a tree that does not.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
check="$root/scripts/check-includes"
"$check" "$root"

faulty=$(mktemp -d)
trap 'rm -rf "$faulty"' EXIT
expect_refused() {  # FOLDER INCLUDE
  rm -rf "${faulty:?}/osteomill"
  mkdir -p "$faulty/osteomill/$1"
  echo "#include \"$2\"" >"$faulty/osteomill/$1/x.h"
  if "$check" "$faulty" >/dev/null 2>&1; then
    echo "not found: $1 includes $2" >&2
    exit 1
  fi
}
expect_refused volume osteomill/haptics/haptic_algorithm.h
expect_refused tool osteomill/ct/read_scan.h
expect_refused haptics/line_proxy osteomill/haptics/point_shell/point_shell.h
expect_refused milling osteomill/elsewhere/x.h
expect_refused geometry app/main.h
