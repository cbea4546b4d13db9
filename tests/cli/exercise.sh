#!/usr/bin/env bash
# An exercise is checked, milled along poses, recorded and measured; a recording of another exercise is refused.
#   exercise.sh OSTEOMILL
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fault() { echo "FAILED: $1"; exit 1; }
refused() { local reason=$1; shift; local code=0; "$osteomill" "$@" --quiet >said 2>error || code=$?
  [ $code -eq 1 ] && [ "$(wc -l <error)" -eq 1 ] && grep -qE -- "$reason" error || fault "$*: $code, $(cat error)"; }

mkdir tasks
cat >tasks/hole.toml <<'TOML'
title = "Hole"
scan = "builtin:tooth"
tools = [1]
[target]
cylinder = { from = [-2.5, -2.7, 24], to = [-2.5, -2.7, 19], radius = 1 }
[keep]
margin_mm = 0.3
[[no_go]]
name = "pulp horn"
sphere = { center = [-2.5, -2.7, 17], radius = 1 }
[[item]]
measure = "target_removed_percent"
at_least = 50
source = "a test"
[[item]]
measure = "no_go_contacts"
at_most = 0
TOML
"$osteomill" exercise tasks/hole.toml --check >said
grep -q "^target: .* mm³ of bone" said && grep -q "^no-go pulp horn: 4.1.* 1.0. mm from the target" said || fault "$(cat said)"

# Moves from above the cusp to TO_Z in a second, and stays for half a second.
poses() { awk -v to="$1" 'BEGIN { print "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling"
  for (n = 0; n < 1500; ++n) { t = n < 1000 ? n / 1000 : 1; printf "%.3f,-2.5,-2.7,%.5f,1,0,0,0,1\n", n / 1000, 23 + t * (to - 23) } }'; }
poses 20 >good.csv
poses 23 >idle.csv
work() { "$osteomill" replay "$1.csv" --exercise tasks/hole.toml --burr-radius 1 --record "$1.h5" --quiet "${@:2}" >/dev/null; }
value() { awk -F, -v row="$2" '$1 == row { print $2 "," $4 "," $5; exit }' "$1/debrief.csv"; }
work good --trainee "Trainee 7"
"$osteomill" replay good.h5 --verify --quiet | grep -q "^same: 1500 ticks" || fault "the recording of poses does not replay"
"$osteomill" debrief good.h5 --out good --quiet >said
[ "$(head -1 good/debrief.csv)" = "measure,value,unit,limit,met,source" ] || fault "$(head -1 good/debrief.csv)"
[[ $(value good no_go_contacts) == "0,at most 0,yes" ]] || fault "$(cat good/debrief.csv)"
[[ $(value good hidden_cutting_percent) == ",," ]] || fault "a value that the recording lacks is not empty"
value good cutting_s | awk -F, '{ exit !($1 > 0.2 && $1 < 1.5) }' || fault "$(cat good/debrief.csv)"
work idle
"$osteomill" debrief idle.h5 --out idle --quiet >said
[[ $(value idle target_removed_percent) == "0,at least 50,no" ]] || fault "$(cat idle/debrief.csv)"
[[ $(value idle force_median_N) == ",," ]] || fault "a force without cutting"
/usr/bin/python3 - <<'CHECK' || fault "the recording does not name its exercise"
import h5py
with h5py.File("good.h5") as f:
    s = {k: v.decode() if isinstance(v, bytes) else v for k, v in f["settings"].attrs.items()}
assert s["exercise.title"] == "Hole" and s["exercise.file"] == "tasks/hole.toml", s
assert s["exercise.trainee"] == "Trainee 7" and s["exercise.guidance"] == 0, s
with h5py.File("idle.h5") as f:
    assert "exercise.trainee" not in f["settings"].attrs and f["settings"].attrs["exercise.guidance"] == 0
CHECK

# An exercise that has changed since the recording is used, with a warning.
cp tasks/hole.toml tasks/other.toml
cp tasks/hole.toml tasks/good.toml
echo '# later' >>tasks/hole.toml
"$osteomill" debrief good.h5 --out good >/dev/null 2>error
grep -q "tasks/hole.toml: differs from the exercise recorded in" error || fault "$(cat error)"

refused "tasks/hole.toml: allows burrs of 1 mm" replay good.csv --exercise tasks/hole.toml --record x.h5
refused "good.csv: is not a recording" replay good.csv --verify
"$osteomill" save --out tooth.nrrd --quiet >/dev/null
sed -i 's/^scan = .*/scan = "..\/ball.nrrd"/' tasks/other.toml
"$osteomill" save --after good.h5 --out ball.nrrd --quiet >/dev/null
refused "good.h5: was made with another scan" debrief good.h5 --exercise tasks/other.toml --out x
head -c 20000 good.h5 >cut.h5
refused "cut.h5: " debrief cut.h5 --out x
"$osteomill" replay good.csv tooth.nrrd --iso 750 --record plain.h5 --quiet >/dev/null
"$osteomill" replay plain.h5 --verify --quiet | grep -q "^same: 1500 ticks" || fault "poses without an exercise do not replay"
refused "plain.h5: was made without an exercise" debrief plain.h5 --out x
[ ! -e x ] && [ ! -e x.h5 ] || fault "something was written"
sed '5s/\[-2\.5/[90/g' tasks/hole.toml >tasks/far.toml
refused "tasks/far.toml: line 4: the cylinder lies outside the scan" exercise tasks/far.toml --check
sed 's/^title/titl/' tasks/hole.toml >tasks/typo.toml
refused "tasks/typo.toml: line 1: an exercise has no titl; did you mean title[?]" exercise tasks/typo.toml --check

