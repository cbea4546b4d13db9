#!/usr/bin/env bash
# Pieces of bone are selected, removed, restored and removed again with real clicks and keys, in three window sizes; the recording
# replays bit for bit; the autosaved bone of a killed program lacks them:
#   pieces_test.sh OSTEOMILL_DRIVER OSTEOMILL EXERCISES SHARED
set -euo pipefail
driver=$1 osteomill=$2 exercises=$3 shared=$4
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool
between() { awk -v x="$(value "$1" "$2")" -v a="$3" -v b="$4" 'BEGIN { exit !(x + 0 > a && x + 0 < b) }' || fail "at $1, $2 is $(value "$1" "$2")"; }
keep_pictures() { [ -z "${OSTEOMILL_PICTURES:-}" ] || for picture in *.png; do mv "$picture" "$OSTEOMILL_PICTURES/pieces-$1-$picture"; done; }
"$here/balls.sh" >balls.nrrd

# --- By real events, recorded ---------------------------------------------------------------------------------------
cat >hands <<'END'
set -euo pipefail
"$1" simulate balls.nrrd --iso 700 --ui-scale $2 --no-help --out out --script actions >said 2>errors &
program=$!
until window=$(xdotool search --name balls.nrrd 2>/dev/null | tail -1) && [ -n "$window" ]; do kill -0 "$program" || exit 1; sleep 0.1; done
# Waits until the window awaits the file $1; real events follow, and time for some frames.
when() { until grep -q "^$1\(: \|$\)" said || ! kill -0 "$program"; do sleep 0.05; done; }
send() { when "$1"; xdotool "${@:2}"; sleep 1; touch "$1"; }
click() { when "$1"; send "$1" mousemove --window "$window" $(sed -n "s/^$2\.place of $3=//p" said) sleep 0.3 click 1; }
# Prints the pixel at the large ball's centre; the view from above has the patient's left on the left.
ball() {
  when chosen
  awk -v focus="$(sed -n 's/^start\.focus=//p' said)" -v away="$(sed -n 's/^start\.distance_mm=//p' said)" -v size="$3" 'BEGIN {
    split(focus, f, " "); split(size, s, "x"); scale = s[2] / (2 * 0.266 * (away - 7.75 + f[3]))
    printf "%d %d", s[1] / 2 + (f[1] - 6) * scale, s[2] / 2 + (7.75 - f[2]) * scale }'
}
send chosen mousemove --window "$window" $(ball "$@") sleep 0.3 click 3
click kept chosen "Keep only this piece"
send undone key --delay 0 ctrl+z
# The modifier is released in the frame of the press.
send all-back keydown ctrl sleep 0.2 keydown --delay 0 z keyup --delay 0 ctrl keyup --delay 0 z
send redone key --delay 0 ctrl+y
send milled-again key --delay 0 ctrl+shift+z
wait "$program"
END

