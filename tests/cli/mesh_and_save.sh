#!/usr/bin/env bash
# Replaying a recording's milling: the mesh of the milled bone equals that of the saved milled scan, and both differ from the
# original's; milling that cannot be repeated is refused; repeated runs give the same bytes.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
refused() {  # REGEX COMMAND...
  local code=0
  "${@:2}" >/dev/null 2>refusal || code=$?
  [ "$code" -eq 1 ] || fault "${*:2}: exit code $code, expected 1"
  [ "$(wc -l <refusal)" -eq 1 ] || fault "${*:2}: a refusal is one line"
  grep -qE -- "$1" refusal || fault "${*:2}: $(cat refusal)"
}

"$osteomill" compare --seconds 1.5 --algorithm point-shell --no-stability --out runs >/dev/null
milling=runs/point-shell-milling.h5
"$osteomill" mesh --after "$milling" --out milled.stl
"$osteomill" save --after "$milling" --out milled.nrrd
"$osteomill" mesh milled.nrrd --iso 750 --out saved.stl
cmp milled.stl saved.stl || fault "the saved scan has another surface"
"$osteomill" mesh --out whole.stl
cmp -s whole.stl milled.stl && fault "nothing was milled"
"$osteomill" mesh --out again.stl --after "$milling"
cmp milled.stl again.stl || fault "two runs differ"

"$osteomill" save --out copy.nrrd
"$osteomill" mesh copy.nrrd --out whole.ply --iso 750
"$osteomill" mesh --out whole2.ply
cmp whole.ply whole2.ply || fault "the saved scan differs"

# A recording that continues another needs that file in its folder. Holding mills no bone.
"$osteomill" mesh --out held.stl --after runs/point-shell-holding.h5
cmp milled.stl held.stl || fault "the bone after holding differs"
cp runs/point-shell-holding.h5 alone.h5
refused "^osteomill: alone.h5: continues .*point-shell-milling.h5" "$osteomill" mesh --out a.stl --after alone.h5
refused "^osteomill: $milling: was made with another scan" "$osteomill" save milled.nrrd --out a.nrrd --after "$milling"
printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 1\nencoding: ascii\n\n1 2 3 4 5 6 7 1000\n' >tiny.nrrd
refused "^osteomill: $milling: was made with another scan \(built-in tooth\): 256 x 256 x 176" \
  "$osteomill" mesh tiny.nrrd --out a.stl --after "$milling"
[ ! -e a.stl ] && [ ! -e a.nrrd ] || fault "a refusal left a file"
find . -name '*.writing-*' | grep -q . && fault "left a half-written file"
exit 0
