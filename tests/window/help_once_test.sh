#!/usr/bin/env bash
# The help page opens by itself only at the first start:
#   help_once_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
bash "$here/ball.sh" >ball.nrrd
fail() { echo "FAILED: $1"; cat errors; exit 1; }
# Operates the window with the actions on standard input; a click on a missing control ends the program with an error.
window() {
  cat >actions
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 "$osteomill" simulate ball.nrrd "$@" --script actions >said 2>errors
}

window --no-help <<<"close" || fail "exit code $?"
grep -qx "help-seen = false .*" state/osteomill/window.toml || fail "a page that was not shown counts as seen"
printf '%s\n' "wait 0.3" "click Start milling" close | window || fail "no help the first time"
grep -qx "help-seen = true .*" state/osteomill/window.toml || fail "the state does not record that it was shown"
printf '%s\n' "wait 0.3" "state second" "key f1" "wait 0.3" "click Start milling" close | window ||
  fail "F1 does not bring the help back"
grep -qx "second.help=false" said || fail "help the second time too"

# If the state cannot be written, the page opens at every start, without a message.
: >no-folder
export XDG_STATE_HOME=$folder/no-folder
for _ in 1 2; do
  printf '%s\n' "wait 0.3" "click Start milling" close | window || fail "no help without a folder for the state"
  ! grep -q no-folder errors || fail "there is a message about the state that cannot be written"
done
