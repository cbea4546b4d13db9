#!/usr/bin/env bash
# Checks the force on the hand, as logged by its UDP device, when either side is killed:
#   killed_test.sh OSTEOMILL UDP_DEVICE
# The device logs a line every millisecond: the time, the time of the last wrench received, and the force and torque driven.
set -euo pipefail
osteomill=$1 udp_device=$2
folder=$(mktemp -d)
device= program=
end() { kill -9 $device $program 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
cd "$folder"
export XDG_CONFIG_HOME=$folder/config
port=$((20000 + $$ % 20000))
fail() { echo "FAILED: $1"; tail -n 3 hand said errors 2>/dev/null || true; exit 1; }
# The device writes as soon as it listens; osteomill looks for it only once.
begin_device() {
  rm -f hand
  "$udp_device" "$port" hand & device=$!
  until_true 20 "listening" test -s hand
}
begin_milling() { "$osteomill" live --device "udp:127.0.0.1:$port" --seconds "$1" >said 2>errors & program=$!; }
until_true() {  # SECONDS WHAT COMMAND...
  for _ in $(seq $((10 * $1))); do
    "${@:3}" && return
    sleep 0.1
  done
  fail "never $2"
}
press() {  # SECONDS
  begin_device
  begin_milling "$1"
  until_true 60 "pressed" pressed
}
pressed() { [ -s hand ] && tail -n 1 hand | awk '{ exit !($3 * $3 + $4 * $4 + $5 * $5 > 0.01) }'; }
# Allows no step above 4 N or 100 N mm in a millisecond, and requires zero within 5 ms after the last wrench is 5 ms old.
judge() {
  awk -v lapse="$1" '
    function change(from, a, b, c) { return sqrt((a - was[from])^2 + (b - was[from + 1])^2 + (c - was[from + 2])^2) }
    NR > 1 && (change(3, $3, $4, $5) > 4.0001 || change(6, $6, $7, $8) > 100.01) { print "a step in line " NR; exit 1 }
    { for (n = 3; n <= 8; ++n) was[n] = $n; old = $1 - $2 > 0.0051 ? old + 1 : 0 }
    old > 5 && ($3 != 0 || $4 != 0 || $5 != 0 || $6 != 0 || $7 != 0 || $8 != 0) { print "felt in line " NR; exit 1 }
    { force = sqrt($3^2 + $4^2 + $5^2); most = force > most ? force : most }
    END { if (most < 0.1) { print "nothing was ever felt"; exit 1 }
          if (lapse && (old < 6 || force != 0)) { print "the last wrench never lapsed"; exit 1 } }' hand || fail "$2"
}

# osteomill is killed while the hand presses: the device's timeout drops the force. Before, no other program can open the device.
press 90
! "$osteomill" live --device "udp:127.0.0.1:$port" --seconds 1 >/dev/null 2>second || fail "two programs have one device"
grep -q "udp:127.0.0.1:$port: another program has the device in use" second || fail "why: $(cat second)"
kill -9 $program
sleep 0.3
kill $device
wait $device || fail "the device failed"
judge 1 "osteomill killed"

# osteomill is terminated: it sends a zero wrench before the timeout.
press 90
kill -TERM $program
sleep 0.3
kill $device
wait $device || true
judge 1 "osteomill ended"

# The device is killed: osteomill reports it, and continues when the device is back.
press 20
kill -9 $device
wait $device 2>/dev/null || true
until_true 10 "missed" grep -qE "sinking device: has (been gone|given no pose) for" errors
judge 0 "the device killed"
begin_device
until_true 10 "there again" grep -q "sinking device: works again" errors
until_true 60 "pressed again" pressed
wait $program || fail "osteomill ended with $?"
grep -qE "^device +sinking device: .* poses/s, [1-9][0-9]* faults" said || fail "faults are not counted"
sleep 0.3
kill $device
wait $device || true
judge 1 "osteomill at its end"
