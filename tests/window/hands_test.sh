#!/usr/bin/env bash
# Input without a wheel, with the display's own events: the pointer does not stop at the screen's edge while it holds the tool, W
# and S push the tool in and pull it back while the left button mills, and the pointer is released with Esc, by a dialogue, or when
# another window gets the keyboard:
#   hands_test.sh OSTEOMILL GAMEPAD_STAND_IN
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool
"$here/ball.sh" >ball.nrrd

moments=(taken pushed pulled milled beyond hovered escaped retaken dialogue closed unfocused)
{
  printf '%s\n' "wait 0.3" "state start" display
  for moment in "${moments[@]}"; do
    printf '%s\n' "say $moment" "await $moment" "state $moment"
    case $moment in taken | milled) echo "screenshot hands-$moment.png" ;; esac
  done
  echo close
} >actions
cat >hands <<'END'
set -euo pipefail
elsewhere=$(xdotool search --maxdepth 0 . 2>/dev/null || true)
"$1" simulate ball.nrrd --no-help --script actions >said 2>errors & program=$!
window=$(xdotool search --sync --onlyvisible --name '^ball.nrrd - osteomill$')
xdotool windowfocus "$window" mousemove --window "$window" 640 400
send() {
  until grep -q "^$1: " said || ! kill -0 "$program"; do sleep 0.05; done
  xdotool "${@:2}"
  sleep 0.5
  xdotool getmouselocation >"$1.pointer"
  touch "$1"
}
send taken key --delay 0 b sleep 0.8 key --delay 0 t sleep 0.2
send pushed mousedown 1 sleep 0.2 keydown w sleep 0.8 keyup w
send pulled keydown s sleep 0.3 keyup s
send milled keydown w sleep 2 keyup w sleep 0.3 mouseup 1
pull=$(printf 'mousemove_relative -- 40 0 sleep 0.02 %.0s' {1..60})
send beyond keydown s sleep 2 keyup s $pull
# Over the left column, which a captured pointer does not hover.
send hovered $(sed 's/ 40 0/ -40 0/g' <<<"$pull") click 4 sleep 0.2
send escaped key Escape
send retaken key --delay 0 t
send dialogue key --delay 0 ctrl+o
send closed key Escape sleep 0.3
send unfocused windowfocus "$elsewhere"
wait "$program"
END
screen=${OSTEOMILL_SCREEN:-1280x800}
xvfb-run -a -s "-screen 0 ${screen}x24" timeout 100 bash hands "$osteomill" || fail "exit code $?"
pictures

less() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }' || fail "$3: $1 is not below $2"; }
is start in_hand false; is taken in_hand true
is pushed spindle true; is pulled spindle true; is milled spindle false
less "$(part pushed target_seen 3)" "$(part taken target_seen 3)" "W while the button mills"
less "$(part pushed target_seen 3)" "$(part pulled target_seen 3)" "S while the button mills"
less "$(value taken removed_mm3)" "$(value milled removed_mm3)" "the bone that is removed"
# 2400 pixels to the right, in a window 1280 wide.
less 1500 "$(part beyond tool_px 1)" "the tool beyond the screen's edge"
less "$(part hovered tool_px 1)" "$(part beyond tool_px 1)" "the way back"
less "$(part hovered target_seen 3)" "$(part beyond target_seen 3)" "the wheel above the column"
is hovered distance_mm "$(value beyond distance_mm)"
is escaped in_hand false; is retaken in_hand true; is closed in_hand true; is unfocused in_hand false
# The pointer returns to where it was captured, also while a dialogue is open.
for moment in escaped dialogue unfocused; do
  grep -q "^x:640 y:400 " $moment.pointer || fail "at $moment the pointer is at $(cat $moment.pointer)"
done

# A game controller moves the tool as soon as it is connected: pushes it in while A mills, releases it with B, and undoes the cut
# with X.
pad() { echo "$*" >pad.new && mv pad.new pad; }
rest="0 0 0 0 -1 -1"
pad $rest 0 0 0
{
  printf '%s\n' "wait 0.3" "state at-rest"
  for moment in aside in-bone released held let-go undone; do
    [ $moment != held ] || echo "key t"
    printf '%s\n' "say $moment" "await $moment" "settle" "state $moment"
  done
  echo close
} >actions
cat >hands <<'END'
set -euo pipefail
send() {
  until grep -q "^$1: " said || ! kill -0 "$program"; do sleep 0.05; done
  echo "${*:3}" >pad.new && mv pad.new pad
  sleep "$2"
  touch "$1"
}
LD_PRELOAD=$2 OSTEOMILL_GAMEPAD=pad "$1" simulate ball.nrrd --no-help --script actions >said 2>errors & program=$!
until grep -q "^aside: " said; do sleep 0.05; done
send aside 0.5 0.6 0 0.5 0 -1 -1 0 0 0
send in-bone 3 -0.4 0 0 0 -1 1 1 0 0
send released 0.5 0 0 0 0 -1 -1 0 0 0
send held 0.3 0 0 0 0 -1 -1 0 0 0
send let-go 0.5 0 0 0 0 -1 -1 0 1 0
send undone 0.5 0 0 0 0 -1 -1 0 0 1
wait "$program"
END
rm -f said
xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 bash hands "$osteomill" "$2" || fail "exit code $?"
less "$(part at-rest target_seen 1)" "$(part aside target_seen 1)" "the left stick to the right"
[ "$(value at-rest target_turned)" != "$(value aside target_turned)" ] || fail "the right stick does not turn"
is in-bone spindle true; is released spindle false
less 0.1 "$(value in-bone removed_mm3)" "the bone that a controller mills"
is held in_hand true; is let-go in_hand false
is undone cuts 0; is undone removed_mm3 0.000
