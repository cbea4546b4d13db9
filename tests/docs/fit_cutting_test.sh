#!/usr/bin/env bash
# scripts/fit-cutting finds the published energy and exponent of human femur, holds a row out, and refuses files that are not
# tables.
#   fit_cutting_test.sh SOURCE_DIR
set -euo pipefail
fit=$1/scripts/fit-cutting
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fault() { echo "FAILED: $*"; exit 1; }
printf 'speed_rpm,radius_mm,area_mm2,feed_mm_s,torque_Nmm,use\n1000,1.6,8.0425,2,186.3,fit\n1250,1.6,8.0425,2,157.8,held out\n1500,1.6,8.0425,2,140.2,fit\n' >femur.csv
"$fit" femur.csv --edges 2 >out.txt
grep -q '^u1 = 1.297 J/mm3 at 48 um, m = 0.299, from 2 rows$' out.txt || fault "the femur: $(cat out.txt)"
grep -q '^row 2: .*law 159.3 (+1.0 %), held out$' out.txt || fault "the row held out: $(cat out.txt)"
sed 's/157.8/nan/' femur.csv >bad.csv
code=0; "$fit" bad.csv >out.txt 2>err.txt || code=$?
[ $code -eq 1 ] && grep -qx 'fit-cutting: bad.csv: line 3: torque_Nmm is not a positive number' err.txt || fault "a bad row: $(cat err.txt)"
head -n 2 femur.csv >one.csv
code=0; "$fit" one.csv >out.txt 2>err.txt || code=$?
[ $code -eq 1 ] && grep -q 'needs two rows' err.txt || fault "one row: $(cat err.txt)"

# The blind test distinguishes simulated raters who hear a difference from those who guess.
blind=$1/scripts/blind-test
"$blind" plan --raters 8 --seed 1 --out plan.csv
[ "$(wc -l <plan.csv)" -eq 129 ] || fault "the plan has $(wc -l <plan.csv) lines"
"$blind" simulate plan.csv --hears 0.9 --out heard.csv
"$blind" analyse heard.csv >out.txt
grep -q '^ABX: .* told apart$' out.txt || fault "raters who hear: $(cat out.txt)"
"$blind" simulate plan.csv --hears 0 --out guessed.csv
"$blind" analyse guessed.csv >out.txt
grep -q '^ABX: .* not told apart$' out.txt || fault "raters who guess: $(cat out.txt)"
sed -i '3s/,[AB]$/,C/' heard.csv
code=0; "$blind" analyse heard.csv >out.txt 2>err.txt || code=$?
[ $code -eq 1 ] && grep -q '^blind-test: heard.csv: line 3: ' err.txt || fault "a wrong answer: $(cat err.txt)"
