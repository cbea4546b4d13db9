#!/usr/bin/env bash
# Scripted sessions on the included exercises: a good one, one that removes too little, one too much, and one that mills into the
# no-go structure.
#   exercise_sessions.sh OSTEOMILL EXERCISES
set -euo pipefail
osteomill=$1 exercises=$2
poses=$(dirname "$(readlink -f "$0")")/exercise_poses.py
page=$(dirname "$(readlink -f "$0")")/debrief_page.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fault() { echo "FAILED: $1"; cat "$1/debrief.csv" 2>/dev/null; exit 1; }
value() { awk -F, -v row="$2" '$1 == row { print $2; exit }' "$1/debrief.csv"; }
holds() { awk "BEGIN { exit !($1) }"; }

# work NAME EXERCISE TOOL POSES...
work() {
  /usr/bin/python3 "$poses" ${@:4} >"$1.csv"
  "$osteomill" replay "$1.csv" --exercise "$exercises/$2.toml" $3 --record "$1.h5" --quiet >/dev/null 2>said || { cat said; fault "$1"; }
  "$osteomill" debrief "$1.h5" --out "$1" --quiet >/dev/null
  /usr/bin/python3 "$page" "$1" || fault "$1"
  target=$(value "$1" target_removed_percent) outside=$(value "$1" removed_outside_percent)
  contacts=$(value "$1" no_go_contacts) first=$(value "$1" no_go_first_contact_s)
  echo "$1: target $target %, outside $outside %, contacts $contacts, first ${first:--} s"
}
good() { work "$@"; holds "$target >= 95 && $outside <= 3 && $contacts == 0" || fault "$1"; }
little() { work "$@"; holds "$target <= 60 && $contacts == 0" || fault "$1"; }
much() { work "$@"; holds "$outside >= 15" || fault "$1"; }
# through CENTRE_Z TIME SPEED ...: the burr reaches the structure when its centre is at CENTRE_Z. The hand is there at TIME; the
# simulated tool follows later, because the cutting force stretches its coupling of 2 N/mm. Reads the tool's path from the log,
# independently of the exercise's distances.
down_to() {
  work "${@:4}"
  "$osteomill" replay "$4.h5" --out "$4.log" --quiet >/dev/null
  read -r tool_s aside stretched_s x y < <(awk -F, -v z="$1" -v speed="$3" 'NR == 1 { for (n = 1; n <= NF; ++n) c[$n] = n; next }
    NR == 2 { x = $c["device_x_mm"]; y = $c["device_y_mm"] }
    $c["tool_z_mm"] <= z { dx = $c["tool_x_mm"] - x; dy = $c["tool_y_mm"] - y; dz = $c["tool_z_mm"] - z
      print $c["time_s"], sqrt(dx * dx + dy * dy + dz * dz), $c["force_z_N"] / 2 / speed, x, y; exit }' "$4.log")
  echo "  the tool at $tool_s s, $aside mm from the place; the hand at $2 s, and ${stretched_s} s for the coupling"
}
through() {
  down_to "$@"
  holds "$contacts >= 1 && ($first - $tool_s) ^ 2 <= 0.00101 ^ 2 && $aside <= 0.1" || fault "$4"
  holds "$first - $2 - $stretched_s >= -0.001 && $first - $2 - $stretched_s <= 0.002" || fault "$4"
  [ -n "$(value "$4" no_go_force_max_N)" ] || fault "$4"
  structure=$(awk -F'[.,]' '$1 == "no_go_contacts" && $3 > 0 { print $2 }' "$4/debrief.csv" | tail -1)
  /usr/bin/python3 "$page" "$4" "$structure" "$tool_s" "$x" "$y" "$1" || fault "$4"
}

# Mills down to the first bone outside the target, when the burr's surface reaches the centre of a voxel.
outside() {
  down_to "$@"
  holds "$tool_s - $2 - $stretched_s >= -0.001 && $tool_s - $2 - $stretched_s <= 0.002 && $aside <= 0.1" || fault "$4"
  /usr/bin/python3 "$page" "$4" "removed outside" "$tool_s" "$x" "$y" "$1" || fault "$4"
}

for exercise in "$exercises"/*.toml; do "$osteomill" exercise "$exercise" --check --quiet >/dev/null || fault "$exercise"; done

tooth="--burr-radius 0.75 --shaft-radius 0.4 --removal-rate 400"
good cavity access_cavity "$tooth" cylinder 0 0 15.2 19.5 1.5 0.75 10
little cavity_little access_cavity "$tooth" cylinder 0 0 17.2 19.5 1.5 0.75 10
much cavity_much access_cavity "$tooth" cylinder 0 0 14.8 19.5 2.1 0.75 10
# The pulp chamber is empty, so no contact delays the burr.
through 13.5 2.125 4 cavity_through access_cavity "$tooth" plunge 0 0 22 12.5 4

good crown crown "$tooth" crown 14.2 18 21 3 2.734 5.9 0.75 40
holds "$(value crown taper_deg) >= 6 && $(value crown taper_deg) <= 10 && $(value crown undercut_mm3) <= 0.5" || fault crown
holds "$(value crown reduction_p10_mm) >= 1" || fault crown
little crown_little crown "$tooth" crown 17.6 18 21 3 2.734 5.9 0.75 40
much crown_much crown "$tooth" crown 13.5 15.5 21 1.4 1.3 5.9 0.75 40
# The burr cuts dentine of the chamber's roof at (0, 0, 15.75).
through 15.75 1.5625 4 crown_through crown "$tooth" plunge 0 0 22 14 4

plane="--burr-radius 0.75 --shaft-radius 0.6 --removal-rate 100"
good trench layers "$plane" box -4 -2 -3 4 2 0 0.75 20
little trench_little layers "$plane" box -4 -2 -1.6 4 2 0 0.75 20
much trench_much layers "$plane" box -4.8 -2.6 -3.6 4.8 2.6 0 0.75 20
through -4.25 2.41667 3 trench_through layers "$plane" plunge 0 0 3 -6 3
# Beside the trench: the nearest bone voxels have their centres at (0.125, 6.125, -0.125) and symmetric to the axis.
outside 0.60386 0.0599 40 trench_beside layers "$plane" plunge 0 6 3 -1 40

mastoid="--burr-radius 1.5 --shaft-radius 1 --removal-rate 400"
good mastoid mastoid "$mastoid" box -5 -5 -11.25 5 8 0 1.5 40
holds "$(value mastoid "thickness_left_min_mm.facial nerve") > 0.9" || fault mastoid
little mastoid_little mastoid "$mastoid" box -5 -5 -6 5 8 0 1.5 40
much mastoid_much mastoid "$mastoid" box -5.9 -6.4 -11.3 6.4 8.9 0 1.5 40
# Down from (-1, 0, 3): the nerve's top is at z = -12.25, the burr's radius is 1.5.
through -10.75 1.71875 8 mastoid_through mastoid "$mastoid" plunge -1 0 3 -13 8
