#!/usr/bin/env bash
# Scripted sessions on the exercises that come along: a good one, too little, too much, and one through the structure that must
# not be touched.
#   exercise_sessions.sh OSTEOMILL EXERCISES
set -euo pipefail
osteomill=$1 exercises=$2
poses=$(dirname "$(readlink -f "$0")")/exercise_poses.py
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
  target=$(value "$1" target_removed_percent) outside=$(value "$1" removed_outside_percent)
  contacts=$(value "$1" no_go_contacts) first=$(value "$1" no_go_first_contact_s)
  echo "$1: target $target %, outside $outside %, contacts $contacts, first ${first:--} s"
}
good() { work "$@"; holds "$target >= 95 && $outside <= 3 && $contacts == 0" || fault "$1"; }
little() { work "$@"; holds "$target <= 60 && $contacts == 0" || fault "$1"; }
much() { work "$@"; holds "$outside >= 15" || fault "$1"; }
# through TIME TOLERANCE ...: the burr's surface reaches the structure then.
through() {
  work "${@:3}"
  holds "$contacts >= 1 && $first >= $1 - 0.001 && $first <= $1 + 0.001 + $2" || fault "$3"
  [ -n "$(value "$3" no_go_force_max_N)" ] || fault "$3"
}

for exercise in "$exercises"/*.toml; do "$osteomill" exercise "$exercise" --check --quiet >/dev/null || fault "$exercise"; done

tooth="--burr-radius 0.75 --shaft-radius 0.4 --removal-rate 400"
good cavity access_cavity "$tooth" cylinder 0 0 15.2 19.5 1.5 0.75 10
little cavity_little access_cavity "$tooth" cylinder 0 0 17.2 19.5 1.5 0.75 10
much cavity_much access_cavity "$tooth" cylinder 0 0 14.8 19.5 2.1 0.75 10
# In the pulp chamber nothing holds the burr up.
through 2.125 0 cavity_through access_cavity "$tooth" plunge 0 0 22 12.5 4

plane="--burr-radius 0.75 --shaft-radius 0.6 --removal-rate 100"
good trench layers "$plane" box -4 -2 -3 4 2 0 0.75 20
little trench_little layers "$plane" box -4 -2 -1.6 4 2 0 0.75 20
much trench_much layers "$plane" box -4.8 -2.6 -3.6 4.8 2.6 0 0.75 20
# Here the tool lags behind the hand by up to 0.1 mm, which at 3 mm/s is 0.033 s.
through 2.4167 0.033 trench_through layers "$plane" plunge 0 0 3 -6 3

mastoid="--burr-radius 1.5 --shaft-radius 1 --removal-rate 400"
good mastoid mastoid "$mastoid" box -5 -5 -11.25 5 8 0 1.5 40
holds "$(value mastoid "thickness_left_min_mm.facial nerve") > 0.9" || fault mastoid
little mastoid_little mastoid "$mastoid" box -5 -5 -6 5 8 0 1.5 40
much mastoid_much mastoid "$mastoid" box -5.9 -6.4 -11.3 6.4 8.9 0 1.5 40
# From (-1, 0, 3) down: the nerve's top is at z = -12.25, the burr's radius 1.5.
through 1.7188 0.013 mastoid_through mastoid "$mastoid" plunge -1 0 3 -13 8
