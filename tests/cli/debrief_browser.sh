#!/usr/bin/env bash
# A debriefing's page in Chromium, on a screen and on a phone, and without WebGL.
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
# Through the roof of the pulp chamber to its floor.
/usr/bin/python3 "$here/exercise_poses.py" plunge 0 0 22 12.5 1 >poses.csv
"$osteomill" replay poses.csv --exercise "$exercises/access_cavity.toml" --burr-radius 0.75 --shaft-radius 0.4 --removal-rate 400 \
  --record through.h5 --quiet >/dev/null
"$osteomill" debrief through.h5 --out out --quiet >/dev/null
/usr/bin/python3 "$here/debrief_browser.py" out 1280 800
/usr/bin/python3 "$here/debrief_browser.py" out 390 844
/usr/bin/python3 "$here/debrief_browser.py" out none
