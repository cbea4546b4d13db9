#!/usr/bin/env bash
# An exercise from the start page to its results with real clicks and keys, in two window sizes:
#   exercise_test.sh OSTEOMILL_DRIVER OSTEOMILL EXERCISES
set -euo pipefail
driver=$1 osteomill=$2 exercises=$3
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool
mkdir -p state/osteomill
echo "help-seen = true" >state/osteomill/window.toml
# Replaces the desktop's browser and logs the page to open.
mkdir bin
printf '#!/bin/sh\necho "$1" >%s/opened\n' "$folder" >bin/xdg-open
chmod +x bin/xdg-open
export PATH=$folder/bin:$PATH

actions() {
  local middle=$(($1 / 2)) target=$(($2 * 43 / 100))
  sed 's/ *;; */\n/g' <<END
wait 1 ;; screenshot start.png ;; click your name (optional) ;; type Trainee 7 ;; wait 0.2
say chosen ;; await chosen ;; settle ;; wait 0.5 ;; state begun ;; screenshot work.png
say hidden ;; await hidden ;; state hidden ;; screenshot hidden.png
say shown ;; await shown ;; state shown
click beat (M) ;; state silent ;; click beat (M)
click guidance (G) ;; state unguided ;; click guidance (G)
click round 1.5 mm ;; settle ;; state thin ;; click diamond ;; settle ;; click diamond ;; settle ;; click round 2 mm ;; settle ;; state thick
glide $middle $target 0.2 ;; key b ;; settle ;; key t ;; wheel 30 1 ;; key space ;; wait 1 ;; glide $((middle + 30)) $target 1 ;; wheel 10 0.5 ;; wait 1
key space ;; key t ;; wait 0.3 ;; state milled ;; screenshot milled.png
say finished ;; await finished ;; settle ;; wait 0.3 ;; state results ;; screenshot results.png
click All measures ;; wait 0.2 ;; screenshot measures.png
click Open page ;; wait 0.5
click Back to the bone ;; wait 0.2 ;; state back ;; click Work on ;; settle ;; wait 0.3 ;; state again
click Stop recording ;; settle ;; wait 0.3 ;; state stopped ;; click Try again ;; wait 0.2 ;; settle ;; click Discard ;; wait 1 ;; settle ;; wait 0.5 ;; state anew
click Finish ;; settle ;; wait 0.3 ;; click Start page ;; wait 0.5 ;; screenshot start-again.png
click Built-in tooth ;; wait 0.5 ;; settle ;; state tooth ;; close
END
}
cat >hands <<'END'
set -euo pipefail
"$1" simulate --out out --script actions >said 2>errors & program=$!
window=$(xdotool search --sync --onlyvisible --name '^osteomill$')
xdotool windowfocus "$window"
# Sends events once the window waits for them, and leaves it time for some frames.
send() {
  until grep -q "^$1\(: \|$\)" said || ! kill -0 "$program"; do sleep 0.05; done
  xdotool "${@:2}"
  sleep 2
  touch "$1"
}
place() { sed -n "s/^$1\.place of $2=//p" said; }
# The exercises' pictures are in a row, in the order of file names; the third is the trench.
send chosen mousemove --window "$window" $2 150 sleep 0.3 click 1
send hidden key --delay 0 g
send shown key --delay 0 g key --delay 0 m key --delay 0 m
send finished mousemove --window "$window" $(place begun Finish) sleep 0.3 click 1
wait "$program"
END

