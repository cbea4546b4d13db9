#!/usr/bin/env bash
# A recorded exercise is played back, and milling continues from one of its ticks, with real clicks, in two window sizes:
#   playback_test.sh OSTEOMILL_DRIVER OSTEOMILL EXERCISES
set -euo pipefail
driver=$1 osteomill=$2 exercises=$3
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool
mkdir -p state/osteomill
echo "help-seen = true" >state/osteomill/window.toml
less() { awk -v a="$(value "$1" "$3")" -v b="$(value "$2" "$3")" 'BEGIN { exit !(a < b) }' || fail "$3 is '$(value "$1" "$3")' at $1 and '$(value "$2" "$3")' at $2"; }

actions() {
  local middle=$(($1 / 2)) target=$(($2 * 43 / 100))
  sed 's/ *;; */\n/g' <<END
settle ;; wait 0.5 ;; glide $middle $target 0.2 ;; key b ;; settle ;; key t ;; wheel 30 1 ;; key space ;; wait 1 ;; glide $((middle + 30)) $target 1 ;; wheel 10 0.5 ;; wait 1
key space ;; wait 0.3 ;; key space ;; glide $((middle + 45)) $target 1 ;; wheel 5 0.5 ;; wait 1 ;; key space ;; wait 0.3 ;; key t ;; click round 1.5 mm ;; settle ;; click Undo cut ;; settle ;; wait 0.5 ;; click Finish ;; settle ;; wait 0.3 ;; state results
click Play it back ;; settle ;; click Discard ;; wait 0.5 ;; settle ;; wait 0.3 ;; state opened ;; screenshot opened.png
say played ;; await played ;; state played
say paused ;; await paused ;; wait 0.5 ;; state paused ;; wait 0.5 ;; state still
say jumped ;; await jumped ;; settle ;; wait 0.3 ;; state jumped ;; screenshot jumped.png
say stepped ;; await stepped ;; state stepped ;; click < tick ;; state back
say turned ;; await turned ;; state turned ;; screenshot turned.png
click recorded camera ;; wait 0.2 ;; state followed
click 16x ;; click Play ;; wait 3 ;; state fast ;; click Whole ;; click ghost ;; click ghost ;; click arrows ;; click arrows ;; click see through ;; click see through
click 0.1x ;; click 4x ;; click 1x
say chosen ;; await chosen ;; settle ;; state chosen
say again ;; await again ;; settle ;; wait 1 ;; state again ;; screenshot again.png ;; click Finish ;; settle ;; wait 0.3 ;; state finished ;; close
END
}
cat >hands <<'END'
set -euo pipefail
driver=$1
"$driver" simulate --script actions --device mouse --exercise "$2/layers.toml" --trainee "Trainee 7" --ui-scale 1 --out out --no-help >said 2>errors &
program=$!
until window=$(xdotool search --name osteomill 2>/dev/null | tail -1) && [ -n "$window" ]; do kill -0 "$program" || exit 1; sleep 0.1; done
# Waits until the window awaits the file $1; real events follow, and time for some frames.
when() { until grep -q "^$1\(: \|$\)" said || ! kill -0 "$program"; do sleep 0.05; done; }
place() { sed -n "s/^opened\.place of $1=//p" said; }
send() { when "$1"; xdotool "${@:2}"; sleep 1; touch "$1"; }
at() { send "$1" mousemove --window "$window" "$2" "$3" sleep 0.3 click 1; }
click() { when "$1"; at "$1" $(place "$2"); }
click played Play
send paused key --delay 0 space
# Clicks on the time line relative to its middle; half of its length is known.
when jumped
time=($(place ""))
half=$((time[0] - 80))
at jumped $((time[0] + half / 2)) ${time[1]}
click stepped 'tick >'
send turned mousemove --window "$window" $3 200 sleep 0.3 mousedown 1 sleep 0.2 mousemove_relative 40 10 sleep 0.2 mousemove_relative 40 10 sleep 0.2 mouseup 1
at chosen $((time[0] - half / 6)) ${time[1]}
click again 'Again from here'
wait "$program"
END

# work SIZE
work() {
  rm -rf out said played paused jumped stepped turned chosen again
  touch said
  actions "${1%x*}" "${1#*x}" >actions
  local code=0
  xvfb-run -a -s "-screen 0 $1x24" timeout 280 bash hands "$driver" "$exercises" $((${1%x*} / 2 + 100)) || code=$?
  for picture in *.png; do
    [ -z "${OSTEOMILL_PICTURES:-}" ] || cp "$picture" "$OSTEOMILL_PICTURES/playback-${1%x*}-$picture"
  done
  [ $code -eq 0 ] || fail "exit code $code"
  local first branch
  first=$(value results last_recording)
  for fact in unexplained cut_off outside covered; do is opened $fact ""; is fast $fact ""; done
  is opened tick 0; is opened playing false; is opened recorded_camera true
  value opened verdict | grep -q "^Replay is bit-identical: [0-9]* ticks$" || fail "$(value opened verdict)"
  [ "$(value opened bone)" = 0 ] || fail "the bone is not as scanned at first"
  is played playing true; is paused playing false; less opened played tick; less opened paused tick
  [ "$(value still tick)" = "$(value paused tick)" ] || fail "it plays on after a pause"
  less paused jumped time_s; less jumped stepped tick; is back tick "$(value jumped tick)"
  [ "$(value jumped bone)" != 0 ] || fail "the bone was not milled"
  is turned recorded_camera false; is followed recorded_camera true; is followed towards_viewer "$(value jumped towards_viewer)"
  [ "$(value turned towards_viewer)" != "$(value jumped towards_viewer)" ] || fail "the view does not turn"
  is fast playing false
  # Milling continues with the bone shown at the chosen tick.
  branch=$(value finished last_recording)
  [ -n "$first" ] && [ -n "$branch" ] && [ "$first" != "$branch" ] || fail "'$first', '$branch'"
  is again recording true; is again exercise "A trench in layered bone"; is again spindle false
  "$osteomill" replay "$branch" --verify --quiet | grep -q ^same || fail "the branch does not replay"
  "$osteomill" debrief "$branch" --out branch --quiet >told
  grep -q "^continues $first at $(value chosen time_s | cut -c1-5)" told || fail "$(cat told)"
  /usr/bin/python3 - "$first" "$branch" "$(value chosen tick)" "$(value chosen bone)" "$(value fast bone)" <<'CHECK' || fail "the branch does not begin where it was chosen"
import sys, h5py
tick = int(sys.argv[3])
with h5py.File(sys.argv[1]) as a, h5py.File(sys.argv[2]) as b:
    s = b["settings"].attrs
    assert s["from.ticks"] == tick + 1, s["from.ticks"]
    assert b["sessions/0"].attrs["removed_mm3"] == a["columns/removed_mm3"][tick]
    dt = b["columns/time_s"][0] - a["columns/time_s"][tick]
    assert 0 < dt < 0.0011, dt
    assert b["bone_hash/hash"][0] == int(sys.argv[4]), (b["bone_hash/hash"][0], sys.argv[4])
    assert a["bone_hash/hash"][-1] == int(sys.argv[5]), "the end"
    force = (b["columns/force_x_N"][:] ** 2 + b["columns/force_y_N"][:] ** 2 + b["columns/force_z_N"][:] ** 2) ** 0.5
    assert force[0] == 0 and abs(force[1:] - force[:-1]).max() < 0.4, force.max()
CHECK
}
work 1280x800
work 1024x600
