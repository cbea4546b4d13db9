#!/usr/bin/env bash
# Closing the window offers a report if there is a recording without one, and asks nothing otherwise:
#   close_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
bash "$here/ball.sh" >ball.nrrd
# Operates the window with the given lines; a click on a missing control ends the program with an error.
window() {
  printf '%s\n' "wait 0.3" "$@" >actions
  rm -rf out
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 "$osteomill" simulate ball.nrrd --no-help --out out --script actions \
    >said 2>errors
}
record=("click Record" "wait 0.5" "click Stop recording" "wait 0.2")

window quit "wait 60" "say still-there" || fail "exit code $? without a recording"
! grep -q still-there said || fail "a question without a recording"

window "${record[@]}" quit "wait 0.3" "click Stay" "wait 0.3" "say stayed" quit "wait 0.3" \
  "click Close without" "wait 60" "say still-there" || fail "exit code $?"
grep -q stayed said || fail "it did not stay"
! grep -q still-there said || fail "it did not close without a report"
[ -s "$(ls out/*-recording.h5)" ] && [ -z "$(ls -d out/*-report 2>/dev/null)" ] || fail "not the recording alone"

# Closes the window while it records.
window "click Record" "wait 0.5" quit "wait 0.3" "click Make the report and close" "wait 90" "say still-there" ||
  fail "exit code $? with a report"
! grep -q still-there said || fail "it did not close after the report"
[ -s "$(ls out/*-report/summary.csv)" ] || fail "there is no report"
grep -q "^Report in out/" said || fail "the report is not named"

# A script's close does not ask, and the open question does not prevent SIGTERM from ending the program.
window "${record[@]}" close || fail "exit code $? of a script's close"
printf '%s\n' "wait 0.3" "${record[@]}" quit "wait 0.3" "say asked" "wait 90" >actions
xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 bash -c '
  "$1" simulate ball.nrrd --no-help --out out --script actions >said 2>errors & program=$!
  until grep -q asked said || ! kill -0 "$program"; do sleep 0.2; done
  kill -TERM "$program"; wait "$program"' - "$osteomill" && code=0 || code=$?
[ "$code" -eq 143 ] || fail "SIGTERM while asking ended with $code"
