#!/usr/bin/env bash
# A comparison with several hands: its table has every trial, the first seed's recordings and summary agree with it, and neither the
# number of threads nor the first seed changes a number.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
# Prints the rows of study.csv of one seed and its own tremor, without the columns of times.
untimed() { awk -F, -v OFS=, -v seed="$2" 'NR > 1 && $5 == 0 && (seed == "" || $1 == seed) {for (n = 9; n <= 12; ++n) $n = ""; for (n = 27; n <= 29; ++n) $n = ""; print}' "$1"; }

"$osteomill" compare --algorithm line-proxy --algorithm point-shell --seconds 2 --seeds 3 --seed 4 --no-stability --threads 2 --out a >a.out
grep -q "a/report.html" a.out || fault "the report's path is not the output"
[ "$(wc -l <a/study.csv)" -eq 21 ] || fault "study.csv should have a head, 3 x 4 rows, and 2 x 4 of other tremors"
[ "$(wc -l <a/summary.csv)" -eq 5 ] || fault "summary.csv should have a head and the first seed's 4 rows"
diff <(awk -F, '$1 == 4 && $5 == 0' a/study.csv | cut -d, -f6-) <(tail -n +2 a/summary.csv) || fault "the summary is not the first seed's"
[ "$(ls a/*.h5 | wc -l)" -eq 4 ] || fault "there should be 4 recordings, of the first seed"
[ "$(untimed a/study.csv "" | cut -d, -f2 | sort -u | wc -l)" -eq 3 ] || fault "there should be three hands"
for text in "Study over 3 hands" "no difference can be significant"; do
  grep -q "$text" a/report.html || fault "report.html does not say: $text"
done
[ "$(untimed a/study.csv "" | cut -d, -f14 | grep -c "[1-9]")" -gt 10 ] || fault "hardly a trial touched the bone"
diff <(cut -d, -f1-3 a/study.csv | sort -u) <(cut -d, -f1-3 a/one-hole.csv | sort -u) || fault "other hands held in one hole"
[ ! -e a/stability.csv ] || fault "--no-stability measured stability"

"$osteomill" report a/*.h5 --out again >again.out
cmp a/summary.csv again/summary.csv || fault "the report made from recordings differs"
for file in report.html study.csv one-hole.csv; do cmp a/$file again/$file || fault "the report made again has another $file"; done

"$osteomill" compare --algorithm point-shell --seconds 2 --seeds 2 --seed 5 --no-stability --threads 1 --out b >b.out
for seed in 5 6; do
  diff <(untimed a/study.csv $seed | grep point-shell) <(untimed b/study.csv $seed) ||
    fault "seed $seed depends on the number of threads or on its position"
done
exit 0
