#!/usr/bin/env bash
# Milled bone is not discarded without a question, nor lost when the program is killed:
#   unsaved_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
"$here/ball.sh" >ball.nrrd
"$here/ball.sh" 4 >other.nrrd
# Operates the window with the lines of standard input; ";;" separates actions in a line.
window() {
  { echo "controls $folder/controls"; sed 's/ *;; */\n/g'; } >actions
  [ -z "${OSTEOMILL_PICTURES:-}" ] || sed -i "s|^screenshot |&$OSTEOMILL_PICTURES/|" actions
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 60 "$osteomill" simulate ball.nrrd --no-help --out out "$@" \
    --script actions >said 2>errors
}
shows() { value "$1" shown | grep -qF "[$2]" || fail "at $1 there is no '$2'"; }
hides() { ! value "$1" shown | grep -qF "[$2]" || fail "at $1 there is still '$2'"; }
autosaves() { find state -name '*.h5' 2>/dev/null | wc -l; }
mill="wait 0.2 ;; click S ;; glide 640 750 0 ;; key b ;; wait 0.2 ;; key t ;; wheel 26 0.6 ;; key space ;; wait 0.6 ;; key space ;; key t ;; wait 0.2"

# --- Closing, resetting, another scan ---------------------------------------------------------------------------
window <<END || fail "exit code $?"
wait 0.2 ;; state untouched ;; $mill ;; state milled
key space ;; wait 0.2 ;; state turning ;; quit ;; wait 0.2 ;; state asking ;; screenshot unsaved-1-asking.png
key t ;; key space ;; key p ;; wait 0.1 ;; state keys
key escape ;; wait 0.2 ;; state stayed
open no-such-scan ;; settle ;; wait 0.2 ;; state complaint ;; quit ;; wait 0.2 ;; key enter ;; wait 0.2
state after-it ;; click Cancel ;; wait 0.2
click Reset bone ;; wait 0.2 ;; state reset-asking ;; click Cancel ;; wait 0.2 ;; state not-reset
open other.nrrd ;; settle ;; wait 0.2 ;; state open-asking ;; click Cancel ;; wait 0.2 ;; state not-opened
open other.nrrd ;; settle ;; wait 0.2 ;; click Discard ;; settle ;; wait 0.3 ;; state opened
$mill ;; state milled-again ;; click Save scan ;; settle ;; wait 0.2 ;; state saved
$mill ;; click Reset bone ;; wait 0.2 ;; click Discard ;; settle ;; wait 0.2 ;; state reset
$mill ;; state milled-last ;; quit ;; wait 0.2 ;; state asked-last ;; key enter ;; wait 40 ;; state still-there
END
is untouched unsaved false; is milled unsaved true; is milled removed_mm3 "$(value milled removed_mm3)"
is turning spindle true; is asking spindle false; shows asking Save; shows asking Discard; hides stayed Discard
is keys in_hand false; is keys spindle false; is keys paused false
shows complaint Close; hides complaint Discard; shows after-it Discard; hides after-it Close
shows reset-asking Discard; hides not-reset Discard; is not-reset cuts "$(value stayed cuts)"
shows open-asking Discard; is not-opened scan ball.nrrd; is not-opened unsaved true
is opened scan other.nrrd; is opened unsaved false
is milled-again unsaved true; is saved unsaved false
is reset removed_mm3 0.000; is reset unsaved false; is milled-last unsaved true
[ -z "$(value still-there scan)" ] || fail "it did not close after saving"
[ "$(ls out/*-milled.nrrd | wc -l)" -eq 2 ] || fail "there should be two saved scans"
[ "$(autosaves)" -eq 0 ] || fail "an autosave of saved or discarded bone is left"

# --- Killed ---------------------------------------------------------------------------------------------------
# Another window open at the same time does not offer the autosave.
printf '%s\n' "${mill// ;; /$'\n'}" "state killed" "wait 40" >killed-actions
printf '%s\n' "wait 0.2" "state beside" close >beside-actions
cat >both <<'END'
"$1" simulate ball.nrrd --no-help --script killed-actions >said-killed 2>errors & program=$!
until grep -q "^killed.size" said-killed || ! kill -0 "$program"; do sleep 0.05; done
"$1" simulate ball.nrrd --no-help --script beside-actions >said 2>>errors
kill -KILL "$program"
# The lock is released when the program has ended.
wait "$program" || true
END
xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 bash both "$osteomill" 2>/dev/null || fail "exit code $?"
is beside scan ball.nrrd; hides beside "Open it"
[ "$(autosaves)" -eq 1 ] || fail "a killed program leaves $(autosaves) autosaves"

window <<<"wait 0.2 ;; screenshot unsaved-2-left.png ;; click Later ;; settle ;; wait 0.3 ;; state later ;; close" || fail "not offered"
is later removed_mm3 0.000
window --iso 500 <<<"wait 0.1 ;; key escape ;; settle ;; wait 0.3 ;; state escaped ;; close" || fail "not offered again"
is escaped removed_mm3 0.000; is escaped isovalue 500
# Restored with its own isovalue despite --iso; and killed again.
window --iso 500 <<END || true
wait 0.1 ;; key enter ;; settle ;; wait 0.5 ;; state restored ;; screenshot unsaved-3-restored.png
click Undo cut ;; settle ;; wait 0.2 ;; state undone ;; $mill ;; quit ;; wait 0.2 ;; key escape ;; wait 0.1 ;; state end ;; wait 0.2
click Nothing of that name
END
removed=$(sed -n 's/^killed\.removed_mm3=//p' said-killed)
awk -v kept="$(value restored removed_mm3)" -v all="$removed" 'BEGIN { exit !(kept > 0 && kept <= all) }' ||
  fail "of $removed mm³, $(value restored removed_mm3) are kept"
is restored unsaved true; is restored cuts 1; is restored isovalue "$(sed -n 's/^killed\.isovalue=//p' said-killed)"
! value restored message | grep -q "not kept" || fail "the restored bone is not autosaved: $(value restored message)"
is undone removed_mm3 0.000; is undone unsaved false
# The program was killed and its scan is gone, so the start continues with the named scan.
mv ball.nrrd moved.nrrd
cp other.nrrd ball.nrrd
window <<<"wait 0.1 ;; click Open it ;; settle ;; wait 0.3 ;; state changed ;; click Close ;; wait 0.1 ;; close" || fail "exit code $?"
value changed dialogue | grep -q "ball.nrrd: has changed since" || fail "milled bone went into another scan"
is changed removed_mm3 0.000
[ "$(autosaves)" -eq 1 ] || fail "the autosave that could not be opened is gone"
window <<<"wait 0.1 ;; click Delete it ;; settle ;; wait 0.3 ;; state deleted ;; close" || fail "exit code $?"
[ -z "$(ls -A state/osteomill/autosave)" ] || fail "there is still $(ls -A state/osteomill/autosave)"
window <<<"wait 0.3 ;; state nothing ;; close" || fail "exit code $?"
hides nothing "Open it"

# If autosaves cannot be written, a message reports it, and all else works.
: >no-folder
XDG_STATE_HOME=$folder/no-folder window <<<"$mill ;; state no-folder ;; close" || fail "exit code $?"
value no-folder message | grep -q "cannot be autosaved" || fail "no message reports that there is no autosave"

for label in Save Discard Cancel "Open it" "Delete it" Later; do
  grep -qx "worked $label" controls || fail "'$label' was never chosen"
done
