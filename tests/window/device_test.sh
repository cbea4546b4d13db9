#!/usr/bin/env bash
# A device, the UDP example, holds the tool in the window, is stopped and continues:
#   device_test.sh OSTEOMILL UDP_DEVICE
set -euo pipefail
osteomill=$1 udp_device=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
command -v xvfb-run >/dev/null || { echo "SKIPPED: needs xvfb-run"; exit 77; }
folder=$(mktemp -d)
device=
end() { [ -z "${KEEP:-}" ] || cp said errors ./*.png "$KEEP" || true; [ -z "$device" ] || kill -9 "$device" 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
cd "$folder"
export XDG_CONFIG_HOME=$folder/config XDG_STATE_HOME=$folder/state
fail() { echo "FAILED: $1"; cat errors; grep -E "device|dialogue|force|tool_W" said || true; exit 1; }
value() { grep "^$1=" said | cut -d= -f2- || true; }  # STATE.KEY
port=$((20000 + $$ % 20000))
"$udp_device" "$port" hand &
device=$!
for _ in $(seq 200); do [ ! -s hand ] || break; sleep 0.1; done
cat >actions <<'E2'
settle
wait 2
state moving
wait 0.7
state moved
press c
wait 0.2
state clutched
wait 0.5
state clutched_on
release c
click Calibrate
wait 0.2
screenshot calibrating.png
click Cancel
wait 0.2
click Calibrate
wait 0.4
click That was right
wait 0.4
click That was up
wait 0.5
state calibrated
key enter
wait 0.3
screenshot device.png
say stop
await stopped
wait 0.5
state stopped
screenshot stopped.png
key f1
wait 0.2
state explained
say go on
await going-on
wait 1
state going_on
key f1
click Record
wait 0.5
click Stop recording
wait 0.5
close
E2
bash "$here/ball.sh" >ball.nrrd
xvfb-run -a -s "-screen 0 1280x800x24" timeout 120 "$osteomill" simulate ball.nrrd --device "udp:127.0.0.1:$port" \
  --device-scale 0.5 --no-help --script actions >said 2>errors &
window=$!
until_said() {
  for _ in $(seq 600); do
    ! grep -q "^$1:" said || return 0
    kill -0 $window 2>/dev/null || fail "the window ended"
    sleep 0.1
  done
  fail "never said $1"
}
until_said stop
kill -STOP "$device"
touch stopped
until_said "go on"
kill -CONT "$device"
touch going-on
wait $window || fail "exit code $?"

[ "$(value moving.device)" = "example device" ] || fail "another device"
for state in moving moved going_on; do
  [ -z "$(value $state.device_fault)" ] || fail "$state: $(value $state.device_fault)"
done
[ "$(value moving.tool_W)" != "$(value moved.tool_W)" ] || fail "the tool does not move"
[ "$(value clutched.tool_W)" = "$(value clutched_on.tool_W)" ] || fail "the clutch does not hold the tool"
[ "$(value moving.spindle)" = true ] || fail "its button does not mill"
grep -q "^calibrated.dialogue=The two moves were shorter than 10 mm" said || fail "moves of no length calibrate"
grep -qE "^stopped.device_fault=has given no pose for" said || fail "a stopped device is not reported"
for place in Calibrate "Start milling"; do
  [ -n "$(value "going_on.place of $place")" ] && [ "$(value "going_on.place of $place")" = "$(value "explained.place of $place")" ] ||
    fail "$place moves as a fault comes and goes"
done
[ "$(value stopped.force_arrow_N)" = 0.000 ] || fail "a stopped device still gets force"
[ "$(sed -n 's/^scale = //p' config/osteomill/devices/example-device.toml)" = 0.5 ] || fail "its workspace is not stored"
"$osteomill" report ./*recording.h5 --out report >text
grep -q "example device" report/report.html || fail "the recording does not name it"
