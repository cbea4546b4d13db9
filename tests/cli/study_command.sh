#!/usr/bin/env bash
# A study from its file to its report: it runs the listed trials, neither the number of threads nor of slices changes a row, missing
# slices run again, and every fault gives one line before a trial runs.
set -euo pipefail
osteomill=$1 ball=$2 studies=$3
. "$(dirname "${BASH_SOURCE[0]}")/study_rows.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
bash "$ball" >ball.nrrd
cat >study.toml <<TOML
title = "Push and hand"
[fixed]
scan = "ball.nrrd"
iso = 750
burr-radius = 1
shaft-radius = 0.5
seconds = 1
[grid]
algorithm = ["line-proxy", "point-shell"]
[latin-hypercube]
trials = 4
push = { from = 0.5, to = 2 }
device-mass = { from = 0.1, to = 1, log = true }
[[map]]
title = "Force"
x = "push"
y = "device-mass"
colour = "force_mean_N"
TOML
"$osteomill" study study.toml --list >list
[ "$(head -n 1 list)" = "trial,push (N),device-mass (kg),algorithm" ] || fault "the list begins: $(head -n 1 list)"
[ "$(wc -l <list)" -eq 9 ] || fault "the list should have a head and 8 trials"
"$osteomill" study study.toml --estimate | grep -q "^8 trials; three of them took [0-9.e-]*, [0-9.e-]* and [0-9.e-]* s of CPU$" ||
  fault "no estimate"
[ "$(ls)" = "$(printf 'ball.nrrd\nlist\nstudy.toml')" ] || fault "--list and --estimate left something: $(ls)"

"$osteomill" study study.toml --out a --threads 1 --slices 1 --quiet >/dev/null
rows a >expected
diff <(tail -n +2 list) <(tail -n +2 expected | cut -d, -f1-4 | uniq) || fault "other trials were run than listed"
[ "$(tail -n +2 expected | cut -d, -f1,5 | sort -u | wc -l)" -eq 16 ] || fault "each trial has a row for either phase"
for file in report.html figures/map_1.svg figures/map_1.png; do [ -s "a/report/$file" ] || fault "no $file"; done
grep -q "8 of 8 trials (100 %)" a/report/report.html || fault "the report does not state its number of trials"
# One second is too short for a hole of 3 mm; the page states this first.
short=$(tail -n +2 a/report/trials.csv | grep -v ',$' | cut -d, -f1 | sort -u | wc -l)
[ "$short" -gt 0 ] || fault "every trial did all of its test"
grep -q "$short of the 8 trials did not do all of their test" a/report/report.html || fault "the page does not report trials that did not complete the test"
grep -q "In hatched cells" a/report/report.html || fault "the map does not mark them"
if [ "$short" -eq 8 ]; then
  ! "$osteomill" study a --report --drop-unreached 2>err || fault "a report without trials was written"
  grep -q "did all of its test" err || fault "$(cat err)"
else
  "$osteomill" study a --report --drop-unreached >/dev/null
  [ "$(tail -n +2 a/report/trials.csv | cut -d, -f1 | sort -u | wc -l)" -eq $((8 - short)) ] || fault "unreached trials were not dropped"
  ! grep -q "In hatched cells" a/report/report.html || fault "dropped trials are hatched"
  "$osteomill" study a --report >/dev/null
fi
"$osteomill" study study.toml --out b --threads 2 --slices 3 --quiet >/dev/null
rows b | cmp - expected || fault "threads or slices change the rows"
rm b/slice-1.h5
truncate -s 1000 b/slice-2.h5
kept=$(stat -c %i.%Y b/slice-0.h5)
"$osteomill" study b --status | grep -q "^3 of 8 trials are done (37.5 %), 1 of 3 slices$" || fault "$("$osteomill" study b --status)"
"$osteomill" study b --resume --quiet >/dev/null
[ "$kept" = "$(stat -c %i.%Y b/slice-0.h5)" ] || fault "a finished slice was run again"
rows b | cmp - expected || fault "resumed rows differ"

