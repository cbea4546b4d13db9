#!/usr/bin/env bash
# Each back end mills in `live`, and one of them (all with ALL_WINDOWS=1) in the window, with a stand-in for its device:
#   stand_ins_test.sh OSTEOMILL LIBDHD LIBHD HAPLY_SERVICE IGTL_SERVER
# Its handle moves slowly along an axis that the test turns into the bone, and it logs the wrenches it receives.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
osteomill=$1 haply_service=$4 igtl_server=$5
export OSTEOMILL_DHD_LIBRARY=$2 OSTEOMILL_HD_LIBRARY=$3
folder=$(mktemp -d)
servers=
end() { kill $servers 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
cd "$folder"
export XDG_CONFIG_HOME=$folder/config XDG_STATE_HOME=$folder/state OSTEOMILL_STAND_IN_LOG=$folder/hand
fail() { echo "FAILED: $1"; grep -v 'place of' said || true; cat errors hand; exit 1; }
port=$((20000 + $$ % 20000)) slicer_port=$((20001 + $$ % 20000))
"$haply_service" "$port" >listens & servers="$servers $!"
"$igtl_server" "$slicer_port" >listens_too & servers="$servers $!"
for _ in $(seq 200); do [ ! -s listens ] || [ ! -s listens_too ] || break; sleep 0.1; done
bash "$here/../window/ball.sh" >ball.nrrd

# Checks the wrenches of a finished session: a force was felt, and the last one is zero.
judge() {
  for _ in $(seq 50); do ! grep -q "closed" hand || break; sleep 0.1; done
  tail -n 1 hand | awk '{ for (n = 1; n <= NF; ++n) { if ($n == "most") most = $(n + 1); if ($n == "last") at = n } }
    END { exit !(most > 0.1 && $(at + 1) == 0 && $(at + 2) == 0 && $(at + 3) == 0) }' || fail "$1: the force on the hand"
}

mills() {  # DEVICE NAME DOWN AWAY OPTIONS...: rotations of the device so that the handle moves down, or away from the viewer
  local device=$1 name=$2
  : >hand
  "$osteomill" live ball.nrrd --device "$device" --device-scale 0.2 --device-turn $3 --seconds 1.5 --spindle \
    --algorithm line-proxy --quiet "${@:5}" >said 2>errors || fail "$device: live ended with $?"
  grep -qE "^device +$name.*: [0-9]{3,} poses/s, " said || fail "$device: $name was not read well"
  awk '/^removed/ { exit !($2 > 0.01) }' said || fail "$device: nothing was milled"
  judge "$device in live"

  ! grep -q "the receiver has gone" errors || fail "$device: the bone was not sent"

  [[ -n ${ALL_WINDOWS:-} || $device == haply* ]] && command -v xvfb-run >/dev/null || return 0
  : >hand
  printf '%s\n' settle 'glide 640 400 0.1' 'key b' 'wait 2' 'state milling' close >actions
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 120 "$osteomill" simulate ball.nrrd --device "$device" \
    --device-scale 0.2 --device-turn $4 --algorithm line-proxy --no-help --script actions "${@:5}" \
    >said 2>errors || fail "$device: simulate ended with $?"
  grep -q "^milling.device=$name" said || fail "$device: the window does not name $name"
  judge "$device in the window"
}
mills dhd "Force Dimension sigma.7 4711" "90 0 0" "0 180 0"
mills hd "3D Systems Touch 0815" "0 0 -90" "0 90 0"
mills "haply:127.0.0.1:$port" "Haply Inverse3 049D" "0 0 -90" "0 90 0" --send-bone "127.0.0.1:$slicer_port"

# Stopped by Ctrl-Z and then killed: osteomill sent zero before, because the service has no timeout.
: >hand
"$osteomill" live ball.nrrd --device "haply:127.0.0.1:$port" --device-scale 0.2 --device-turn 0 0 -90 --seconds 60 \
  --algorithm line-proxy --quiet >said 2>errors & program=$!
sleep 2.5
kill -TSTP $program
for _ in $(seq 50); do ! grep -q "^State:.*T" "/proc/$program/status" || break; sleep 0.1; done
kill -9 $program
wait $program 2>/dev/null || true
judge "haply stopped"

# A vendor's function never returns: `live` still ends, and names it.
OSTEOMILL_STAND_IN_HANGS_IN=dhdGetPositionAndOrientationFrame timeout 60 "$osteomill" live ball.nrrd --device dhd --seconds 3 \
  --quiet >said 2>errors || fail "live of a device that hangs ended with $?"
grep -q "dhdGetPositionAndOrientationFrame does not return" errors || fail "what hangs is not named"
