#!/usr/bin/env bash
# Another scan is opened in the window; an invalid one is reported, and the session continues:
#   open_another_test.sh OSTEOMILL [SCAN]
# SCAN is opened too, if it exists.
set -euo pipefail
osteomill=$1 real=${2:-}
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
"$osteomill" save --out good.nrrd >/dev/null
echo "not a scan" >bad.nrrd

cat >actions <<END
wait 0.3
open bad.nrrd
settle
wait 0.3
say at-fault
click Close
wait 0.3
say goes-on
click Record
wait 0.5
open good.nrrd
settle
wait 0.5
say dropped
glide 640 420 0.3
key t
wheel 20 1.5
key space
wait 2
key space
say milling
key t
open no-such-scan
settle
wait 0.3
say not-there
click Close
wait 0.3
click Laboratory
click 2 surface-points
settle
click Save picture
wait 0.5
END
[ ! -e "$real" ] || printf '%s\n' "open $real" settle "wait 0.2" "click Discard" settle "wait 0.5" "say real" >>actions
echo close >>actions
xvfb-run -a -s "-screen 0 1280x800x24" timeout 200 "$osteomill" simulate builtin:tooth --no-help --out out --script actions \
  >said 2>errors || fail "exit code $?"
[ -z "${OSTEOMILL_PICTURES:-}" ] || cp out/*-picture.png "$OSTEOMILL_PICTURES"
cat said
line() { grep "^$1: " said; }
reading() { sed -nE "s/^$1:.* $2 ([0-9.]+) .*/\1/p" said; }
above() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > b) }'; }

# The dialogue names the file, and the tooth is still open.
grep -q "^dialogue: bad.nrrd: ." said || fail "the scan at fault is not named with a reason"
grep -q "^dialogue: no-such-scan: ." said || fail "the missing scan is not named with a reason"
line goes-on | grep -q "scan built-in tooth$" || fail "the session did not go on"
above "$(line goes-on | sed -E 's/.* ([0-9.]+) Hz.*/\1/')" 500 || fail "no ticks after a scan at fault"
# The next scan is open, can be milled, and stays open when a later one is invalid.
line dropped | grep -q "scan good.nrrd$" || fail "the good scan was not opened"
above "$(reading milling removed)" 0.1 || fail "the scan that was opened is not milled"
line not-there | grep -q "scan good.nrrd$" || fail "the session ended with a scan that is not there"
[ -s "$(ls out/*-picture.png)" ] || fail "no picture"
# The recording of the previous bone is complete.
"$osteomill" report out/*-recording.h5 --out report >/dev/null || fail "the recording cannot be read"
[ ! -e "$real" ] || line real | grep -q "scan $real$" || fail "the real scan was not opened"
