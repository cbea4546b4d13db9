#!/usr/bin/env bash
# Pages of a debriefing, of one with two branches, and of a report in Chromium: on a desktop screen, on a phone, and without WebGL.
#   debrief_browser.sh OSTEOMILL EXERCISES INSTALL_PACKAGES
set -euo pipefail
osteomill=$1 exercises=$2 install_packages=$3
here=$(dirname "$(readlink -f "$0")")
browser() { command -v chromium && command -v chromedriver && /usr/bin/python3 -c 'import selenium'; } >/dev/null 2>&1
browser || { [ "$(id -u)" = 0 ] && "$install_packages" chromium chromium-driver python3-selenium; } || true
browser || { echo "SKIPPED: needs chromium, chromium-driver and python3-selenium, which cannot be installed here"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# Mills through the roof of the pulp chamber to its floor.
/usr/bin/python3 "$here/exercise_poses.py" plunge 0 0 22 12.5 1 >poses.csv
"$osteomill" replay poses.csv --exercise "$exercises/access_cavity.toml" --burr-radius 0.75 --shaft-radius 0.4 --removal-rate 400 \
  --record through.h5 --quiet >/dev/null
"$osteomill" debrief through.h5 --out out --quiet >/dev/null
# A branch from its middle, beside the chamber.
awk -F, 'NR == 1 { print; next } { printf "%.3f,%.4f,0,%.4f,1,0,0,0,1\n", (NR - 2) / 1000, NR < 1500 ? (NR - 2) / 1500 : 1, 18.5 - (NR < 1500 ? 0 : (NR - 1500) / 1500) }' \
  <(seq 0 4000) >aside.csv
sed -i '1s/.*/time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling/' aside.csv
"$osteomill" replay aside.csv --from through.h5 --at 3.5 --record again.h5 --quiet >/dev/null
"$osteomill" debrief again.h5 --out both --quiet >/dev/null
"$osteomill" compare --seconds 1 --no-stability --algorithm point-shell --algorithm barrier-shell --out compared --quiet >/dev/null
for page in out/debrief.html both/debrief.html compared/report.html; do
  for size in "1280 800" "390 844" none; do /usr/bin/python3 "$here/debrief_browser.py" $page $size; done
done
