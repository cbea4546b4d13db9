#!/usr/bin/env bash
# A class of recordings gives a page and a table by name and attempt; unreadable files are listed and skipped; names are left out on
# request; five attempts of one person are compared.
#   debrief_class.sh OSTEOMILL
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fault() { echo "FAILED: $1"; exit 1; }
task() { cat <<TOML
title = "$1"
task = "Down to </script><script>alert(1)</script>"
scan = "builtin:layers"
[target]
box = { min = [-2, -2, -2], max = [2, 2, 0] }
[[no_go]]
name = "deep <layer>"
box = { min = [-5, -5, -7], max = [5, 5, -5] }
[[item]]
measure = "target_removed_percent"
at_least = 10
source = "a test"
TOML
}
task "Hole & <i>more</i>" >hole.toml
task Other >other.toml
# work FILE EXERCISE NAME DEPTH: records one plunge.
work() {
  awk -v depth="$4" 'BEGIN { print "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling"
    for (n = 0; n < 600; ++n) printf "%.3f,0,0,%.5f,1,0,0,0,1\n", n / 1000, 1.2 - n / 600 * (1.2 + depth) }' >poses.csv
  "$osteomill" replay poses.csv --exercise "$2.toml" --burr-radius 1 --trainee "$3" --removal-rate 400 --record "$1" --quiet >/dev/null
}
# Recordings are dated in whole seconds.
mkdir class
work class/1.h5 hole "Ann <b>" 0.2; sleep 1.1
work class/2.h5 hole "Ann <b>" 0.5; sleep 1.1
work class/3.h5 hole 'Bo, "B"' 0.8
work class/0.h5 other Cy 0.5
head -c 20000 class/1.h5 >class/cut.h5
# A user's file in the folder must stay.
mkdir all; echo "my notes" >all/progress.csv
debrief() { local code=0; "$osteomill" debrief "$@" --quiet >said 2>error || code=$?; echo $code; }
[ "$(debrief class --out all)" = 1 ] || fault "exit code"
[ "$(cat all/progress.csv)" = "my notes" ] || fault "a user's file is gone"
[ "$(wc -l <error)" -eq 2 ] && grep -q "^osteomill: class/cut.h5: " error && grep -q "^osteomill: class/0.h5: belongs to another exercise" error ||
  fault "$(cat error)"
