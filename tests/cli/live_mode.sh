#!/usr/bin/env bash
# `live --mode` runs what it says, and its recording says which: surface-points holds the tool and feels the shaft in
# steady alone.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
live() { "$osteomill" live --seconds 0.5 --algorithm surface-points --quiet --record "$1.h5" "${@:2}" >said.txt; }
is_in() {  # NAME MODE
  "$osteomill" report "$1.h5" --quiet --out "$1" >said.txt
  cut -d, -f1-2 "$1/summary.csv" | grep -q "^surface-points,$2$" || fault "$1.h5 should say that its mode is $2"
  "$osteomill" replay "$1.h5" --verify --quiet >said.txt || fault "$1.h5 is not what $2 gives"
}
echo 'mode = "paper"' >c.toml

live unsaid
is_in unsaid steady
live said --mode paper
is_in said paper
live in_the_file --config c.toml
is_in in_the_file paper
live over_the_file --config c.toml --mode steady
is_in over_the_file steady

points() { grep -o '<th[^>]*>sample_points.*' "$1/report.html" | grep -o '[0-9]\+' | head -n 1; }
[ "$(points said)" -eq 184 ] || fault "24 vertices on the sphere and 20 circles of 8 are the paper's, not $(points said)"
grep -q "^  --mode" <("$osteomill" live --help) || fault "the help does not tell of --mode"
