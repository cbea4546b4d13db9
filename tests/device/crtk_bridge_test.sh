#!/usr/bin/env bash
# osteomill mills through the CRTK bridge with a stand-in for an arm, over a real roscore:
#   crtk_bridge_test.sh OSTEOMILL
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
osteomill=$1
python=/usr/bin/python3
if ! command -v roscore >/dev/null || ! $python -c 'import rospy, geometry_msgs.msg, sensor_msgs.msg' 2>/dev/null; then
  echo "skipped: ROS is not installed (ros-core, python3-rospy, python3-geometry-msgs, python3-sensor-msgs)"
  exit 77
fi
folder=$(mktemp -d)
processes=
end() { kill $processes 2>/dev/null || true; wait $processes 2>/dev/null || true; rm -rf "$folder"; }
trap end EXIT
cd "$folder"
export PYTHONDONTWRITEBYTECODE=1 XDG_CONFIG_HOME=$folder/config ROS_LOG_DIR=$folder/ros ROS_HOSTNAME=localhost
port=$((20000 + $$ % 20000))
export ROS_MASTER_URI=http://localhost:$((port + 1))
fail() { echo "FAILED: $1"; tail -n 5 roscore said errors bridge arm hand 2>/dev/null || true; exit 1; }
roscore -p $((port + 1)) >roscore 2>&1 & processes="$processes $!"
for _ in $(seq 100); do ! $python -c 'import rosgraph; rosgraph.Master("/test").getPid()' 2>/dev/null || break; sleep 0.2; done
$python "$here/crtk_arm.py" hand 4 >arm 2>&1 & processes="$processes $!"
$python "$here/../../examples/crtk_bridge.py" /arm --port "$port" --max-force 6 >bridge 2>&1 & processes="$processes $!"
sleep 1.5
bash "$here/../window/ball.sh" >ball.nrrd
"$osteomill" live ball.nrrd --device "udp:127.0.0.1:$port" --device-scale 0.1 --seconds 6 \
  --spindle --algorithm line-proxy >said 2>errors || fail "live ended with $?"
sleep 0.5
grep -q "is not driven: it is not calibrated" errors || fail "an arm that is not homed was accepted"
awk '{ force = sqrt($2 * $2 + $3 * $3 + $4 * $4) }
  !$1 && force > 0 { exit 1 }
  { most = force > most ? force : most }
  END { exit !(most > 0.1 && most <= 6 && force == 0) }' hand || fail "the force on the hand"
