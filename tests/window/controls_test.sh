#!/usr/bin/env bash
# Operates every control of the window and checks its effect; reports controls that no line here uses, or that have no effect:
#   controls_test.sh OSTEOMILL
# Skipped (exit 77) without Xvfb. Screenshots stay in OSTEOMILL_PICTURES if that is set.
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
source_folder=$here/../../app/simulate
"$here/ball.sh" >ball.nrrd
"$here/ball.sh" 4 >other.nrrd
"$here/ball.sh" 1 >small.nrrd
"$here/balls.sh" >balls.nrrd

faults=0
fault() { echo "FAILED: $1"; faults=1; }
# Operates the window with the lines of standard input; its output is in `said`.
window() {
  rm -f state/osteomill/window.toml
  { echo "controls $folder/${controls:-controls}"; sed 's/ *;; */\n/g'; } | tee -a worked_lines >actions
  xvfb-run -a -s "-screen 0 1400x900x24" timeout 150 "$osteomill" simulate "$@" --out out --script actions >said 2>errors || {
    echo "FAILED: exit code $?"; cat errors; exit 1; }
  [ -z "${OSTEOMILL_PICTURES:-}" ] || cp ./*.png "$OSTEOMILL_PICTURES" 2>/dev/null || true
}
is() { [ "$(value "$1" "$2")" = "$3" ] || fault "at $1, $2 is '$(value "$1" "$2")' and not '$3'"; }
# For two moments $1 and $2: `changed A B KEY`, `same A B KEY`, `more A B KEY PART` (of a list of numbers).
changed() { [ "$(value "$1" "$3")" != "$(value "$2" "$3")" ] || fault "$3 stays '$(value "$1" "$3")' from $1 to $2"; }
same() { [ "$(value "$1" "$3")" = "$(value "$2" "$3")" ] || fault "$3 changes from $1 to $2: '$(value "$1" "$3")', '$(value "$2" "$3")'"; }
more() {
  awk -v a="$(part "$1" "$3" "${4:-1}")" -v b="$(part "$2" "$3" "${4:-1}")" 'BEGIN { exit !(b > a) }' ||
    fault "$3 does not grow from $1 to $2: '$(value "$1" "$3")', '$(value "$2" "$3")'"
}
shows() { value "$1" shown | grep -qF "[$2]" || fault "at $1 there is no '$2'"; }
hides() { ! value "$1" shown | grep -qF "[$2]" || fault "at $1 there is still '$2'"; }

# --- Headings, views, camera, keys, tool in hand ------------------------------------------------------------------
window ball.nrrd <<'END'
wait 0.2 ;; state first ;; screenshot controls-1-help.png
click Start milling ;; state start
key f1 ;; state f1 ;; key f1 ;; state f1-again ;; key f1 ;; key enter ;; state f1-enter ;; key f1 ;; key escape ;; state f1-escape
click Help (F1) ;; state help ;; click Start milling
state trainee ;; click Laboratory ;; wait 0.1 ;; state laboratory ;; screenshot controls-1-laboratory.png
click Milling ;; state no-milling ;; click Milling
click Algorithm ;; state no-algorithm ;; click Algorithm
click Tool ;; state no-tool ;; click Tool
click View ;; state no-view ;; click View
click Record and save ;; state no-save ;; click Record and save
click Cuts ;; state cuts-open ;; click Cuts
click Bone ;; state bone-open ;; click Bone
state before
click A ;; state from-a
click P ;; state from-p
click L ;; state from-l
click R ;; state from-r
click S ;; state from-s
click I ;; state from-i
glide 500 700 0 ;; press left ;; glide 600 650 0.1 ;; release left ;; state turned
press right ;; glide 600 600 0.1 ;; release right ;; state zoomed
press middle ;; glide 660 600 0.1 ;; release middle ;; state panned
press shift ;; press left ;; glide 660 660 0.1 ;; release left ;; release shift ;; state shift-panned
wheel 3 0.1 ;; state wheeled
click Whole ;; state whole
click Find tool ;; state found
click Window ;; wait 0.2 ;; screenshot controls-1-window.png ;; click Larger text ;; wait 0.2 ;; state larger ;; click Smaller text ;; wait 0.2 ;; state usual
click Light ;; wait 0.2 ;; state light ;; screenshot controls-1-light.png ;; click Dark ;; wait 0.2 ;; state dark
click Full screen (F11) ;; wait 0.3 ;; state menu-full ;; click Full screen (F11) ;; wait 0.3
glide 700 800 0 ;; press left ;; wait 0.1 ;; release left ;; wait 0.1 ;; state no-menu
click A ;; hold page-down 3 ;; click S ;; press middle ;; glide 700 600 0 ;; wait 0.1 ;; release middle ;; state lost
click Bring it here (B) ;; wait 0.2 ;; state brought ;; click Whole ;; glide 600 430 0 ;; key b ;; wait 0.2 ;; state brought-by-key
click Find tool ;; state refound
glide 640 400 0.1 ;; press left ;; glide 700 330 0.2 ;; wait 0.3 ;; release left ;; state tool-dragged
key t ;; state taken
glide 760 330 0.2 ;; wait 0.3 ;; state moved
press shift ;; glide 800 330 0.2 ;; release shift ;; wait 0.1 ;; state twisted
wheel 5 0.3 ;; wait 0.1 ;; state pushed
hold page-down 0.3 ;; wait 0.1 ;; state pulled
hold page-up 0.3 ;; wait 0.1 ;; state pushed-again
hold s 0.3 ;; wait 0.1 ;; state pulled-by-letter ;; hold w 0.3 ;; wait 0.1 ;; state pushed-by-letter
hold arrow-right 0.3 ;; state key-right
hold arrow-left 0.4 ;; state key-left
hold arrow-up 0.3 ;; state key-up
hold arrow-down 0.4 ;; state key-down
press shift ;; hold arrow-right 0.3 ;; release shift ;; state key-twisted
press left ;; wait 0.1 ;; state pedal ;; release left ;; wait 0.1 ;; state no-pedal
key space ;; wait 0.1 ;; state space ;; key space ;; wait 0.1 ;; state space-again
key p ;; wait 0.1 ;; state p ;; key p ;; wait 0.1 ;; state p-again
key escape ;; state escaped
key t ;; key t ;; state t-twice
click Take the tool (T) ;; state button-taken
click Let go (T) ;; state button-let-go
key f11 ;; wait 0.3 ;; state full ;; key f11 ;; wait 0.3 ;; state not-full
screenshot controls-2-keys.png
close
END
[ "$(value first tool_seen)" != "0.000 0.000 0.000" ] && same first before tool_seen || fault "the tool does not begin above the bone"
is first help true; is start help false; is f1 help true; is f1-again help false; is f1-enter help false; is f1-escape help false; is help help true
shows start "spindle on"; hides no-milling "spindle on"; shows no-milling stiffness
for control in Algorithm stiffness "burr radius" "Burr and drive"; do hides trainee "$control"; shows laboratory "$control"; done
hides no-algorithm stiffness; shows no-algorithm "burr radius"
hides no-tool "burr radius"; shows no-tool ghost
hides no-view ghost; shows no-view Record
hides no-save Record; shows no-save ghost
hides start axial; shows cuts-open axial
hides start isovalue; shows bone-open isovalue
for view in "a 0.000 -1.000 0.000" "p 0.000 1.000 0.000" "l 1.000 0.000 0.000" "r -1.000 0.000 0.000" \
  "s 0.000 0.000 1.000" "i 0.000 0.000 -1.000"; do
  [ "$(value "from-${view%% *}" towards_viewer | sed 's/-0\.000/0.000/g')" = "${view#* }" ] ||
    fault "view ${view%% *} looks from $(value "from-${view%% *}" towards_viewer)"
done
changed from-i turned towards_viewer; same from-i turned distance_mm; same from-i turned focus
more zoomed turned distance_mm; same turned zoomed towards_viewer
changed zoomed panned focus; same zoomed panned towards_viewer; same zoomed panned distance_mm
changed panned shift-panned focus; same panned shift-panned towards_viewer
more wheeled shift-panned distance_mm
same wheeled whole towards_viewer; changed wheeled whole focus; changed wheeled whole distance_mm
changed whole found focus; is found tool_px "640 400"; same whole found towards_viewer
is found ui_scale 1.00; is larger ui_scale 1.25; is usual ui_scale 1.00
is menu-full size "1400 x 900"; shows larger "Start page"; hides no-menu "Start page"
[ -s controls-1-light.png ] && ! cmp -s controls-1-light.png controls-1-window.png || fault "the light panels look like the dark ones"
for moment in first laboratory larger light dark; do
  for fact in unexplained cut_off outside covered; do is $moment $fact ""; done
  awk -v c="$(value $moment contrast)" 'BEGIN { exit !(c >= 4.5) }' || fault "at $moment text has a contrast of $(value $moment contrast)"
done
# The tool is free, at the requested place in front of the bone, with the shaft towards the viewer; the key uses the pointer's
# position.
near() {
  awk -v x="$(part "$1" tool_px 1)" -v y="$(part "$1" tool_px 2)" -v a="$2" -v b="$3" 'BEGIN { exit !((x - a) ^ 2 + (y - b) ^ 2 < 9) }' ||
    fault "at $1 the tool is at $(value "$1" tool_px) and not at $2 $3"
}
changed lost brought tool_px; near brought 640 400; near brought-by-key 600 430
for moment in first brought brought-by-key; do
  is $moment force_N 0.000
  awk -v z="$(part $moment shaft_seen 3)" 'BEGIN { exit !(z > 0.4) }' || fault "at $moment the shaft points away"
done
# The first picture shows the whole bone, upright.
is first corners_seen 8
awk -v up="$(part first up_seen 2)" 'BEGIN { exit !(up > 0.7) }' || fault "the bone does not begin upright"
more refound tool-dragged tool_seen 1; more refound tool-dragged tool_seen 2; same refound tool-dragged towards_viewer
is tool-dragged in_hand false; is taken in_hand true; is escaped in_hand false; is t-twice in_hand false
is button-taken in_hand true; is button-let-go in_hand false
more taken moved target_seen 1; more taken moved tool_seen 1; same taken moved towards_viewer
changed moved twisted target_turned; same moved twisted target_seen
more pushed twisted target_seen 3; more pushed pulled target_seen 3; more pushed-again pulled target_seen 3
more pushed-again pulled-by-letter target_seen 3; more pushed-by-letter pulled-by-letter target_seen 3
more pushed-again key-right target_seen 1; more key-left key-right target_seen 1
more key-left key-up target_seen 2; more key-down key-up target_seen 2
changed key-down key-twisted target_turned; same key-down key-twisted target_seen
is taken spindle false; is pedal spindle true; is no-pedal spindle false
is space spindle true; is space-again spindle false
is p paused true; is p-again paused false
same start not-full size; is full size "1400 x 900"

# --- A burr behind the ball is seen through it, by the key and by the box --------------------------------------------
window ball.nrrd --no-help <<'END'
wait 0.2 ;; click S ;; glide 700 450 0 ;; key b ;; settle ;; click I ;; wait 1 ;; state behind ;; colour behind
key x ;; wait 0.3 ;; state through ;; colour through ;; screenshot controls-8-through.png
key x ;; wait 0.3 ;; state behind-again ;; colour behind-again
click Look closer ;; wait 0.2 ;; click see through ;; wait 0.3 ;; state through-again ;; colour through-again ;; click see through ;; wait 0.1 ;; close
END
is behind see_through false; is through see_through true; is behind-again see_through false; is through-again see_through true
changed behind through colour; same behind behind-again colour; same through through-again colour

# --- Milling, what is drawn and heard, algorithm, tool, scan's isovalue ----------------------------------------------
window ball.nrrd --no-help <<'END'
wait 0.2 ;; click S ;; glide 640 750 0 ;; key b ;; wait 0.2 ;; key t ;; wheel 36 0.6 ;; wait 0.5 ;; click Laboratory ;; wait 0.4 ;; state touching
click ghost ;; state no-ghost ;; click ghost
click arrows ;; state no-arrows ;; click arrows
click spindle on ;; wait 0.6 ;; state milling ;; click sound ;; wait 0.1 ;; state silent ;; click sound
click spindle on ;; wait 0.2 ;; key t ;; wait 0.2 ;; state milled
click pause ;; wait 0.1 ;; state paused ;; click pause ;; wait 0.1 ;; state goes-on
glide 640 750 0 ;; key t ;; wheel 4 0.2 ;; key space ;; wait 0.6 ;; key space ;; wheel 4 0.2 ;; key space ;; wait 0.6 ;; key space
key t ;; wait 0.2 ;; state three-cuts ;; screenshot controls-3-milled.png
click Undo cut ;; settle ;; wait 0.1 ;; state undone
press control ;; key z ;; release control ;; settle ;; wait 0.1 ;; state undone-by-key
click Redo ;; settle ;; wait 0.1 ;; state redone
press control ;; key y ;; release control ;; settle ;; wait 0.1 ;; state redone-by-key
click Undo cut ;; settle ;; click Undo cut ;; settle ;; wait 0.1
click Reset bone ;; wait 0.3 ;; click Cancel ;; wait 0.1 ;; state not-reset
click Reset bone ;; wait 0.3 ;; click Save ;; settle ;; wait 0.1 ;; state reset
glide 640 750 0 ;; key b ;; wait 0.2 ;; key t ;; wheel 26 0.6 ;; key space ;; wait 0.4 ;; key space ;; key t ;; state milled-again
click Reset bone ;; wait 0.3 ;; click Discard ;; settle ;; wait 0.1 ;; state reset-again
click 1 line-proxy ;; settle ;; state line-proxy
drag stiffness 30 ;; settle ;; state line-proxy-stiffness
click 4 barrier-shell ;; settle ;; state barrier-shell
click 2 surface-points ;; settle ;; state surface-points
drag stiffness 30 ;; settle ;; state surface-points-stiffness
click 3 point-shell ;; settle ;; state point-shell
drag stiffness -20 ;; settle ;; state point-shell-stiffness
drag burr radius -10 ;; settle ;; state burr
drag shaft radius -10 ;; settle ;; state shaft
drag spindle speed 30 ;; settle ;; state rpm
glide 100 600 0 ;; wheel -60 0.5 ;; wait 0.3
click vibration ;; settle ;; state no-vibration
click burr pulls ;; settle ;; state no-pull
click drag ;; settle ;; state no-drag
click knock ;; settle ;; state knock
click View ;; click Record and save ;; click Algorithm ;; click Tool ;; click Bone
click Burr and drive ;; state drives
click turbine ;; settle ;; state turbine
click electric ;; settle ;; state electric
click surgical ;; settle ;; state surgical
click diamond ;; settle ;; state diamond ;; click cutting ;; settle ;; state cutting
drag wear 40 ;; settle ;; state worn
screenshot controls-6-drive.png
click constant-energy ;; settle ;; state constant ;; click chips ;; settle ;; state chips
click none ;; settle ;; state no-drive
click Choose burr ;; wait 0.2 ;; screenshot controls-7-burrs.png ;; click diamond 014 (1.4 mm) ;; settle ;; state named
click Choose burr ;; wait 0.2 ;; click cutting 3 mm ;; settle ;; state named-again
click Burr and drive
drag isovalue 20 ;; settle ;; wait 0.2 ;; state isovalue
press control ;; click isovalue ;; release control ;; type 500 ;; key enter ;; settle ;; wait 0.2 ;; state typed
screenshot controls-4-bone.png
close
END
more touching milling removed_mm3; is touching removed_mm3 0.000; is touching spindle false; is milling spindle true
is touching ghost true; is no-ghost ghost false
more no-arrows touching force_arrow_N; is no-arrows force_arrow_N 0.000
is milling heard_rpm "$(value milling rpm)"; is silent heard_rpm 0; is milled heard_rpm 0; is milled cuts 1
is paused paused true; is goes-on paused false
is three-cuts cuts 3; more milled three-cuts removed_mm3
is undone cuts 2; more undone three-cuts removed_mm3
is redone cuts 2; same undone redone removed_mm3; is redone-by-key cuts 3; same three-cuts redone-by-key removed_mm3
is undone-by-key cuts 1; more undone-by-key undone removed_mm3; same milled undone-by-key removed_mm3
is not-reset cuts 1; is reset cuts 0; is reset removed_mm3 0.000
more reset milled-again removed_mm3; is reset-again removed_mm3 0.000
compgen -G "out/*-milled.nrrd" >/dev/null || fault "Save before resetting did not save"
is barrier-shell algorithm barrier-shell
for algorithm in line-proxy surface-points point-shell; do
  is $algorithm algorithm $algorithm
  # The first drag after choosing an algorithm takes effect.
  changed $algorithm $algorithm-stiffness stiffness
done
changed point-shell-stiffness burr burr_mm; changed burr shaft shaft_mm; changed shaft rpm rpm
is rpm vibration true; is no-vibration vibration false
hides no-pull turbine; shows drives turbine
# The speed is no longer a handpiece's default, so another handpiece keeps it.
is drives handpiece 0; is turbine handpiece 1; is electric handpiece 2; is surgical handpiece 3; is no-drive handpiece 0
same rpm turbine rpm
is drives burr 0; is diamond burr 1; is cutting burr 0
is cutting wear 0; more cutting worn wear
is no-pull drag 1; is no-drag drag 0; is no-drag contact-transient 0; is knock contact-transient 1
is named burr_mm 0.70; is named shaft_mm 0.42; is named burr 1; is named-again burr_mm 1.50; is named-again burr 0
is worn law 1; is constant law 0; is chips law 1
is no-vibration cutting_reaction true; is no-pull cutting_reaction false
more no-vibration isovalue isovalue; is typed isovalue 500
value no-vibration isovalue_from | grep -q "^suggested: " || fault "the window does not show that the isovalue was suggested"
value typed isovalue_from | grep -q "^set here" || fault "the window does not show that the isovalue was set"

# --- Pieces of bone: a large ball, a small one and a lone voxel -----------------------------------------------------
window balls.nrrd --iso 700 --no-help <<'END'
wait 0.3 ;; click S ;; settle ;; wait 0.5
click Choose piece ;; wait 0.1 ;; state choosing ;; click Click on bone ... ;; glide 755 428 0.1 ;; press left ;; release left ;; wait 0.3 ;; state not-choosing
click Choose piece ;; glide 755 428 0.1 ;; press left ;; release left ;; settle ;; wait 0.2 ;; state chosen ;; screenshot controls-8-piece.png ;; key escape ;; wait 0.1 ;; state closed
press right ;; glide 755 470 0.1 ;; release right ;; wait 0.3 ;; state dragged ;; press right ;; glide 755 428 0.1 ;; release right ;; wait 0.2
glide 440 428 0.1 ;; press right ;; release right ;; settle ;; wait 0.2 ;; state small ;; drag volume -70 ;; wait 0.1
click Remove pieces below ;; settle ;; wait 0.2 ;; state without-crumb
glide 440 428 0.1 ;; press right ;; release right ;; settle ;; wait 0.2 ;; click Remove this piece ;; settle ;; wait 0.2 ;; state without-small
click Undo cut ;; settle ;; click Undo cut ;; settle ;; glide 440 428 0.1 ;; press right ;; release right ;; settle ;; wait 0.2
click Keep only this piece ;; settle ;; wait 0.2 ;; state only-small
glide 755 428 0.1 ;; press right ;; release right ;; wait 0.2 ;; state beside
close
END
shows choosing "Click on bone ..."; shows not-choosing "Choose piece"; hides not-choosing "Remove this piece"
shows chosen "Remove this piece"; is chosen pieces 3; more small chosen piece_mm3; is small pieces 3; is chosen cuts 0
hides closed "Remove this piece"; hides dragged "Remove this piece"
is without-crumb cuts 1; is without-small cuts 2; is only-small cuts 1; hides beside "Remove this piece"
more without-crumb chosen bone_size_mm 2; more without-small without-crumb bone_size_mm; more only-small without-small bone_size_mm
is only-small removed_mm3 0.000

# --- A tool in bone that comes back, or grows ----------------------------------------------------------------------
window ball.nrrd --no-help <<'END'
wait 0.2 ;; click S ;; glide 640 750 0 ;; key b ;; wait 0.2 ;; key t ;; wheel 30 0.6 ;; wait 0.3 ;; click Laboratory ;; wait 0.4
click 3 point-shell ;; settle ;; drag spindle speed 60 ;; settle ;; drag stiffness 30 ;; settle ;; wait 0.3 ;; state pressing ;; key t ;; wait 1.2 ;; state released
glide 640 750 0 ;; key t ;; key space ;; wheel 20 1 ;; wait 2 ;; key space ;; key t ;; wait 0.3 ;; state in-hole
click Undo cut ;; settle ;; wait 0.5 ;; state out
drag burr radius 60 ;; settle ;; wait 0.2 ;; state wide
close
END
more pressing out tool_seen 3; more in-hole pressing tool_seen 3; more in-hole out tool_seen 3; is out force_N 0.000
awk -v f="$(value pressing force_N)" 'BEGIN { exit !(f > 0) }' || fault "the tool was moved away although it only pressed"
awk -v f="$(value released force_N)" 'BEGIN { exit !(f < 0.05) }' || fault "a tool that was let go presses with $(value released force_N) N"
is wide burr_mm 4.00

# --- Cuts ---------------------------------------------------------------------------------------------------------
cut_lines() {
  echo "wait 0.2 ;; click Cuts ;; state none ;; click free ;; state free-on"
  echo "glide 660 400 0.1 ;; press control ;; press left ;; glide 660 430 0.2 ;; release left ;; release control"
  echo "state dragged ;; screenshot controls-5-free.png"
  echo "click other side ;; state free-other ;; drag free place 20 ;; state free-moved ;; click free ;; state free-off"
  for cut in axial coronal sagittal; do
    echo "click $cut ;; wait 0.1 ;; state $cut-on ;; click other side ;; state $cut-other"
    echo "drag $cut place 20 ;; state $cut-moved ;; click $cut ;; state $cut-off"
  done
  echo close
}
window ball.nrrd --no-help < <(cut_lines)
for cut in axial coronal sagittal free; do
  is none $cut off; is $cut-off $cut off
  changed none $cut-on $cut; changed $cut-on $cut-other $cut; changed $cut-other $cut-moved $cut
done
normal() { value "$1" "$2" | sed -E 's/ at .*//; s/-0\.000/0.000/g'; }
for cut in "axial 0.000 0.000 -1.000" "coronal 0.000 1.000 0.000" "sagittal -1.000 0.000 0.000"; do
  name=${cut%% *}
  [ "$(normal "$name-on" "$name")" = "${cut#* }" ] || fault "the $name cut is $(normal "$name-on" "$name")"
done
# The cut goes through the burr, which is beside the middle.
awk -v x="$(part sagittal-on tool_W 1)" -v at="$(value sagittal-on sagittal | sed 's/.* at //')" 'BEGIN { exit !((at + x) ^ 2 < 1e-3) }' ||
  fault "the sagittal cut begins at $(value sagittal-on sagittal) and the tool is at $(value sagittal-on tool_W)"
changed free-on dragged free
[ "$(normal free-on free)" = "$(normal dragged free)" ] || fault "dragging the cut turns it"
same free-on dragged towards_viewer

# --- Files, dialogues, closing ------------------------------------------------------------------------------------
echo "not a scan" >bad.nrrd
# Bone below air: 480^3 voxels of one byte, which take some time to load.
{ printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 480 480 480\nspacings: 0.1 0.1 0.1\nencoding: raw\n\n'
  head -c $((480 * 480 * 240)) /dev/zero | tr '\0' '\310'
  head -c $((480 * 480 * 240)) /dev/zero; } >large.nrrd
# Logs the files that the desktop should open.
mkdir bin
printf '%s\n' '#!/bin/sh' 'case "$1" in *report.html) touch opened-report ;; */out|*-report) touch opened-out ;; esac' >bin/xdg-open
chmod +x bin/xdg-open
PATH=$folder/bin:$PATH
window ball.nrrd --no-help <<'END'
wait 0.2 ;; state start
click Record ;; wait 0.3 ;; state recording ;; screenshot controls-6-recording.png
click Stop recording ;; wait 0.1 ;; state recorded
click Report ;; settle ;; wait 0.1 ;; state reported ;; click Open report ;; await opened-report ;; click Open folder ;; await opened-out
click Save scan ;; settle ;; wait 0.1 ;; state saved-scan
click Save surface ;; settle ;; wait 0.1 ;; state saved-surface
click Save picture ;; wait 0.2 ;; state saved-picture ;; click Hide ;; wait 0.1 ;; state hidden
open large.nrrd ;; wait 0.3 ;; click Cancel ;; wait 0.2 ;; state given-up
open other.nrrd ;; settle ;; wait 0.3 ;; state opened
open bad.nrrd ;; wait 0.1 ;; settle ;; wait 0.3 ;; state at-fault
screenshot controls-7-fault.png ;; click Close ;; wait 0.1 ;; state fault-read
quit ;; wait 60 ;; state still-there
END
[[ $(value recording badge) == "REC 0:0"? ]] && is start badge "" && is recorded badge "" || fault "the badge says '$(value recording badge)'"
value opened message | grep -q "^Opened other.nrrd: isovalue .* suggested: " || fault "the isovalue of what was opened is not told"
is start recording false; is recording recording true; is recorded recording false
recording=$(value recorded last_recording)
[ -s "$recording" ] && [ -z "$(value start last_recording)" ] || fault "no recording '$recording'"
for saved in "reported report/report.html" "saved-scan milled.nrrd" "saved-surface surface.ply" \
  "saved-picture picture.png"; do
  compgen -G "out/*-${saved#* }" >/dev/null || fault "no ${saved#* }"
done
value reported message | grep -q "^Report in out/" || fault "the report is not named"
for saved in scan surface picture; do
  value saved-$saved message | grep -q "^Saved out/" || fault "what Save $saved wrote is not named"
done
is hidden message ""; hides hidden "Open folder"; shows saved-picture "Open report"
is given-up scan ball.nrrd; is given-up message "Opening large.nrrd was cancelled"; hides given-up Cancel
is start scan ball.nrrd; is opened scan other.nrrd; is at-fault scan other.nrrd
value at-fault dialogue | grep -q "^bad.nrrd: ." || fault "the scan at fault is not named"
is fault-read dialogue ""; hides fault-read Close
[ -z "$(value still-there scan)" ] || fault "it asks for a report that was made"

window ball.nrrd --no-help <<'END'
wait 0.2 ;; open small.nrrd ;; settle ;; wait 0.3 ;; state too-large ;; key escape ;; wait 0.1 ;; state as-before
close
END
# A tool that does not fit the bone is refused, wherever it is set.
value too-large dialogue | grep -q "^small.nrrd: a burr of .* mm radius is wider than the whole bone" || fault "a burr wider than the bone is accepted"
is too-large scan ball.nrrd; is as-before dialogue ""; is as-before scan ball.nrrd
xvfb-run -a timeout 60 "$osteomill" simulate ball.nrrd --burr-radius 50 >said 2>errors && fault "a burr of 50 mm begins" || code=$?
[ "$code" -eq 1 ] && grep -q "^osteomill: ball.nrrd: a burr of 50 mm radius is wider than the whole bone" errors ||
  fault "a burr of 50 mm ends with $code and $(cat errors)"

# --- A scan with several boundaries -------------------------------------------------------------------------------
# Air, soft tissue, and bone in it.
{
  printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 32 32 32\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
  awk 'function within(mm) { return mm < 0 ? 0 : mm > 1 ? 1 : mm }
    BEGIN { for (k = 0; k < 32; ++k) for (j = 0; j < 32; ++j) for (i = 0; i < 32; ++i) {
      from = 0.5 * sqrt((i - 15.5)^2 + (j - 15.5)^2 + (k - 15.5)^2)
      print int(600 * within(6.5 - from) + 900 * within(4.5 - from))
    } }'
} >skin.nrrd
mapfile -t boundaries < <("$osteomill" info skin.nrrd | sed -n 's/^boundary *\([^,]*\),.*/\1/p')
[ ${#boundaries[@]} -eq 2 ] || fault "skin and bone have ${#boundaries[@]} boundaries"
window skin.nrrd --no-help <<END
wait 0.2 ;; click Bone ;; wait 0.2 ;; state both
click ${boundaries[1]} ;; settle ;; wait 0.2 ;; state bone
click ${boundaries[0]} ;; settle ;; wait 0.2 ;; state skin
close
END
value both isovalue_from | grep -q "; a guess, with other boundaries at " || fault "the window does not show that the isovalue is a guess"
for n in 0 1; do
  awk -v is="$(value "$([ $n = 0 ] && echo skin || echo bone)" isovalue)" -v as="${boundaries[$n]}" \
    'BEGIN { exit !((is - as) ^ 2 < 1) }' || fault "the button ${boundaries[$n]} does not set the isovalue"
done

# --- A scan that is too coarse for the burr -----------------------------------------------------------------------
sed 's/0.5 0.5 0.5/2 2 2/' ball.nrrd >coarse.nrrd
window coarse.nrrd --no-help <<'END'
wait 0.5 ;; state coarse ;; screenshot coarse.png ;; click Laboratory ;; wait 0.1 ;; drag burr radius 60 ;; settle ;; wait 0.5 ;; state wide-burr
close
END
value coarse warnings | grep -q "lie up to 2 mm apart" || fault "no warning that the voxels are longer than the burr's radius"
is wide-burr warnings ""

# --- Labels -------------------------------------------------------------------------------------------------------
# The ball's left and right halves have different labels.
{
  printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 32 32 32\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
  for ((row = 0; row < 32 * 32; ++row)); do printf '1 %.0s' {1..16}; printf '2 %.0s' {1..16}; done
} >halves.nrrd
window ball.nrrd --labels halves.nrrd --no-help <<'END'
wait 0.3 ;; state labelled ;; screenshot labelled.png
click label colours ;; wait 0.2 ;; state plain ;; screenshot plain.png
close
END
shows labelled "label colours"
! cmp -s labelled.png plain.png || fault "the label colours are not drawn"

# --- The last recording is opened to be played, playback_test.sh works that page; the way back to the start ----------------------------------
controls=pages window ball.nrrd --no-help <<'END'
wait 0.3 ;; click Record ;; wait 0.5 ;; click Stop recording ;; settle ;; click Play back ;; close
END
controls=pages window ball.nrrd --no-help <<'END'
wait 0.3 ;; click Window ;; wait 0.2 ;; click Start page ;; wait 1 ;; screenshot controls-2-start.png ;; click Built-in tooth ;; settle ;; state tooth ;; close
END
is tooth scan "built-in tooth"

# --- Coverage of the controls -----------------------------------------------------------------------------------------
# Collects the labels that were drawn and those in the code, except for the exercise pages (exercise_test.sh) and the playback page
# (playback_test.sh).
{ sed -n 's/^drawn //p' controls
  grep -hzoP --exclude=exercise_panel.cpp --exclude=start_page.cpp --exclude=playback_panel.cpp \
    'ui::(button|checkbox|radio|slider|text_field|header|begin_menu)\(\s*"\K[^"]+' "$source_folder"/*.cpp |
    tr '\0' '\n' | sed 's/##.*//; /^$/d'; } | sed '/[0-9] mm)\{0,1\}$/d' | sort -u >labels
# Excludes controls that only a haptic device shows, and those tested by open_test.sh and seeing_test.sh.
{ sed -n 's/^worked //p' controls pages
  sed 's/ *;; */\n/g' "$here/device_test.sh" "$here/open_test.sh" "$here/seeing_test.sh" |
    sed -nE 's/^(.*[^a-z])?click (.*)/\2/p; s/^drag (.*) [0-9]+$/\1/p'; } | sort -u >worked
cat "$here/device_test.sh" >>worked_lines
[ "$(wc -l <labels)" -gt 30 ] || fault "the labels are not found"
while read -r label; do fault "the control '$label' was never worked, or did nothing"; done < <(comm -23 labels worked)
# Every key that the code handles must have been pressed.
grep -ohE 'GLFW_KEY_[A-Z0-9_]+' "$source_folder/pointer.cpp" "$source_folder/overlay.cpp" | sort -u | sed 's/GLFW_KEY_//' |
  while read -r key; do
    name=$(tr 'A-Z_' 'a-z-' <<<"$key" | sed -E 's/^(up|down|left|right)$/arrow-\1/')
    grep -qE "(^|;; )(key|hold|press) $name( |$)" worked_lines || { echo "FAILED: the key $name was never pressed"; exit 1; }
  done || faults=1
exit $faults