work() {
  local size=$1 scale=$2
  rm -rf out said chosen kept undone all-back redone milled-again
  touch said
  sed 's/ *;; */\n/g' >actions <<'END'
resize SIZE ;; wait 0.5 ;; settle ;; click S ;; settle ;; wait 0.3 ;; state start ;; wait 1 ;; click Record ;; settle ;; wait 0.3
say chosen ;; await chosen ;; settle ;; wait 0.3 ;; state chosen ;; screenshot chosen.png
say kept ;; await kept ;; settle ;; wait 0.3 ;; state kept ;; screenshot kept.png
click S ;; click Whole ;; glide MIDDLE 0 ;; key b ;; settle ;; key t ;; wheel 26 0.6 ;; key space ;; wait 0.6 ;; key space ;; key t ;; wait 0.3 ;; state milled
say undone ;; await undone ;; settle ;; wait 0.2 ;; state undone
say all-back ;; await all-back ;; settle ;; wait 0.2 ;; state all-back
say redone ;; await redone ;; settle ;; wait 0.2 ;; state redone
say milled-again ;; await milled-again ;; settle ;; wait 0.5 ;; state milled-again ;; screenshot milled.png
click Stop recording ;; settle ;; click Save scan ;; settle ;; wait 0.2 ;; state end ;; close
END
  sed -i "s/SIZE/${size/x/ }/; s/MIDDLE/$((${size%x*} / 2)) $((${size#*x} / 2))/" actions
  local code=0
  xvfb-run -a -s "-screen 0 ${size}x24" timeout 200 bash hands "$driver" "$scale" "$size" || code=$?
  keep_pictures "$size"
  [ $code -eq 0 ] || fail "exit code $code"
  for fact in unexplained cut_off outside; do is chosen $fact ""; done
  is start size "${size%x*} x ${size#*x}"; is chosen pieces 3; between chosen piece_mm3 500 548; is chosen cuts 0
  value chosen shown | grep -qF "[Remove pieces below]" || fail "there is no menu"
  ! value kept shown | grep -qF "[Keep only this piece]" || fail "the menu stays"
  is kept cuts 1; is kept removed_mm3 0.000; is kept unsaved true
  between start bone_size_mm 17 19; between kept bone_size_mm 9 11
  between milled removed_mm3 0.01 100; is milled cuts 2
  is undone removed_mm3 0.000; is undone cuts 1; is undone undone_cuts 1; between undone bone_size_mm 9 11
  is all-back cuts 0; is all-back undone_cuts 2; is all-back unsaved false; between all-back bone_size_mm 17 19
  is redone cuts 1; is redone removed_mm3 0.000; between redone bone_size_mm 9 11
  is milled-again cuts 2; is milled-again undone_cuts 0; is milled-again removed_mm3 "$(value milled removed_mm3)"
  local recording
  recording=$(value end last_recording)
  "$osteomill" replay "$recording" --verify --quiet | grep -q "^same: " || fail "does not replay"
  # The window's bone equals the recording's, and has one piece.
  "$osteomill" save balls.nrrd --after "$recording" --out after.nrrd --quiet
  cmp after.nrrd out/*-milled.nrrd || fail "the recording has another bone than the window"
  "$osteomill" info out/*-milled.nrrd --iso 700 --json --quiet | tr -d ' \n' | grep -q '"pieces":{"count":1,' || fail "more than one piece is saved"
  rm after.nrrd
}
work 1280x800 1
work 1024x600 1
work 3840x2160 2

# --- A program that ends by a fault leaves the bone without what was removed ----------------------------------------
window() {
  sed 's/ *;; */\n/g' >actions
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 200 "$driver" simulate "$@" --no-help --ui-scale 1 --out out --script actions >said 2>errors
}
rm -rf out
window balls.nrrd --iso 700 <<END || true
wait 0.3 ;; settle ;; click S ;; settle ;; click Choose piece ;; glide 640 430 0.1 ;; press left ;; release left ;; settle ;; wait 0.2 ;; state chosen
click Remove this piece ;; settle ;; wait 2 ;; state removed ;; click Nothing of that name
END
between chosen piece_mm3 500 548; is removed cuts 1; between removed bone_size_mm 2 5
window balls.nrrd <<END || fail "exit code $?"
wait 0.3 ;; click Open it ;; settle ;; wait 0.5 ;; state opened ;; click Reset bone ;; wait 0.2 ;; click Discard ;; settle ;; wait 0.3 ;; state reset ;; close
END
is opened cuts 1; is opened unsaved true; is opened removed_mm3 0.000; between opened bone_size_mm 2 5
is reset cuts 0; between reset bone_size_mm 17 19

# --- Not in an exercise, with a word why ------------------------------------------------------------------------------
window --exercise "$exercises/layers.toml" <<END || fail "exit code $?"
wait 0.3 ;; settle ;; wait 0.5 ;; glide 640 344 0.1 ;; press right ;; release right ;; wait 0.2 ;; state asked ;; close
END
value asked message | grep -q "exercise" || fail "no message gives the reason: '$(value asked message)'"
! value asked shown | grep -qF "[Remove this piece]" || fail "pieces can be removed in an exercise"

# --- The table of a scanned head ------------------------------------------------------------------------------------------
cranium=$shared/cranium/cranium_256x256x108_i16.nrrd
[ -r "$cranium" ] || { echo "The cranium is not tried: there is no $cranium"; exit 0; }
rm -rf out
window "$cranium" <<END || fail "exit code $?"
wait 0.5 ;; settle ;; wait 1 ;; screenshot whole.png ;; state whole ;; glide 560 430 0.1 ;; press right ;; release right ;; settle ;; wait 1 ;; state chosen ;; screenshot chosen.png
click Keep only this piece ;; settle ;; wait 1 ;; state kept ;; click Whole ;; settle ;; wait 2 ;; screenshot kept.png
glide 560 430 0.1 ;; press right ;; release right ;; settle ;; wait 0.5 ;; state alone ;; screenshot alone.png ;; key escape ;; click Save scan ;; settle ;; state saved ;; close
END
keep_pictures cranium
"$osteomill" info "$cranium" --json --quiet | tr -d ' \n' | sed -E 's/.*"pieces":\{"count":([0-9]+).*/\1/' >count
is chosen pieces "$(cat count)"; is alone pieces 1; is alone piece_mm3 "$(value chosen piece_mm3)"
# Prints the pieces that the command line finds.
pieces() { "$osteomill" info "$@" --iso "$(value chosen isovalue)" --json --quiet | tr -d ' \n' | sed -nE 's/.*"pieces":(\{[^}]*\}).*/\1/p'; }
[ -n "$(pieces "$cranium")" ] && [ "$(pieces "$cranium" --keep-largest)" = "$(pieces out/*-milled.nrrd)" ] ||
  fail "the window keeps $(pieces out/*-milled.nrrd), --keep-largest $(pieces "$cranium" --keep-largest)"
