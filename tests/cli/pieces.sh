#!/usr/bin/env bash
# Pieces of bone are counted and removed, also when a recording is replayed:
#   pieces.sh OSTEOMILL
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "FAILED: $1"; cat out err 2>/dev/null || true; exit 1; }

# A ball of 5 mm, one of 1.5 mm and a lone voxel, in voxels of 0.5 mm.
{
  printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 40 32 32\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
  awk 'function share(radius, i, middle) { return radius - 0.5 * sqrt((i - middle)^2 + (j - 15.5)^2 + (k - 15.5)^2) + 0.5 }
    BEGIN { for (k = 0; k < 32; ++k) for (j = 0; j < 32; ++j) for (i = 0; i < 40; ++i) {
      most = share(5, i, 12); small = share(1.5, i, 34); most = small > most ? small : most
      if (i == 38 && j == 2 && k == 2) most = 1
      print int(1500 * (most < 0 ? 0 : most > 1 ? 1 : most)) } }'
} >balls.nrrd

pieces() { "$osteomill" info balls.nrrd --iso 700 --json --quiet "$@" | tr -d ' \n' | sed -nE 's/.*"pieces":\{"count":([0-9]+),"largest_mm3":\[([^]]*)\].*/\1 \2/p'; }
read -r count sizes <<<"$(pieces)"
[ "$count" = 3 ] || fail "$count pieces"
awk -F, '{ exit !($1 > 500 && $1 < 548 && $2 > 12 && $2 < 16 && $3 == 0.125) }' <<<"$sizes" || fail "of $sizes mm^3"
[ "$(pieces --keep-largest)" = "1 ${sizes%%,*}" ] || fail "the largest: $(pieces --keep-largest)"
[ "$(pieces --min-piece 1 | cut -d' ' -f1)" = 2 ] || fail "those from 1 mm^3 on: $(pieces --min-piece 1)"

code=0
"$osteomill" compare balls.nrrd --iso 700 --min-piece 600 >out 2>err || code=$?
[ $code = 1 ] && [ "$(wc -l <err)" = 1 ] && grep -q "balls.nrrd: .*no piece.* 600 mm" err || fail "none is left: $code"

"$osteomill" compare balls.nrrd --iso 700 --keep-largest --seconds 0.3 --algorithm barrier-shell --no-stability --out c >out 2>err ||
  fail "compare"
grep -q "2 pieces of bone, .* were removed and 1 kept" err || fail "no warning"
"$osteomill" replay c/barrier-shell-milling.h5 --verify >out 2>err || fail "the replay does not use the recorded choice"
grep -q "^same: " out || fail "not the same"
! "$osteomill" replay c/barrier-shell-milling.h5 --keep-largest --verify >out 2>err || fail "accepts another choice"
"$osteomill" mesh balls.nrrd --after c/barrier-shell-milling.h5 --out milled.ply >out 2>err || fail "mesh"
awk '/^element vertex/ { exit !($3 > 0) }' milled.ply || fail "an empty mesh"
