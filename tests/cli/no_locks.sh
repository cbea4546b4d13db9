#!/usr/bin/env bash
# Studies and recordings work on a file system without locks.
#   no_locks.sh OSTEOMILL NO_LOCKS_LIBRARY
set -euo pipefail
osteomill=$1
library=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
cat >study.toml <<'END'
title = "t"
test = "wall"
[fixed]
algorithm = "line-proxy"
[latin-hypercube]
trials = 4
seed = 1
device-mass = { from = 0.1, to = 1 }
END
# ENOLCK, ENOSYS, EOPNOTSUPP.
for errno in 37 38 95; do
  without_locks() { OSTEOMILL_LOCK_ERRNO=$errno LD_PRELOAD=$library "$osteomill" "$@"; }
  without_locks study study.toml --out s$errno --slices 2 --quiet >/dev/null || fault "a study with errno $errno"
  without_locks study s$errno --status | grep -q "^4 of 4 trials are done" || fault "its status with errno $errno"
  without_locks study s$errno --report --quiet >/dev/null || fault "its report with errno $errno"
  without_locks live --seconds 0.5 --algorithm line-proxy --record r$errno.h5 --quiet >/dev/null 2>&1 || fault "a recording with errno $errno"
  without_locks replay r$errno.h5 --verify --quiet | grep -q "^same: " || fault "its replay with errno $errno"
done