refused() {  # TEXT COMMAND...
  local text=$1 code=0
  shift
  "$@" >out 2>err || code=$?
  [ $code -eq 1 ] && [ "$(wc -l <err)" -eq 1 ] && grep -qE "$text" err || fault "exit code $code, expected one line with '$text': $(cat err)"
}
"$osteomill" study study.toml --list >/dev/null
variant() { sed "$1" study.toml >variant.toml; }
variant 's/^seconds/secnods/'
refused "^osteomill: variant.toml: line 7: .*secnods.*seconds\?$" "$osteomill" study variant.toml --out c
variant 's/^\[grid\]/[grids]/'
refused "line 8: .*grids.*grid\?" "$osteomill" study variant.toml --out c
variant 's/from = 0.5/from = -1/'
refused "variant.toml: trial [0-9]+: push: -0.*positive" "$osteomill" study variant.toml --out c
variant 's/^algorithm.*/algorithm = []/'
refused "line 9: algorithm .*no values" "$osteomill" study variant.toml --out c
variant 's/point-shell/pointshell/'
refused "algorithm pointshell.*point-shell" "$osteomill" study variant.toml --out c
variant 's/force_mean_N/force_maen_N/'
refused "force_maen_N.*force_mean_N" "$osteomill" study variant.toml --out c
variant 's/ball.nrrd/none.nrrd/'
refused "none.nrrd: no such file" "$osteomill" study variant.toml --out c
variant 's/^seconds.*/hand-stiffness = 1\ndraw-hand = true/'
refused "trial 0: .*draw-hand .*hand-stiffness" "$osteomill" study variant.toml --out c
variant 's/from = 0.5, to = 2/from = 0.5, to = inf/'
refused "^osteomill: variant.toml: line [0-9]+: push .*0.5 to inf" "$osteomill" study variant.toml --out c
variant 's/^seconds.*/entry = "99,99,99"/'
refused "^osteomill: variant.toml: trial 0: .*entry" "$osteomill" study variant.toml --out c
variant 's/^burr-radius.*/burr-radius = 3e5/; 1s/^/test = "wall"\n/; s/force_mean_N/felt_N_per_mm/'
refused "^osteomill: variant.toml: trial 0: burr-radius: 300000 .*0.01 to 100" "$osteomill" study variant.toml --out c
variant 's/point-shell/barrier-shell/; s/^seconds.*/stiffness = 1e300/'
refused "^osteomill: variant.toml: trial 0: .*stiffness .*1e\+300" "$osteomill" study variant.toml --out c
mkfifo pipe.toml
refused "^osteomill: pipe.toml: .*regular file" timeout 20 "$osteomill" study pipe.toml --out c
variant 's/^trials = .*/trials = 6000000/'
refused "^osteomill: variant.toml: .*10000000 trials" "$osteomill" study variant.toml --out c
[ ! -e c ] || fault "a refused study left a folder"
variant 's/seconds = 1/seconds = 0.2/'
refused "^osteomill: a: .*another study" "$osteomill" study variant.toml --out a
refused "a: .*already.*study a --resume" "$osteomill" study study.toml --out a
bash "$ball" 4.5 >ball.nrrd
rm b/slice-0.h5
refused "ball.nrrd: .*changed" "$osteomill" study b --resume
bash "$ball" >ball.nrrd
(cat "$osteomill"; echo) >other && chmod +x other
refused "^osteomill: b: .*another build" ./other study b --resume
echo >>b/study.toml
refused "study.toml: .*changed" "$osteomill" study b --resume
refused "ball.nrrd: .*(folder|line)" "$osteomill" study ball.nrrd --status
refused "folder of a study.*study.h5" "$osteomill" study . --status

# Poor settings cause one warning. An axis with nearly equal values still gets a range.
cat >poor.toml <<TOML
test = "wall"
[fixed]
algorithm = "line-proxy"
[[list]]
stiffness = 0.01
device-mass = 0.2
[[list]]
stiffness = 0.010000000001
device-mass = 0.3
[[map]]
x = "stiffness"
y = "device-mass"
colour = "rule_N_per_mm"
TOML
"$osteomill" study poor.toml --out d >/dev/null 2>err || fault "$(cat err)"
[ "$(grep -c "warning" err)" -eq 1 ] && grep -q "poor.toml: trial 0: line-proxy: a stiffness of 0.01 N/mm .* soft.*; 2 trials have such warnings$" err || fault "$(cat err)"
"$osteomill" study d --report --quiet >/dev/null || fault "a map whose values nearly agree"
[ -s d/report/figures/map_1.svg ] || fault "no map"

# The project's studies can be read and listed.
for study in "$studies"/*.toml; do
  [ "$(basename "$study")" = findings-200.toml ] || "$osteomill" study "$study" --list | tail -n 1 | grep -q "^[0-9][0-9]*," || fault "$study"
done
exit 0
