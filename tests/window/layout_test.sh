#!/usr/bin/env bash
# Text has the requested size if the window has room for it, also after resizing; the rest is reached by scrolling:
#   layout_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
"$here/ball.sh" >ball.nrrd
# Runs the window on a screen of this size.
window() {
  local screen=$1
  shift
  sed 's/ *;; */\n/g' >actions
  xvfb-run -a -s "-screen 0 ${screen}x24" timeout 100 "$osteomill" simulate ball.nrrd --no-help --out out --script actions \
    "$@" >said 2>errors || fail "exit code $?"
  [ -z "${OSTEOMILL_PICTURES:-}" ] || cp ./*.png "$OSTEOMILL_PICTURES"
}

# In both themes, no control is cut off, outside the window, covered, without a hint, or too low in contrast.
{
  printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 32 32 32\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
  awk 'BEGIN { for (v = 0; v < 32768; ++v) print int(v / 2048) + 1 }'
} >labels.nrrd
look() {
  local size=$1 name=$1-$2 theme=$3
  rm -rf state
  {
    echo "resize ${size/x/ } ;; wait 0.3 ;; click Window ;; wait 0.2 ;; click $theme ;; wait 0.2 ;; state menu ;; screenshot layout-$name-menu.png"
    echo "glide $((${size%x*} / 2)) $((${size#*x} - 40)) 0 ;; press left ;; wait 0.1 ;; release left ;; wait 0.1 ;; state start ;; screenshot layout-$name-start.png"
    echo "key f1 ;; wait 0.2 ;; state help ;; screenshot layout-$name-help.png ;; key f1"
    echo "click Choose burr ;; wait 0.3 ;; state burrs ;; screenshot layout-$name-burrs.png ;; click cutting 2 mm ;; settle"
    echo "click Record ;; wait 0.3 ;; state recording ;; click Stop recording ;; wait 0.2 ;; click Save picture ;; wait 0.4 ;; state saved"
    echo "click Milling ;; click View ;; click Record and save ;; click Cuts ;; wait 0.1 ;; click coronal ;; wait 0.3 ;; state cuts ;; screenshot layout-$name-cuts.png"
    echo "click coronal ;; click Cuts ;; click Bone ;; wait 0.2 ;; state bone ;; click Bone ;; click Laboratory ;; wait 0.3 ;; state laboratory"
    echo "screenshot layout-$name-laboratory.png ;; click Algorithm ;; click Tool ;; click Burr and drive ;; wait 0.2 ;; state drive ;; screenshot layout-$name-drive.png"
    echo "quit ;; wait 0.3 ;; state closing ;; screenshot layout-$name-closing.png ;; click Close without"
  } | window "$size" --ui-scale "$2" --labels labels.nrrd
  [ "$(grep -cE '\.(unexplained|cut_off|outside|covered|contrast)=' said)" -eq 55 ] || fail "the window was not checked at all moments"
  for moment in menu start help burrs recording saved cuts bone laboratory drive closing; do
    for fact in unexplained cut_off outside covered; do is $moment $fact ""; done
    awk -v c="$(value $moment contrast)" 'BEGIN { exit !(c >= 4.5) }' || fail "at $moment text has a contrast of $(value $moment contrast)"
  done
  is start size "${size%x*} x ${size#*x}"
}
look 1024x600 1 Light
is start ui_scale 1.00
look 1024x600 1.5 Dark
look 1280x800 1.5 Light
look 1920x1080 1.5 Dark
look 3840x2160 2 Light
is start ui_scale 2.00
look 3840x2160 3 Dark

# In a low window, scrolling reaches the end of the column.
rm -rf state
window 1024x600 <<'END'
wait 0.3 ;; state small ;; screenshot layout-1024x600.png ;; click Laboratory ;; wait 0.2
glide 100 400 0 ;; wheel -60 0.5 ;; wait 0.2 ;; click Burr and drive ;; wait 0.1 ;; wheel -60 0.5 ;; wait 0.2 ;; click turbine ;; settle ;; state scrolled
screenshot layout-scrolled.png
close
END
is small size "1024 x 600"; is small ui_scale 1.00
is scrolled handpiece 1

# With large text, many labels and help, the result message and the button that closes help are visible and do not overlap.
rm -rf state
window 1024x600 --ui-scale 2 --labels labels.nrrd <<'END'
wait 0.3 ;; key f1 ;; wait 0.2 ;; click Save picture ;; wait 0.3
state crowded ;; screenshot layout-crowded.png ;; key escape ;; wait 0.2 ;; state uncrowded
close
END
for label in "Start milling" "Open folder" Hide; do
  value crowded "place of $label" | awk '{ exit !(NF == 2 && $1 < 1024 && $2 < 600) }' || fail "'$label' is not in the window"
done
[ $(($(value crowded "place of Open folder" | cut -d' ' -f2) - $(value crowded "place of Start milling" | cut -d' ' -f2))) -gt 100 ] ||
  fail "help and what was saved cover each other"
value uncrowded shown | grep -qF "[label colours]" || fail "the labels do not come back after help"

rm -rf state
window 1920x1080 --ui-scale 2 <<'END'
wait 0.3 ;; state twice ;; screenshot layout-twice.png
resize 1024 600 ;; wait 0.3 ;; state little-room ;; screenshot layout-little-room.png
resize 1900 1000 ;; wait 0.3 ;; state room-again
click Window ;; wait 0.2 ;; click Smaller text ;; wait 0.2 ;; state smaller
close
END
is twice size "1920 x 1080"; is twice ui_scale 2.00
is little-room size "1024 x 600"
awk -v s="$(value little-room ui_scale)" 'BEGIN { exit !(s > 1 && s < 1.5) }' || fail "text does not fit into 1024 x 600"
is room-again ui_scale 2.00; is smaller ui_scale 1.75

# The menu that changes the text size is visible at any size.
rm -rf state
window 1280x800 --ui-scale 1.25 <<'END'
wait 0.3 ;; screenshot layout-larger.png ;; click Window ;; wait 0.2 ;; click Smaller text ;; wait 0.2 ;; state usual
close
END
is usual ui_scale 1.00

for wrong in 0 100 large; do
  "$osteomill" simulate --ui-scale $wrong >said 2>errors && fail "--ui-scale $wrong is accepted"
  [ $? -eq 2 ] || fail "--ui-scale $wrong has another exit code"
done
