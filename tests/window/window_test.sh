#!/usr/bin/env bash
# Operates the real window on its own display and checks the saved files:
#   window_test.sh OSTEOMILL NEEDS [SCAN ...]
# Skipped (exit 77) without Xvfb or without NEEDS. Screenshots stay in OSTEOMILL_PICTURES if that is set.
set -euo pipefail
osteomill=$1 needs=$2
shift 2
scan=("$@")
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
[ -z "$needs" ] || [ -e "$needs" ] || { echo "SKIPPED: needs $needs, which is not on this machine"; exit 77; }

xvfb-run -a -s "-screen 0 1280x800x24" timeout 200 "$osteomill" simulate "${scan[@]}" --out out \
  --script "$here/mill_a_hole.txt" >said 2>errors || fail "exit code $?"
[ -z "${OSTEOMILL_PICTURES:-}" ] || cp ./*.png "$OSTEOMILL_PICTURES"
cat said errors
reading() { sed -nE "s/^$1:.* $2 ([0-9.]+) .*/\1/p" said; }
above() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > b) }'; }

# The tool touched bone before the spindle turned, and milled none.
above "$(reading touching force)" 0.2 || fail "the tool did not touch the bone"
above 0.001 "$(reading touching removed)" || fail "bone went without the spindle"
# With the chip law, enamel is removed slowly.
above "$(reading milling removed)" 0.3 || fail "no bone was milled"
# A tool released in bone with the spindle on no longer presses or mills.
above 0.15 "$(reading let-go force)" || fail "the tool that was let go presses"
[ "$(reading let-go removed)" = "$(reading let-go-later removed)" ] || fail "the tool that was let go mills"
# With another algorithm the tool still touches the bone.
above "$(reading other-algorithm force)" 0.02 || fail "the other algorithm feels nothing"
above 0.001 "$(reading undone removed)" || fail "the cut was not taken back"

# The saved scan has the hole: it has fewer bone voxels.
iso=()
for ((n = 0; n < ${#scan[@]}; n++)); do [ "${scan[$n]}" != --iso ] || iso=(--iso "${scan[$((n + 1))]}"); done
[ ${#iso[@]} -gt 0 ] || iso=(--iso 750)
voxels() { "$osteomill" info "$@" --json "${iso[@]}" | sed -nE 's/.*"voxels_above_iso": *([0-9]+).*/\1/p'; }
if [ ${#scan[@]} -gt 0 ] && [ "${scan[0]}" != --iso ]; then before=$(voxels "${scan[0]}"); else before=$(voxels); fi
after=$(voxels out/*-milled.nrrd)
echo "bone voxels before $before, in the saved scan $after"
[ "$after" -lt "$((before - 200))" ] || fail "the saved scan has no hole"
[ -s "$(ls out/*-surface.ply)" ] && [ -s "$(ls out/*-picture.png)" ] || fail "surface or picture is missing"

# The recording is complete and contains the milling.
"$osteomill" report out/*-recording.h5 --out report >/dev/null || fail "the recording cannot be read"
grep -q "^barrier-shell,part 1," report/summary.csv && grep -q "^surface-points,part 2," report/summary.csv ||
  fail "the report lacks the run"
