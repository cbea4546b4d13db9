#!/usr/bin/env bash
# While a large scan is loading, the user can cancel by button or key, open another scan, and close the window:
#   loading_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
"$here/ball.sh" >ball.nrrd
"$here/ball.sh" 4 >other.nrrd
# Bone below air: 480^3 voxels of one byte.
{ printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 480 480 480\nspacings: 0.1 0.1 0.1\nencoding: raw\n\n'
  head -c $((480 * 480 * 240)) /dev/zero | tr '\0' '\310'
  head -c $((480 * 480 * 240)) /dev/zero; } >large.nrrd
window() {
  sed 's/ *;; */\n/g' >actions
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 "$osteomill" simulate "$@" --no-help --script actions >said 2>errors
}

# While the first scan is loading: the window closes, and `state`, which needs a scan, prints nothing.
for way in quit "click Cancel" "key escape"; do
  printf '%s\n' at-once "wait 0.3" "screenshot opening.png" "$way" "wait 100" "state never" |
    window large.nrrd --iso 100 || fail "exit code $? after '$way'"
  [ ! -s said ] || fail "the scan was opened in spite of '$way'"
  [ -s opening.png ] || fail "nothing was drawn while it was opened"
done
[ -z "${OSTEOMILL_PICTURES:-}" ] || cp opening.png "$OSTEOMILL_PICTURES"
printf '%s\n' at-once "wait 0.3" "open other.nrrd" settle "wait 0.3" "state instead" close | window large.nrrd --iso 100 ||
  fail "exit code $?"
is instead scan other.nrrd

# While another scan is loading during milling.
window ball.nrrd <<'END' || fail "exit code $?"
wait 0.2 ;; open large.nrrd ;; wait 0.3 ;; click Cancel ;; wait 0.3 ;; state by-button
open large.nrrd ;; wait 0.3 ;; key escape ;; wait 0.3 ;; state by-key
open large.nrrd ;; wait 0.3 ;; open other.nrrd ;; settle ;; wait 0.3 ;; state instead
open large.nrrd ;; wait 0.3 ;; quit ;; wait 100 ;; state never
END
for moment in by-button by-key; do
  is $moment scan ball.nrrd
  is $moment message "Opening large.nrrd was cancelled"
  ! value $moment shown | grep -qF "[Cancel]" || fail "at $moment it still loads"
done
is instead scan other.nrrd
! value instead dialogue | grep -q . || fail "there is a message about the cancelled scan"
[ -z "$(value never scan)" ] || fail "it did not close"
