#!/usr/bin/env bash
# Real input events: keys tapped faster than the frame rate, a click, a drag and the wheel:
#   real_keys_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool
"$here/ball.sh" >ball.nrrd

# The window's script pauses at each `await` until the real events have been sent.
moments=(taps paused chord tapped-thrice clicked flicked dragged wheeled brought turbine diamond worn)
{
  printf '%s\n' "wait 0.3" "state start"
  for moment in "${moments[@]}"; do
    [ $moment != turbine ] || printf '%s\n' "click Laboratory" "wait 0.2" "click Algorithm" "click Tool" "click Burr and drive" "wait 0.5" "state opened"
    printf '%s\n' "say $moment" "await $moment"
    case $moment in turbine | diamond | worn) printf '%s\n' settle "wait 0.5" ;; esac
    echo "state $moment"
  done
  echo close
} >actions
cat >hands <<'END'
set -euo pipefail
"$1" simulate ball.nrrd --no-help --script actions >said 2>errors & program=$!
window=$(xdotool search --sync --onlyvisible --name '^ball.nrrd - osteomill$')
xdotool windowfocus "$window" mousemove --window "$window" 640 700
# Sends events once the window waits for them, and leaves it time for some frames.
send() {
  until grep -q "^$1: " said || ! kill -0 "$program"; do sleep 0.05; done
  xdotool "${@:2}"
  sleep 0.5
  touch "$1"
}
# Down and up without delay, so both usually arrive in the same frame.
send taps key --delay 0 t key --delay 0 space key --delay 0 F1
send paused key --delay 0 p
send chord key --delay 0 t key --delay 0 ctrl+p
# GLFW merges two presses of a key within a millisecond.
send tapped-thrice key --delay 0 p sleep 0.003 key --delay 0 p sleep 0.003 key --delay 0 p
send clicked mousemove --window "$window" $(sed -n 's/^start\.place of pause=//p' said) click 1
# Motion before a button press does not drag.
send flicked mousemove --window "$window" 640 700 sleep 0.3 mousemove --window "$window" 940 600 mousedown 1 sleep 0.3 mouseup 1
send dragged mousemove --window "$window" 640 700 mousedown 1 sleep 0.7 mousemove --window "$window" 670 710 sleep 0.7 mousemove --window "$window" 700 720 sleep 0.7 mouseup 1
send wheeled click 4 click 4
send brought mousemove --window "$window" 640 400 key --delay 0 b
# Prints the position of a control in the window at a moment.
place() { sed -n "s/^$1\.place of $2=//p" said; }
until grep -q "^opened\.place of wear=" said || ! kill -0 "$program"; do sleep 0.05; done
send turbine mousemove --window "$window" $(place opened turbine) sleep 0.3 click 1
send diamond mousemove --window "$window" $(place opened diamond) sleep 0.3 click 1
send worn mousemove --window "$window" $(place opened wear) sleep 0.3 mousedown 1 sleep 0.5 mouseup 1 sleep 0.3 key --delay 0 space
wait "$program"
END
xvfb-run -a -s "-screen 0 1280x800x24" timeout 200 bash hands "$osteomill" || fail "exit code $?"

for fact in in_hand spindle help; do is start $fact false; is taps $fact true; done
is taps paused false; is paused paused true
is chord in_hand false; is chord paused false
is tapped-thrice paused true
is clicked paused false
is flicked towards_viewer "$(value clicked towards_viewer)"
[ "$(value clicked towards_viewer)" != "$(value dragged towards_viewer)" ] || fail "a drag does not turn the view"
[ "$(value clicked distance_mm)" = "$(value dragged distance_mm)" ] || fail "a drag of the left button zooms"
[ "$(value dragged distance_mm)" != "$(value wheeled distance_mm)" ] || fail "the wheel does not zoom"
[ "$(value wheeled tool_px)" != "640 400" ] && is brought tool_px "640 400"
# A handpiece sets its own speed, and the actual speed rises to it.
is opened handpiece 0; is turbine handpiece 1; is turbine rpm 400000
is turbine burr 0; is diamond burr 1; is diamond wear 0
[ "$(value worn wear)" != 0 ] || fail "a click on the slider does not wear the burr"
awk -v rpm="$(value worn true_rpm)" 'BEGIN { exit !(rpm > 0.95 * 400000 && rpm <= 400000) }' ||
  fail "the turbine runs at $(value worn true_rpm) rpm"
