#!/usr/bin/env bash
# A short comparison writes all its files; the report made from its recordings is equal; and the same seed gives the same numbers
# except for times.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
# Prints the columns of summary.csv except for times.
untimed() { cut -d, -f1-3,8-21 "$1"; }

"$osteomill" compare --seconds 1 --no-stability --out a >a.out
grep -q "a/report.html" a.out || fault "the report's path is not the output"
for file in report.html summary.csv figures/fig7_force.svg figures/fig7_force.png; do
  [ -s "a/$file" ] || fault "no $file"
done
[ "$(wc -l <a/summary.csv)" -eq 9 ] || fault "summary.csv should have a head and eight rows"
[ "$(ls a/*.h5 | wc -l)" -eq 8 ] || fault "there should be eight recordings"
# three.js contains addresses in comments and warnings, but loads none by itself.
/usr/bin/python3 -c 'import re, sys; text = re.sub(r"<script>.*?</script>|http://www.w3.org/[^\"]*", "", open("a/report.html").read(), flags=re.S); sys.exit("http://" in text or "https://" in text)' ||
  fault "report.html reaches for the network"

"$osteomill" report a/*.h5 --csv --out b >b.out
[ "$(head -n 2 a/summary.csv | tail -n 1 | cut -d, -f7)" != "" ] || fault "the ticks' CPU time was not measured"
[ "$(wc -l <b/point-shell-holding.csv)" -eq 1001 ] || fault "the CSV should have a head and a row a tick"
cmp a/summary.csv b/summary.csv || fault "the report made from recordings differs"

code=0
PATH=/nowhere "$osteomill" report a/*.h5 --csv --quiet --out g 2>g.err || code=$?
[ $code -eq 1 ] && grep -q "^osteomill: gnuplot: is not installed" g.err || fault "without gnuplot: $code, $(cat g.err)"
[ ! -e g ] || fault "a report that failed left $(find g)"

grep -q "No pictures of the bone" a/report.html && fault "pictures are missing"
__EGL_VENDOR_LIBRARY_FILENAMES=/dev/null "$osteomill" compare --seconds 1 --no-stability --out e >e.out 2>e.err
[ "$(grep -c "no pictures of the bone are recorded: no OpenGL" e.err)" -eq 1 ] ||
  fault "without OpenGL one line should say so"
grep -q "No pictures of the bone: OpenGL" e/report.html || fault "the report does not say why it has no pictures"
[ ! -e e/figures/bone.png ] && [ -s a/figures/bone.png ] || fault "pictures without OpenGL"
diff <(untimed a/summary.csv) <(untimed e/summary.csv) || fault "the same seed gave other numbers"
"$osteomill" compare --seconds 1 --seed 2 --algorithm point-shell --out d >d.out
[ "$(wc -l <d/stability.csv)" -eq 13 ] && [ -s d/figures/stability.svg ] || fault "stability.csv should have a head and 12 rows"
[ "$(wc -l <d/summary.csv)" -eq 3 ] || fault "one algorithm, two phases"
"$osteomill" report d/*.h5 --quiet --out h >h.out
for file in report.html stability.csv; do cmp d/$file h/$file || fault "the report made again has another $file"; done
diff <(untimed a/summary.csv | grep point-shell) <(untimed d/summary.csv | grep point-shell) >/dev/null &&
  fault "another seed gave the same numbers"
"$osteomill" compare --seconds 0.3 --match-stiffness --no-stability --out f >f.out 2>f.err
grep -q "Stiffness is matched: .* felt as [0-9.]* N/mm" f/report.html || fault "the report should say that stiffness is matched"
# The felt stiffness of algorithm 2 jumps past that of the softest.
grep -q "^osteomill: warning: left out: surface-points cannot be felt as" f.err || fault "the unmatched algorithm is not named: $(cat f.err)"
grep -q "Left out of this comparison: surface-points cannot be felt as" f/report.html || fault "the report misses an algorithm in silence"
[ "$(cut -d, -f1 f/summary.csv | sort -u | wc -l)" -eq 4 ] || fault "three algorithms should be compared"
grep -q "matched.felt_stiffness" f/report.html || fault "the settings lack the felt stiffness"
grep -q "Stiffness is not matched" a/report.html || fault "the report should say that stiffness is not matched"
# The bones in 3D: one before, and one after each algorithm, each smaller by about the removed volume.
/usr/bin/python3 - <<'CHECK' || fault "the bones in 3D"
import base64, csv, json, re, struct
text = open("a/report.html", encoding="utf-8").read()
assert len(text.encode()) <= 5e6, len(text.encode())
data = json.loads(re.search(r'id="page-data">(.*?)</script>', text, re.S).group(1))
assert "Osteomill.showBone(" in text
def volume_mm3(body):
    raw, triangles = base64.b64decode(body["places"]), base64.b64decode(body["triangles"])
    steps = struct.unpack(f"<{len(raw) // 2}H", raw)
    # Relative to the hole, to keep precision.
    corners = [[body["origin"][n] + body["step"] * steps[3 * v + n] - data["focus"][n] for n in range(3)] for v in range(len(steps) // 3)]
    indices = struct.unpack(f"<{len(triangles) // 2}H", triangles)
    total = 0
    for n in range(0, len(indices), 3):
        a, b, c = (corners[indices[n + k]] for k in range(3))
        total += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
    return total
volumes = {body["choice"]: volume_mm3(body) for body in data["bodies"]}
removed = {row["algorithm"]: float(row["removed_mm3"]) for row in csv.DictReader(open("a/summary.csv")) if row["phase"] == "milling"}
assert len(volumes) == 5 and volumes["before"] > 100, volumes
for choice, volume in volumes.items():
    if choice == "before":
        continue
    said = re.fullmatch(r"after \d (\S+) \(([0-9.]+) mm³ removed\)", choice)
    assert abs(float(said[2]) - removed[said[1]]) <= 0.051, (choice, removed)
    # `removed` counts bone of the reference density, `gone` is the volume inside the surface, so the two differ.
    gone = volumes["before"] - volume
    assert abs(gone - removed[said[1]]) < 0.5 * removed[said[1]] + 0.02 * volumes["before"], (choice, gone)
CHECK
# Without the scan, the report states what is missing.
"$osteomill" save builtin:layers --out l.nrrd --quiet >/dev/null
awk 'BEGIN { print "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling"
  for (n = 0; n < 400; ++n) printf "%.3f,0,0,%.4f,1,0,0,0,1\n", n / 1000, 1.7 - 0.003 * n }' >down.csv
"$osteomill" replay down.csv l.nrrd --record r.h5 --removal-rate 400 --quiet >/dev/null
"$osteomill" report r.h5 --out r --quiet >/dev/null
grep -q "Osteomill.showBone" r/report.html || fault "no bone in 3D"
rm l.nrrd
"$osteomill" report r.h5 --out r --quiet >/dev/null
grep -q "No bone in 3D: l.nrrd: " r/report.html && ! grep -q "showBone" r/report.html || fault "the report does not say that the scan is missing"
find . -name '*.writing-*' -o -name '*.part.*' | grep -q . && fault "left a half-written file"
exit 0
