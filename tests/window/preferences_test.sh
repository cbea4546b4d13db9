#!/usr/bin/env bash
# Settings made in the window persist to the next start; options take precedence; a damaged file gives default settings and one
# line:
#   preferences_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
"$here/ball.sh" >ball.nrrd
"$here/ball.sh" 2 >small.nrrd
kept=state/osteomill/window.toml
window() {
  sed 's/ *;; */\n/g' >actions
  xvfb-run -a -s "-screen 0 ${screen:-1920x1080}x24" timeout 100 "$osteomill" simulate "$@" --no-help --out out --script actions \
    >said 2>errors || fail "exit code $?"
  [ -z "${OSTEOMILL_PICTURES:-}" ] || cp ./*.png "$OSTEOMILL_PICTURES" 2>/dev/null || true
}
shows() { value "$1" shown | grep -qF "[$2]" || fail "at $1 there is no '$2'"; }
hides() { ! value "$1" shown | grep -qF "[$2]" || fail "at $1 there is still '$2'"; }

for size in "1024 600" "1280 800" "3840 2160"; do
  screen=3840x2160
  rm -rf state
  window ball.nrrd <<END
resize $size ;; wait 0.3 ;; state first ;; click ghost ;; click sound ;; click Choose burr ;; wait 0.2 ;; click diamond 014 (1.4 mm) ;; settle
click Window ;; wait 0.2 ;; click Light ;; click Larger text ;; wait 0.3 ;; state set
glide 400 500 0 ;; press left ;; wait 0.1 ;; release left ;; wait 0.1
click View ;; wait 0.1 ;; click Laboratory ;; wait 0.1 ;; state left ;; screenshot preferences-left.png
close
END
  is first burr_mm 1.50; is set burr_mm 0.70; is set burr 1
  scale=$(value set ui_scale)
  [ "$(value first ui_scale)" != "$scale" ] || [ "$size" = "1024 600" ] || fail "text does not grow"
  window ball.nrrd <<END
settle ;; wait 0.3 ;; state again ;; screenshot preferences-again.png ;; click Window ;; wait 0.2 ;; click Dark ;; wait 0.2
close
END
  is again size "${size% *} x ${size#* }"; is again ui_scale "$scale"
  is again burr_mm 0.70; is again shaft_mm 0.42; is again burr 1
  hides again ghost; shows again stiffness; shows again sound
  ! grep -q window.toml errors || fail "there is a message about the stored settings"
  grep -q '^theme = "dark"' $kept || fail "a second start keeps nothing"
done
unset screen
grep -q '^ghost = false' $kept && grep -q '^sound = false' $kept && grep -q '^open-view = false' $kept ||
  fail "the file lacks the settings"

# Options take precedence for this start only; an exercise brings its burrs, and a bone that is too small its tool.
window ball.nrrd --burr-radius 2 --ui-scale 1 <<<"settle ;; wait 0.3 ;; state named ;; close"
is named burr_mm 2.00; is named ui_scale 1.00
window ball.nrrd <<<"settle ;; wait 0.3 ;; state unnamed ;; close"
is unnamed burr_mm 0.70; [ "$(value unnamed ui_scale)" != 1.00 ] || fail "an option is remembered"
sed -i 's/^burr-radius = .*/burr-radius = 4/' $kept
window small.nrrd <<<"settle ;; wait 0.3 ;; state small ;; close"
is small burr_mm 1.50
# On a screen that is too small, the window opens at its default place.
sed -i 's/^window-left = .*/window-left = 1500/; s/^burr-radius = .*/burr-radius = 0.7/' $kept
screen=1280x800 window ball.nrrd <<<"wait 0.3 ;; state moved ;; close"
is moved size "1280 x 800"

# A damaged or out-of-range file gives default settings and one line, and is rewritten correctly.
for damage in 'theme = "dark' 'theme = "green"' 'burr-radius = -1' 'text-scale = nan' 'ghost = "perhaps"' 'spindle-speed = [[]]'; do
  printf 'ghost = false\n%s\n' "$damage" >$kept
  window ball.nrrd <<<"settle ;; wait 0.2 ;; click View ;; wait 0.2 ;; click View ;; wait 0.1 ;; state damaged ;; close"
  is damaged burr_mm 1.50; is damaged ui_scale 1.00
  [ "$(grep -c window.toml errors)" -eq 1 ] && grep -q "^osteomill: .*window.toml: line [0-9]*: .*; using default window settings$" errors ||
    fail "'$damage' does not give one line"
  grep -q "^ghost = true" $kept || fail "after '$damage' the file is not whole"
done

# Two simultaneous windows leave a complete file from one of them; a killed one does not damage the file.
cat >both <<'END'
"$1" simulate ball.nrrd --no-help --script many >said 2>errors & one=$!
"$1" simulate ball.nrrd --no-help --script many >said2 2>>errors & two=$!
"$1" simulate ball.nrrd --no-help --script killed >said3 2>>errors & three=$!
wait "$one" "$two"
kill -KILL "$three"
END
{ echo "wait 0.3"; for n in 1 2 3 4 5 6; do printf '%s\n' "click ghost" "wait 0.7"; done; echo close; } >many
{ echo "wait 0.3"; for n in $(seq 60); do printf '%s\n' "click arrows" "wait 0.3"; done; } >killed
xvfb-run -a -s "-screen 0 1920x1080x24" timeout 100 bash both "$osteomill" 2>/dev/null || fail "exit code $?"
window ball.nrrd <<<"settle ;; state whole ;; close"
! grep -q window.toml errors || fail "two windows damage the file"
[ "$(ls state/osteomill | grep -c window)" -eq 1 ] || fail "there are $(ls state/osteomill)"
