#!/usr/bin/env bash
# A finished comparison replaces an earlier one in its folder as a whole; a killed one leaves the earlier one unchanged. A report on
# recordings that do not belong together lists their differences and draws no conclusions.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
compare() { "$osteomill" compare --no-stability --quiet --out c "$@" >out; }
recordings() { (cd c && echo *.h5); }

compare --seconds 0.3 --algorithm line-proxy --seeds 2
echo mine >c/notes.txt
[ -s c/study.csv ] || fault "no study.csv"
"$osteomill" compare --no-stability --quiet --out c --seconds 30 --algorithm point-shell --seed 2 --burr-radius 2 \
  --seeds 3 >out &
killed=$!
for n in $(seq 1200); do
  if [ -n "$(find c -path '*point-shell-milling.h5')" ]; then break; fi
  sleep 0.1
done
[ -n "$(find c -path '*point-shell-milling.h5')" ] || fault "the second comparison records nothing"
kill -9 $killed
wait $killed 2>/dev/null || true
[ "$(recordings)" = "line-proxy-holding.h5 line-proxy-milling.h5" ] || fault "after a kill, these recordings are there: $(recordings)"
[ -s c/study.csv ] && [ -s c/report.html ] || fault "a killed comparison removed the earlier report"

compare --seconds 0.3 --algorithm point-shell --seed 2 --burr-radius 2
[ "$(recordings)" = "point-shell-holding.h5 point-shell-milling.h5" ] || fault "recordings of the earlier comparison are left: $(recordings)"
grep -q line-proxy c/study.csv && fault "the earlier study.csv is left"
[ "$(cat c/notes.txt)" = mine ] || fault "a file that is not part of a comparison was removed"
ids=$(strings -n 16 c/*.h5 | grep -cE '^[0-9a-f]{16}$') || true
[ "${ids:-0}" -ge 2 ] || fault "the recordings have no id"

"$osteomill" compare --seconds 0.3 --algorithm line-proxy --no-stability --quiet --push 2 --out d >out
"$osteomill" report c/*.h5 d/*.h5 --quiet --out e >out
grep -q "These recordings differ in burr_radius_mm" e/report.html || fault "the report does not mention the mix"
grep -q "<th>[^<]*seed" e/report.html && grep -q "<th>[^<]*hand.push (N)" e/report.html || fault "the differing setting has no column"
grep -q "the same bone" e/report.html && fault "the report claims the same bone"
exit 0