# work SIZE X: X is the position of the third picture.
work() {
  rm -rf out opened said chosen hidden shown finished
  touch said
  actions "${1%x*}" "${1#*x}" >actions
  xvfb-run -a -s "-screen 0 $1x24" timeout 280 bash hands "$driver" "$2" || fail "exit code $?"
  for picture in *.png; do
    [ -z "${OSTEOMILL_PICTURES:-}" ] || cp "$picture" "$OSTEOMILL_PICTURES/exercise-${1%x*}-$picture"
  done
  is begun exercise "A trench in layered bone"
  is begun step 1; is begun guidance true; is begun recording true
  is hidden guidance false; is hidden distance ""; is shown guidance true
  for moment in begun results back; do
    for fact in unexplained cut_off outside covered; do is $moment $fact ""; done
  done
  is silent beats_per_s 0.00; is unguided guidance false
  is thin burr_mm 0.75; is thick burr_mm 1.00
  awk -v a="$(value begun step_percent)" -v b="$(value milled step_percent)" 'BEGIN { exit !(b > a) }' || fail "the step does not go on"
  value milled distance | grep -qE '^deep layer [0-9.]+ mm$' || fail "no distance"
  [ "$(value results results)" -gt 40 ] && is results recording false
  [ "$(value stopped results)" -gt 40 ] && is stopped recording false
  is back results 0; is again recording true; is anew step_percent 0.0; is tooth scan "built-in tooth"
  [ "$(cat opened)" = "$(value results debrief)/debrief.html" ] && [ -s "$(cat opened)" ] || fail "the page was not opened"
  grep -q 'id="page-data"' "$(cat opened)" || fail "the page is empty"
  local debrief recording
  debrief=$(value results debrief)/debrief.csv
  recording=$(ls out/*-exercise.h5 | head -1)
  "$osteomill" debrief "$recording" --out again --quiet >/dev/null
  cmp "$debrief" again/debrief.csv || fail "debrief finds other values"
  "$osteomill" replay "$recording" --verify --quiet | grep -q ^same || fail "it does not replay"
  grep -q "^hidden_cutting_percent,[0-9]" "$debrief" && grep -q "^view_changes,[0-9]" "$debrief" || fail "no view was measured"
  /usr/bin/python3 - "$recording" "$exercises" <<'CHECK' || fail "the recording lacks something"
import sys, h5py
with h5py.File(sys.argv[1]) as f:
    s = {k: v.decode() if isinstance(v, bytes) else v for k, v in f["settings"].attrs.items()}
    assert s["exercise.title"] == "A trench in layered bone" and s["exercise.trainee"] == "Trainee 7", s
    t, d = f["columns/time_s"][:], f["columns/no_go_distance_mm"][:]
    assert (d == d).all() and d.min() > 0, d
    v = f["view"]
    seconds = v["time_s"][-1] - v["time_s"][0]
    assert set(v["guidance"][:]) == {0, 1} and set(v["step"][:]) == {1}, (set(v["guidance"][:]), set(v["step"][:]))
    assert len(v["time_s"]) > 5 and len(v["time_s"]) <= 31 * seconds + 2, (len(v["time_s"]), seconds)
CHECK
}
work 1280x800 750
work 1024x600 600

# A window closed before the end asks whether to measure; if not, it names the recording.
closing() {
  rm -rf out
  printf '%s\n' "wait 0.5" settle "wait 0.5" "$@" >actions
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 120 "$driver" simulate --exercise "$exercises/layers.toml" --out out --script actions \
    >said 2>errors || fail "exit code $? of a window that is closed"
  ! grep -q still-there said || fail "it did not close"
}
closing quit "wait 0.3" "screenshot closing.png" "click Stay" "wait 0.3" "say stayed" quit "wait 0.3" \
  "click Measure and close" "wait 60" "say still-there"
grep -q ^stayed said && grep -q "debrief/debrief.csv$" said && [ -s out/*-debrief/debrief.csv ] || fail "it was not measured"
closing quit "wait 0.3" "click Close without" "wait 60" "say still-there"
grep -q "^Its results: osteomill debrief out/.*-exercise.h5" said && [ -s out/*-exercise.h5 ] || fail "the recording is not named"
[ -z "${OSTEOMILL_PICTURES:-}" ] || cp closing.png "$OSTEOMILL_PICTURES/exercise-closing.png"
