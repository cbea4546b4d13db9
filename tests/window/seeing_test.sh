#!/usr/bin/env bash
# View aids: following the burr, the loupe, measuring with real clicks on a ball of known radius, and setting the grey values of
# cuts by dragging:
#   seeing_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool
"$here/ball.sh" >ball.nrrd

holds() { awk -v a="$1" -v b="$2" "BEGIN { exit !($3) }" || fail "$4: $1, $2"; }

# Runs at the smallest and the default size; clicks the bone's left and right edges along the view's axes.
work() { # WIDTH HEIGHT
  local middle="$(($1 / 2)) $(($2 / 2))"
  moments=(first second cleared)
  {
    sed 's/ *;; */\n/g' <<END
wait 0.3 ;; click Milling ;; click Record and save ;; click Look closer ;; click Cuts ;; click A ;; key b ;; settle ;; state start
key r ;; wait 0.1 ;; say first ;; await first ;; say second ;; await second ;; wait 0.2 ;; state measured ;; screenshot seeing-$1-measured.png
click Copy points ;; click Save points ;; wait 0.3 ;; state saved
click measure (R) ;; click Clear points ;; wait 0.1 ;; state cleared
key v ;; wait 2 ;; state followed
hold arrow-right 0.8 ;; wait 2 ;; state followed-on ;; click follow the burr (V) ;; wait 0.2 ;; hold arrow-left 0.8 ;; wait 1 ;; state left-behind
key l ;; wait 0.5 ;; state magnified ;; screenshot seeing-$1-loupe.png ;; drag power 60 ;; wait 0.3 ;; screenshot seeing-$1-power.png ;; click loupe (L)
click sagittal ;; settle ;; wait 0.3 ;; click L ;; wait 0.3 ;; screenshot seeing-$1-grey-before.png ;; state grey
glide $middle 0 ;; say dragged ;; await dragged ;; wait 0.3 ;; state dragged ;; screenshot seeing-$1-grey-after.png
click Reset grey ;; wait 0.2 ;; state reset
close
END
  } >actions
  rm -rf first second dragged state
  cat >hands <<END
set -euo pipefail
"$osteomill" simulate ball.nrrd --no-help --out out-$1 --script actions >said 2>errors & program=\$!
window=\$(xdotool search --sync --onlyvisible --name '^ball.nrrd - osteomill\$')
xdotool windowfocus "\$window"
send() {
  until grep -q "^\$1: " said || ! kill -0 "\$program"; do sleep 0.05; done
  xdotool "\${@:2}"
  sleep 0.5
  touch "\$1"
}
# Clicks beside the burr on both sides.
send first mousemove --window "\$window" $(($1 / 2 - 90)) $(($2 / 2)) sleep 0.3 click 1 sleep 0.3
send second mousemove --window "\$window" $(($1 / 2 + 90)) $(($2 / 2)) sleep 0.3 click 1 sleep 0.3
send dragged mousemove --window "\$window" $middle sleep 0.3 keydown ctrl mousedown 3 sleep 0.3 mousemove_relative -- 40 0 sleep 0.2 mousemove_relative -- 40 20 sleep 0.3 mouseup 3 keyup ctrl
wait "\$program"
END
  xvfb-run -a -s "-screen 0 $1x$2x24" timeout 150 bash hands || fail "exit code $?"
  pictures
  # Both points lie on the ball of 5 mm around (7.75, 7.75, 7.75), and the displayed distance is theirs.
  for point in "2 3 4" "6 7 8"; do
    set -- $1 $2 $point
    awk -v x="$(part measured landmarks $3)" -v y="$(part measured landmarks $4)" -v z="${5}" -v w="$(part measured landmarks $5 | tr -d ';')" \
      'BEGIN { r = sqrt((x - 7.75)^2 + (y - 7.75)^2 + (w - 7.75)^2); exit !(r > 4.95 && r < 5.05) }' ||
      fail "a point at $(value measured landmarks) is not on the ball"
  done
  awk -v p="$(value measured landmarks | tr -d ';')" -v d="$(value measured distance_mm_of_two)" 'BEGIN { split(p, c, " ")
    e = sqrt((c[2] - c[6])^2 + (c[3] - c[7])^2 + (c[4] - c[8])^2); exit !(d > 1 && (d - e)^2 < 1e-5) }' ||
    fail "the distance is $(value measured distance_mm_of_two)"
  # Expected distance, from the intersections of the two pixels' rays with the ball.
  awk -v h="$2" -v f="$(value start focus)" -v d="$(value start distance_mm)" -v measured="$(value measured distance_mm_of_two)" 'BEGIN {
    split(f, focus, " ")
    for (side = -1; side <= 1; side += 2) {
      s = side * 90 * 2 * sin(0.26) / cos(0.26) / h
      ex = focus[1] - 7.75; ey = focus[2] - d - 7.75; ez = focus[3] - 7.75
      b = ex * s + ey; c = ex^2 + ey^2 + ez^2 - 25; a = s^2 + 1
      t = (-b - sqrt(b^2 - a * c)) / a
      x[side] = ex + t * s; y[side] = ey + t
    }
    expected = sqrt((x[1] - x[-1])^2 + (y[1] - y[-1])^2)
    exit !((measured / expected - 1)^2 < 1e-4) }' || fail "the distance is $(value measured distance_mm_of_two)"
  # In the front view, points at the same height in the picture have the same height in the patient's frame.
  awk -v p="$(value measured landmarks | tr -d ';')" 'BEGIN { split(p, c, " "); exit !((c[4] - c[8])^2 < 0.01) }' || fail "$(value measured landmarks)"
  python3 - out-$1/*-landmarks.mrk.json "$(value measured landmarks)" <<'END' || fail "the landmarks file differs"
import json, sys
marks = json.load(open(sys.argv[1]))["markups"][0]["controlPoints"]
words = sys.argv[2].replace(";", "").split()
for n, mark in enumerate(marks):
    assert mark["label"] == words[4 * n] == f"P{n + 1}"
    assert all(abs(a - float(b)) < 1e-3 for a, b in zip(mark["position"], words[4 * n + 1:4 * n + 4]))
assert len(marks) == 2
END
  is cleared landmarks ""
  for moment in followed followed-on; do
    awk -v x="$(part $moment tool_px 1)" -v y="$(part $moment tool_px 2)" -v a=$(($1 / 2)) -v b=$(($2 / 2)) \
      'BEGIN { exit !((x - a)^2 + (y - b)^2 < 16) }' || fail "at $moment the burr is at $(value $moment tool_px)"
  done
  [ "$(value followed tool_W)" != "$(value followed-on tool_W)" ] || fail "the tool did not move"
  [ "$(value followed-on focus)" = "$(value left-behind focus)" ] || fail "the view still follows"
  holds "$(part left-behind tool_px 1)" $(($1 / 2)) 'a < b - 20' "the burr that is not followed"
  holds "$(part grey grey 2)" "$(part dragged grey 2)" 'b > a * 1.1 && b < a * 1.25' "the grey window after 80 pixels to the right"
  holds "$(part grey grey 1)" "$(part dragged grey 1)" 'b < a' "the grey level after 20 pixels down"
  is reset grey "$(value grey grey)"
}
work 1024 600
work 1280 800