# The start page's picture, if OpenGL is available.
if "$osteomill" exercise tasks/other.toml --picture none/hole.png --quiet >/dev/null 2>&1; then fault "a picture was written into a missing folder"; fi
if "$osteomill" exercise tasks/good.toml --picture hole.png --quiet >said 2>error; then
  [ "$(head -c 24 hole.png | tail -c 8 | od -An -tu1 | xargs)" = "0 0 1 44 0 0 0 240" ] || fault "the picture is not 300 x 240"
else
  grep -q OpenGL error || fault "$(cat error)"
fi

# A guard keeps the burr away, replays bit for bit only with the exercise, and works with one algorithm only.
sed 's/^name = "pulp horn"/&\nguard_mm = 0.5/; s/^title = .*/title = "Guarded"/' tasks/hole.toml >tasks/guarded.toml
"$osteomill" exercise tasks/guarded.toml --check | grep -q "warning below 3 mm, burr held off by 0.5 mm" || fault "--check does not list the guard"
poses 16 >deep.csv
guarded() { "$osteomill" replay deep.csv --exercise tasks/guarded.toml --burr-radius 1 --quiet "$@"; }
work deep; "$osteomill" debrief deep.h5 --out deep --quiet >/dev/null
value deep no_go_min_distance_mm | awk -F, '{ exit !($1 < 0.3) }' || fault "without a guard the burr does not come near"
guarded --record guarded.h5 --out guarded.csv >/dev/null
awk -F, 'NR == 1 { for (n = 1; n <= NF; ++n) c[$n] = n; next }
  { d = sqrt(($c["tool_x_mm"] + 2.5) ^ 2 + ($c["tool_y_mm"] + 2.7) ^ 2 + ($c["tool_z_mm"] - 17) ^ 2) - 2; if (NR == 2 || d < least) least = d }
  END { exit !(least > 0.45 && least < 0.6) }' guarded.csv || fault "the burr is not held at its guard"
"$osteomill" replay guarded.h5 --verify --quiet | grep -q "^same: 1500 ticks" || fault "a guarded recording does not replay"
cp tasks/guarded.toml kept.toml
sed -i 's/guard_mm = 0.5/guard_mm = 0.4/' tasks/guarded.toml
refused "tasks/guarded.toml: has changed since guarded.h5 was made" replay guarded.h5 --verify
cp kept.toml tasks/guarded.toml
code=0; guarded --algorithm point-shell --record x.h5 >said 2>error || code=$?
[ $code -eq 2 ] && grep -q "point-shell cannot hold the burr off structures" error || fault "another algorithm: $code, $(cat error)"
sed 's/guard_mm = 0.5/guard_mm = 9/' kept.toml >tasks/wide.toml
refused "tasks/wide.toml: line 10: guard_mm is not a number from 0 to 5" exercise tasks/wide.toml --check

# Named burrs.
sed 's/^tools = .*/tools = ["diamond-2", 0.75]/' tasks/hole.toml >tasks/named.toml
named() { "$osteomill" replay good.csv --exercise tasks/named.toml --record named.h5 --quiet "$@"; }
named --burr-name diamond-2 >/dev/null
"$osteomill" replay named.h5 --verify --quiet | grep -q "^same: 1500 ticks" || fault "a recording of a named burr does not replay"
/usr/bin/python3 - <<'CHECK' || fault "the recording does not name its burr"
import h5py
with h5py.File("named.h5") as f:
    name = f["settings"].attrs["burr_name"]
    assert (name.decode() if isinstance(name, bytes) else name) == "diamond-2" and f["settings"].attrs["milling.burr"] == 1
    assert f.attrs["burr_radius_mm"] == 1 and abs(f.attrs["shaft_radius_mm"] - 0.6) < 1e-12
CHECK
named --burr-radius 0.75 >/dev/null
code=0; named --burr-name cutting-2 >said 2>error || code=$?
[ $code -eq 1 ] && grep -q "allows burrs of diamond-2, 0.75 mm radius" error || fault "another burr: $code, $(cat error)"
sed 's/diamond-2"/diamond-2.2"/' tasks/named.toml >tasks/no-burr.toml
refused "tasks/no-burr.toml: line 3: there is no burr diamond-2.2; did you mean diamond-2" exercise tasks/no-burr.toml --check
code=0; named --burr-name diamnd-2 >said 2>error || code=$?
[ $code -eq 2 ] && grep -q "diamond-2" error || fault "a burr without a name: $code, $(cat error)"