/usr/bin/python3 - <<'CHECK' || fault "the class's table or page"
import csv, json, re
rows = list(csv.DictReader(open("all/debrief.csv")))
seen = [(r["name"], r["attempt"], r["recording"], float(r["value"]), r["met"]) for r in rows if r["measure"] == "target_removed_percent"]
assert [s[:3] for s in seen] == [("Ann <b>", "1", "class/1.h5"), ("Ann <b>", "2", "class/2.h5"), ('Bo, "B"', "1", "class/3.h5")], seen
assert seen[0][3] < seen[1][3] < seen[2][3] and [s[4] for s in seen] == ["yes" if s[3] >= 10 else "no" for s in seen], seen
page = open("all/debrief.html").read()
assert "Ann &lt;b&gt;" in page and "<b>" not in page and "alert(1)</script>" not in page and "<i>" not in page
assert "Not included: class/cut.h5" in page
data = json.loads(re.search(r'id="page-data">(.*?)</script>', page, re.S).group(1))
assert [len(curves) for curves in data["curves"]] == [2, 1]
CHECK
[ "$(debrief class --out none --anonymous)" = 1 ] || fault "exit code"
! grep -oE 'Ann|Bo,|class/|cut\.h5' none/* || fault "a name is left"
grep -q "^person 1,2,.*,,target_removed_percent," none/debrief.csv || fault "$(cat none/debrief.csv)"
[ "$(debrief class/1.h5 --out one --anonymous)" = 0 ] || fault "exit code"
! grep -oE 'Ann <|Ann &|class/' one/* || fault "a name is left"

# Two branches: the first continues down, the other up.
mkdir ways
awk 'BEGIN { print "time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling"
  for (n = 0; n < 400; ++n) printf "%.3f,0,0,%.5f,1,0,0,0,1\n", n / 1000, 0.8 + n / 1000 }' >up.csv
work ways/first.h5 hole Ann 0.8
"$osteomill" replay up.csv --from ways/first.h5 --at 0.25 --record ways/again.h5 --quiet >/dev/null
[ "$(debrief ways/again.h5 --out both)" = 0 ] && [ ! -s error ] || fault "$(cat error)"
grep -q "^continues ways/first.h5 at 0.250 s, after 251 ticks" said || fault "$(cat said)"
[ "$(debrief ways/first.h5 --out alone)" = 0 ] && [ "$(debrief ways/again.h5 --out nameless --anonymous)" = 0 ] || fault "exit code"
! grep -oE 'first\.h5|again\.h5|ways/(first|again)|[:>"]Ann' nameless/* said || fault "a name is left"
cp ways/again.h5 ways/far.h5
mv ways/first.h5 .
/usr/bin/python3 - <<'CHECK' || fault "the two ways"
import base64, csv, json, re, struct
page = open("both/debrief.html").read()
data = json.loads(re.search(r'id="page-data">(.*?)</script>', page, re.S).group(1))
floats = lambda text: struct.unpack(f"<{len(base64.b64decode(text)) // 4}f", base64.b64decode(text))
first, own = data["first"]["samples"], data["samples"]
assert abs(floats(first["time"])[0] - 0.25) < 1e-6 and abs(floats(first["time"])[-1] - 0.599) < 1e-6
assert abs(floats(own["time"])[-1] - 0.65) < 2e-3, floats(own["time"])[-1]
parting = [mark for mark in data["marks"] if mark["kind"] == "parting"]
assert len(parting) == 1 and abs(parting[0]["time"] - 0.25) < 1e-9 and "first.h5 --at 0.25" in parting[0]["command"], parting
assert parting[0]["facts"] == [["when", "0.250 s"], ["ticks in common", "251"]], parting
assert {body["choice"] for body in data["bodies"]} == {"this attempt", "the original"}
assert data["marks"] == sorted(data["marks"], key=lambda mark: mark["time"])
def value(folder):
    return next(float(row["value"]) for row in csv.DictReader(open(folder + "/debrief.csv")) if row["measure"] == "target_removed_percent")
cells = re.search(r"<tr><th>target_removed_percent</th><td>(.*?)</td><td>(.*?)</td>", page).groups()
shown = [float(re.search(r"[0-9.]+", cell)[0]) for cell in cells]
assert abs(shown[0] - value("both")) < 1e-3 * shown[0] and abs(shown[1] - value("alone")) < 1e-3 * shown[1] and shown[0] < shown[1], (shown, value("both"), value("alone"))
CHECK
[ "$(debrief ways/again.h5 --out lost)" = 1 ] && grep -q "^osteomill: ways/again.h5: continues first.h5, which is missing" error ||
  fault "$(cat error)"

# Compares the last attempt with the four before.
mkdir ann
for n in 1 2 3 4 5; do work ann/$n.h5 hole Ann "$(awk "BEGIN { print $n < 5 ? 0.3 + 0.01 * $n : 1.2 }")"; [ $n -eq 5 ] || sleep 1.1; done
[ "$(debrief ann --out ann5)" = 0 ] || fault "$(cat error)"
for n in 1 2 3 4 5; do "$osteomill" debrief ann/$n.h5 --out a$n --quiet >/dev/null; done
cmp a5/debrief.csv ann5/debrief.csv || fault "the last attempt differs"
/usr/bin/python3 - <<'CHECK' || fault "the spread"
import csv, re, statistics
def value(n, measure):
    return next(float(r["value"]) for r in csv.DictReader(open(f"a{n}/debrief.csv")) if r["measure"] == measure)
page = open("ann5/debrief.html").read()
spread = page[page.index('<div id="spread">'):]
for measure in ("target_removed_percent", "duration_s"):
    before = [value(n, measure) for n in range(1, 5)]
    # Student's t, 95 %, three degrees of freedom.
    width = 3.1824 * statistics.stdev(before) * (1 + 1 / 4) ** 0.5
    cells = re.search("<tr><th>" + measure + "</th><td>(.*?) .*?</td><td>(.*?)</td><td>(.*?)</td><td>(.*?)</td>", spread).groups()
    assert abs(float(cells[1]) - statistics.mean(before)) <= 1e-3 * statistics.mean(before), cells
    assert abs(float(cells[2].split()[1]) - width) <= 0.01 * width + 1e-9, (cells, width)
    differs = abs(value(5, measure) - statistics.mean(before)) > width
    assert ("yes" in cells[3]) == differs == (measure == "target_removed_percent"), cells
CHECK
echo "ok"
