#!/usr/bin/env bash
# Open shows a dialog for files and folders, the window's own or the desktop's; the chosen scan is opened, an invalid one is
# reported in one line, and the series of a folder are offered:
#   open_test.sh OSTEOMILL PORTAL_STAND_IN [FOLDER_WITH_TWO_SERIES]
# Screenshots stay in OSTEOMILL_PICTURES if that is set.
set -euo pipefail
osteomill=$1 portal=$2 two_series=${3:-}
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run xdotool dbus-run-session
export HOME=$folder/home
shows() { value "$1" shown | grep -qF "[$2]" || fail "at $1 there is no '$2'"; }
hides() { ! value "$1" shown | grep -qF "[$2]" || fail "at $1 there is still '$2'"; }
window() {
  local screen=$1
  shift
  sed 's/ *;; */\n/g' >actions
  xvfb-run -a -s "-screen 0 ${screen}x24" timeout 150 "$osteomill" simulate "$@" --out out --script actions >said 2>errors ||
    fail "exit code $?"
  pictures
}

mkdir -p home scans/more scans/empty
"$here/ball.sh" >scans/ball.nrrd
"$here/ball.sh" 4 >scans/more/other.nrrd
echo "not a scan" >scans/bad.nrrd
echo "a note" >scans/notes.txt
"$here/ball.sh" >scans/.hidden.nrrd

# From the start page, at the smallest size: into a folder with Enter, up with Backspace, a file by its button; then another by
# keys, an invalid scan, Esc, a typed path, and a recent scan.
window 1024x600 --no-help <<END
wait 0.3 ;; click Open ;; wait 0.4 ;; click path ;; type $folder/scans ;; key enter ;; wait 0.3 ;; say listed ;; screenshot open-start.png
click more/ ;; wait 0.2 ;; key enter ;; wait 0.3 ;; screenshot open-more.png ;; key backspace ;; wait 0.3
click ball.nrrd ;; wait 0.2 ;; click Open selected ;; settle ;; wait 0.3 ;; state by-button ;; say opened
press control ;; key o ;; release control ;; wait 0.4 ;; state by-key-shown ;; screenshot open-milling.png
key t ;; key arrow-down ;; key arrow-down ;; key enter ;; wait 0.3 ;; key arrow-down ;; key enter ;; settle ;; wait 0.3 ;; state by-keys
click Open a folder ;; wait 0.3 ;; key escape ;; wait 0.2 ;; state cancelled
click Open ;; wait 0.3 ;; click path ;; type ../bad.nrrd ;; key enter ;; settle ;; wait 0.3 ;; state at-fault ;; click Close ;; wait 0.2 ;; state goes-on
click Open ;; wait 0.3 ;; click Up ;; wait 0.3 ;; state up ;; click Home ;; wait 0.3 ;; state home ;; screenshot open-home.png ;; click ball.nrrd ;; settle ;; wait 0.3 ;; state recent
click Open ;; wait 0.3 ;; click path ;; type $folder/scans/more ;; key enter ;; wait 0.3 ;; click Open this folder ;; settle ;; wait 0.3 ;; state this-folder
click Open ;; wait 0.3 ;; click path ;; type $folder/scans/empty ;; key enter ;; wait 0.3 ;; state empty ;; screenshot open-empty.png ;; click Cancel ;; wait 0.2
close
END
is by-button scan "$folder/scans/ball.nrrd"; is by-key-shown in_hand false
for label in more/ bad.nrrd ball.nrrd "Open selected" "Open this folder"; do shows by-key-shown "$label"; done
hides by-key-shown notes.txt; hides by-key-shown .hidden.nrrd
# The key T does not reach the window behind the dialog.
is by-keys scan "$folder/scans/more/other.nrrd"; is by-keys in_hand false
is cancelled scan "$folder/scans/more/other.nrrd"; hides cancelled "Open this folder"
value at-fault dialogue | grep -q "^$folder/scans/more/../bad.nrrd: .\|^$folder/scans/bad.nrrd: ." || fail "the scan at fault is not named"
is at-fault scan "$folder/scans/more/other.nrrd"; is goes-on scan "$folder/scans/more/other.nrrd"; is goes-on dialogue ""
shows up ball.nrrd; hides home bad.nrrd
is recent scan "$folder/scans/ball.nrrd"; is this-folder scan "$folder/scans/more"; hides empty more/

