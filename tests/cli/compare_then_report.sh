#!/usr/bin/env bash
# A short comparison leaves all that it promises; the report made again from its recordings says the same; and the same
# seed gives the same numbers in everything but the time it took.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
# The columns of summary.csv that do not speak of time taken.
untimed() { cut -d, -f1-3,8-21 "$1"; }

"$osteomill" compare --seconds 1 --no-stability --out a >a.out
grep -q "a/report.html" a.out || fault "the report's path is not the output"
for file in report.html summary.csv figures/fig7_force.svg figures/fig7_force.png; do
  [ -s "a/$file" ] || fault "no $file"
done
[ "$(wc -l <a/summary.csv)" -eq 9 ] || fault "summary.csv should have a head and eight rows"
[ "$(ls a/*.h5 | wc -l)" -eq 8 ] || fault "there should be eight recordings"
grep -q "http://\|https://" <(sed 's|http://www.w3.org/[^"]*||g' a/report.html) && fault "report.html reaches for the network"

"$osteomill" report a/*.h5 --csv --out b >b.out
[ "$(head -n 2 a/summary.csv | tail -n 1 | cut -d, -f7)" != "" ] || fault "the ticks' CPU time was not measured"
[ "$(wc -l <b/point-shell-holding.csv)" -eq 1001 ] || fault "the CSV should have a head and a row a tick"
cmp a/summary.csv b/summary.csv || fault "the report made again says something else"

code=0
PATH=/nowhere "$osteomill" report a/*.h5 --csv --quiet --out g 2>g.err || code=$?
[ $code -eq 1 ] && grep -q "^osteomill: gnuplot: is not installed" g.err || fault "without gnuplot: $code, $(cat g.err)"
[ ! -e g ] || fault "a report that failed left $(find g)"

grep -q "No pictures of the bone" a/report.html && fault "pictures are missing"
__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null "$osteomill" compare --seconds 1 --no-stability --out e >e.out 2>e.err
[ "$(grep -c "no pictures of the bone are recorded: no OpenGL" e.err)" -eq 1 ] ||
  fault "without OpenGL one line should say so"
grep -q "No pictures of the bone: OpenGL could not be had" e/report.html || fault "the report misses pictures in silence"
[ ! -e e/figures/bone.png ] && [ -s a/figures/bone.png ] || fault "pictures where there are none"
diff <(untimed a/summary.csv) <(untimed e/summary.csv) || fault "the same seed gave other numbers"
"$osteomill" compare --seconds 1 --seed 2 --algorithm point-shell --out d >d.out
[ "$(wc -l <d/stability.csv)" -eq 13 ] && [ -s d/figures/stability.svg ] || fault "stability.csv should have a head and 12 rows"
[ "$(wc -l <d/summary.csv)" -eq 3 ] || fault "one algorithm, two phases"
"$osteomill" report d/*.h5 --quiet --out h >h.out
for file in report.html stability.csv; do cmp d/$file h/$file || fault "the report made again has another $file"; done
diff <(untimed a/summary.csv | grep point-shell) <(untimed d/summary.csv | grep point-shell) >/dev/null &&
  fault "another seed gave the same numbers"
"$osteomill" compare --seconds 0.3 --match-stiffness --no-stability --out f >f.out 2>f.err
grep -q "Stiffness is matched: .* felt as [0-9.]* N/mm" f/report.html || fault "the report should say that stiffness is matched"
# Algorithm 2 leaps over the stiffness of the softest.
grep -q "^osteomill: warning: left out: surface-points cannot be felt as" f.err || fault "who cannot be matched is not named: $(cat f.err)"
grep -q "Left out of this comparison: surface-points cannot be felt as" f/report.html || fault "the report misses an algorithm in silence"
[ "$(cut -d, -f1 f/summary.csv | sort -u | wc -l)" -eq 4 ] || fault "three algorithms should be compared"
grep -q "matched.felt_stiffness" f/report.html || fault "the settings should say as what stiffness is felt"
grep -q "Stiffness is not matched" a/report.html || fault "the report should say that stiffness is not matched"
find . -name '*.writing-*' -o -name '*.part.*' | grep -q . && fault "left a half-written file"
exit 0
