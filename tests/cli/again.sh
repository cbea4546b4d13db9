#!/usr/bin/env bash
# A recording can be continued at any of its ticks: repeated bit for bit, along another motion, and live; or one line gives the
# reason why not.
#   again.sh OSTEOMILL
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null

fault() { echo "FAILED: $1"; exit 1; }
same() { "$osteomill" replay "$1" --verify --quiet >said 2>error || fault "$1: $(cat error)"; grep -q "^same: $2 ticks" said || fault "$1: $(cat said)"; }
refused() { local code=$1 reason=$2; shift 2; "$osteomill" "$@" --quiet >/dev/null 2>error && fault "$* was accepted"
  [ $? -eq "$code" ] && [ "$(wc -l <error)" -eq 1 ] && grep -q "$reason" error || fault "$*: $(cat error)"; }

printf 'time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n' >poses.csv
for ((n = 0; n < 1500; ++n)); do
  awk -v n=$n 'BEGIN { d = 0.004 * n; if (d > 3) d = 3; printf "%.3f,%.4f,0,%.4f,1,0,0,0,%d\n", n / 1000, 0.001 * n, 23 - d, n % 400 < 300 }'
done >>poses.csv
"$osteomill" replay poses.csv --record a.h5 --out a.csv --quiet >/dev/null
"$osteomill" replay --from a.h5 --at 0.9 --record b.h5 --out b.csv --quiet >/dev/null
columns() { cut -d, -f1-23,25- "$1"; }
head -1 a.csv | cut -d, -f24 | grep -q compute_us || fault "$(head -1 a.csv)"
cmp <(columns a.csv | tail -n +903) <(columns b.csv | tail -n +2) || fault "the rest differs"
same b.h5 1500
# Another motion, and a continuation of that.
head -201 poses.csv >more.csv
"$osteomill" replay more.csv --from b.h5 --at 1.2 --record c.h5 --quiet >/dev/null
same c.h5 1401
"$osteomill" live --from c.h5 --at 1.3 --seconds 1 --record d.h5 --quiet >/dev/null 2>&1
"$osteomill" replay d.h5 --verify --quiet | grep -q ^same || fault "the live branch does not replay"
"$osteomill" save --after d.h5 --out d.nrrd --quiet >/dev/null
mkdir elsewhere
mv c.h5 b.h5 elsewhere
"$osteomill" replay d.h5 --verify --quiet | grep -q ^same || fault "the live branch needs the recordings that it continues"

refused 1 "a.h5: has no tick at 99 s" replay --from a.h5 --at 99 --out x.csv
refused 1 "a.h5: was made with another scan" live builtin:mastoid --from a.h5 --at 1
refused 1 "nosuch.h5: no such file" live --from nosuch.h5 --at 1
refused 1 "x.h5: .*folder of a.h5" replay --from a.h5 --at 1 --record elsewhere/x.h5
refused 1 "b.h5: continues a.h5, which is missing" replay elsewhere/b.h5 --verify
refused 2 "needs\|requires" live --from a.h5
refused 2 "defined by the recording" live --from a.h5 --at 1 --burr-radius 2
/usr/bin/python3 - <<'CHANGE'
import h5py
with h5py.File("d.h5") as f:
    s = f["settings"].attrs
    assert s["from.recording"] in (b"c.h5", "c.h5") and s["from.ticks"] == 1301 and 1.29 < s["from.time"] < 1.31, dict(s)
with h5py.File("a.h5", "r+") as f: f["columns/force_z_N"][700] += 1e-9
with open("a.h5", "r+b") as f: f.write(bytes(512))
CHANGE
refused 1 "a.h5: differs from tick 700 on" live --from a.h5 --at 0.9
[ ! -e x.csv ] && [ ! -e elsewhere/x.h5 ] || fault "something was written"