# A real double click opens a folder.
sed 's/ *;; */\n/g' >actions <<END
wait 0.3 ;; click Open ;; wait 0.4 ;; click path ;; type $folder/scans ;; key enter ;; wait 0.4 ;; state shown ;; display ;; say doubled ;; await doubled ;; state doubled ;; close
END
cat >hands <<END
set -euo pipefail
"$osteomill" simulate scans/ball.nrrd --no-help --script actions >said 2>errors & program=\$!
window=\$(xdotool search --sync --onlyvisible --name '^ball.nrrd - osteomill\$')
xdotool windowfocus "\$window"
until grep -q "^doubled: " said || ! kill -0 "\$program"; do sleep 0.05; done
xdotool mousemove --window "\$window" \$(sed -n 's|^shown\.place of more/=||p' said) sleep 0.5 click --repeat 2 --delay 170 1 sleep 1
touch doubled
wait "\$program"
END
xvfb-run -a -s "-screen 0 1280x800x24" timeout 60 bash hands || fail "exit code $?"
shows doubled other.nrrd; hides doubled bad.nrrd

# A folder with very many entries does not block the window: later clicks still work.
mkdir many && (cd many && seq -f "%06g.txt" 100000 | xargs touch && touch zebra.nrrd)
window 1280x800 scans/ball.nrrd --no-help <<END
wait 0.3 ;; click Open ;; wait 0.2 ;; click path ;; type $folder/many ;; key enter ;; wait 0.1 ;; state reading ;; wait 3 ;; state many ;; screenshot open-many.png ;; click Cancel ;; wait 0.1 ;; state after
close
END
shows many zebra.nrrd; hides after zebra.nrrd

# The desktop's own dialog, with a stand-in for its portal that answers immediately.
"$here/ball.sh" >"scans/ball 2 ä.nrrd"
portal_answers() { # answers...
  cat >with-portal <<END
set -euo pipefail
"$portal" "$folder/asked" $* & stand_in=\$!
trap 'kill \$stand_in' EXIT
until dbus-send --session --print-reply --dest=org.freedesktop.DBus / org.freedesktop.DBus.NameHasOwner string:org.freedesktop.portal.Desktop | grep -q true; do sleep 0.05; done
timeout 100 xvfb-run -a -s "-screen 0 1280x800x24" "$osteomill" simulate scans/ball.nrrd --no-help --out out --script actions >said 2>errors
END
  env -u DBUS_SESSION_BUS_ADDRESS dbus-run-session -- bash with-portal || fail "exit code $?"
}
sed 's/ *;; */\n/g' >actions <<END
wait 0.3 ;; click Open ;; wait 0.7 ;; settle ;; wait 0.3 ;; state chosen
click Open a folder ;; wait 0.7 ;; settle ;; wait 0.3 ;; state cancelled
click Open ;; wait 0.7 ;; state refused ;; click Cancel ;; wait 0.2 ;; close
END
portal_answers "'file://$folder/scans/ball%202%20%C3%A4.nrrd'" cancel refuse
is chosen scan "$folder/scans/ball 2 ä.nrrd"; hides chosen "Open this folder"
is cancelled scan "$folder/scans/ball 2 ä.nrrd"; hides cancelled "Open this folder"
shows refused "Open this folder"
# The dialog starts in the folder of the last opened scan.
printf 'file %s\nfolder %s\nfile %s\n' "$folder/scans/more" "$folder/scans" "$folder/scans" | diff - asked || fail "the portal got other requests"

[ -e "$two_series" ] || { echo "without the series, which are not on this machine"; exit 0; }
window 1024x600 scans/ball.nrrd --no-help <<END
wait 0.3 ;; open $two_series ;; settle ;; wait 0.3 ;; state offered ;; screenshot open-series.png ;; click Cancel ;; wait 0.3 ;; state declined
open $two_series ;; settle ;; wait 0.3 ;; key enter ;; settle ;; wait 0.5 ;; state first
open $two_series ;; settle ;; wait 0.3 ;; click $("$osteomill" info "$two_series" 2>/dev/null | sed -n 's/^series *//p' | sed -n 2p | sed -E 's/^([^:]*: [^"]*"[^"]*"), ([0-9]+) x ([0-9]+) x ([0-9]+), ([0-9.]+) x ([0-9.]+) x ([0-9.]+) mm.*/\1, \4 slices of \2 x \3, \7 mm thick/') ;; settle ;; wait 0.5 ;; click Record ;; wait 0.3 ;; click Stop recording ;; settle ;; state second
close
END
value offered dialogue | grep -q "holds 2 series" || fail "the series are not offered"
is declined scan "scans/ball.nrrd"; is declined dialogue ""
for moment in first second; do is $moment scan "$two_series"; done
"$osteomill" report "$(value second last_recording)" --out report >/dev/null || fail "the recording of the second series cannot be read"
