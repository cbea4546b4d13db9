#!/usr/bin/env bash
# An exercise on a label map of a jaw: mills down to the mandibular canal, and compares the recorded distance with a search over all
# of its voxels.
#   exercise_jaw.sh OSTEOMILL JAW_LABELS
set -euo pipefail
osteomill=$1 jaw=$2
[ -e "$jaw" ] || { echo "SKIPPED: needs $jaw"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fault() { echo "FAILED: $1"; exit 1; }
cat >jaw.toml <<TOML
title = "Beside the mandibular canal"
scan = "$jaw"
labels = "$jaw"
tools = [1]
[target]
label = "2"
sphere = { center = [50.5, 81.5, 49], radius = 2 }
[keep]
margin_mm = 0.5
[[no_go]]
name = "mandibular canal"
label = "5"
[[no_go]]
name = "lower teeth"
label = "4"
[[item]]
measure = "no_go_contacts"
structure = "mandibular canal"
at_most = 0
TOML
"$osteomill" exercise jaw.toml --check --quiet >said
grep -q "^no-go mandibular canal: 831.9 mm³" said || fault "$(cat said)"
# Approaches from the side with the shaft outward.
awk 'BEGIN { print "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling"
  for (n = 0; n < 2200; ++n) printf "%.3f,%.5f,81.5,49,0.70710678,0,-0.70710678,0,1\n", n / 1000, 44 + 0.005 * n }' >poses.csv
"$osteomill" replay poses.csv --exercise jaw.toml --burr-radius 1 --shaft-radius 0.6 --removal-rate 400 --record jaw.h5 --quiet >/dev/null
"$osteomill" debrief jaw.h5 --out out --quiet >said
grep -q "^no_go_contacts.mandibular canal,1,,at most 0,no" out/debrief.csv || fault "$(cat out/debrief.csv)"
"$osteomill" replay jaw.h5 --verify --quiet | grep -q "^same: 2200 ticks" || fault "it does not replay"
/usr/bin/python3 - "$jaw" <<'CHECK' || fault "the distance is not the one to the nearest voxel"
import gzip, sys
import h5py, numpy as np
raw = open(sys.argv[1], "rb").read()
labels = np.frombuffer(gzip.decompress(raw[raw.index(b"\n\n") + 2:]), np.uint8).reshape(330, 360, 360)
middles = 0.5 * np.argwhere((labels == 5) | (labels == 4))[:, ::-1]
with h5py.File("jaw.h5") as f:
    tool = np.stack([f["columns/tool_" + a + "_mm"][::50] for a in "xyz"], axis=1)
    recorded = f["columns/no_go_distance_mm"][::50]
for place, distance in zip(tool, recorded):
    outside = np.maximum(np.abs(middles - place) - 0.25, 0)
    nearest = np.sqrt((outside ** 2).sum(axis=1).min()) - 1
    assert abs(nearest - distance) <= 0.25, (place, nearest, distance)
assert recorded[0] > 6 and recorded.min() < 0, recorded
CHECK
