#!/usr/bin/env python3
"""Compares a debriefing's page with its table, and its marks with the script's actions.
    debrief_page.py FOLDER [STRUCTURE TIME_S X Y Z]     time and position of the first contact with the structure
    debrief_page.py FOLDER "removed outside" TIME_S X Y Z     time and position of the first removal outside the target
"""
import base64
import csv
import json
import math
import re
import struct
import sys
from html.parser import HTMLParser


class Page(HTMLParser):
    """Collects the cells of the table of items, and the page data."""

    def __init__(self):
        super().__init__()
        self.rows, self.data, self.loads, self.at, self.where = [], "", [], [], None

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.loads += [value for key, value in attributes.items() if key in ("src", "href") and not value.startswith("data:")]
        if tag == "link":
            self.loads.append(tag)
        if "id" in attributes:
            self.where = attributes["id"]
        self.at.append(tag)
        if tag == "tr" and self.where == "items":
            self.rows.append([])
        if tag in ("td", "th") and self.where == "items":
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        while self.at and self.at.pop() != tag:
            pass

    def handle_data(self, text):
        if "script" in self.at:
            self.data += text if self.where == "page-data" else ""
            self.where = None
        elif self.where == "items" and ("td" in self.at or "th" in self.at):
            self.rows[-1][-1] += text


def volume_mm3(body):
    """Returns the volume that a closed surface encloses, by Gauss's theorem."""
    raw, triangles = base64.b64decode(body["places"]), base64.b64decode(body["triangles"])
    steps = struct.unpack(f"<{len(raw) // 2}H", raw)
    corners = [[body["origin"][n] + body["step"] * steps[3 * v + n] for n in range(3)] for v in range(len(steps) // 3)]
    indices = struct.unpack(f"<{len(triangles) // 2}H", triangles)
    assert max(indices) < len(corners)
    total = 0
    for n in range(0, len(indices), 3):
        a, b, c = (corners[indices[n + k]] for k in range(3))
        total += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
    return total


folder = sys.argv[1]
text = open(folder + "/debrief.html", encoding="utf-8").read()
assert len(text.encode()) <= 5e6, len(text.encode())
page = Page()
page.feed(text)
assert page.loads == [], page.loads
data = json.loads(page.data)
rows = list(csv.DictReader(open(folder + "/debrief.csv", encoding="utf-8")))
value = {row["measure"]: float(row["value"]) for row in rows if row["value"]}

# Each item's mark agrees with its value and limit.
items = [row for row in rows if row["limit"]]
assert page.rows[0][:5] == ["item", "mark", "value", "threshold", "source"], page.rows[0]
assert len(page.rows) - 1 == len(items) > 0, page.rows
for cells, row in zip(page.rows[1:], items):
    assert [cells[0], cells[3], cells[4]] == [row["measure"], row["limit"], row["source"]], (cells, row)
    if not row["value"]:
        assert cells[1:3] == ["– not measured", "–"], cells
        continue
    number = float(row["value"])
    met = all(number >= float(limit) if relation == "least" else number <= float(limit)
              for relation, limit in re.findall(r"at (least|most) (\S+)", row["limit"]))
    assert cells[1] == ("✓ met" if met else "✗ not met"), (cells, row)
    assert math.isclose(float(cells[2].split()[0]), number, rel_tol=5e-4), (cells, row)

# The bodies have the measured volumes, slightly less because of rounded edges.
bodies = {}
for body in data["bodies"]:
    bodies.setdefault(body["kind"], body)
outside_mm3 = value["removed_outside_mm3"]
if outside_mm3 > 0:
    target_mm3 = 100 * outside_mm3 / value["removed_outside_percent"]
    assert 0.93 < volume_mm3(bodies["target"]) / target_mm3 < 1.06, (volume_mm3(bodies["target"]), target_mm3)
    left_mm3 = (1 - value["target_removed_percent"] / 100) * target_mm3
    if left_mm3 > 0.2 * target_mm3:
        assert 0.9 < volume_mm3(bodies["left"]) / left_mm3 < 1.06, (volume_mm3(bodies["left"]), left_mm3)
    # Smoothing the surface of a shell two voxels thick removes a third of its volume.
    assert 0.6 < volume_mm3(bodies["outside"]) / outside_mm3 < 1.05, (volume_mm3(bodies["outside"]), outside_mm3)
else:
    assert "outside" not in bodies
for body in data["bodies"]:
    if body["kind"] != "structure":
        continue
    thinnest = min(base64.b64decode(body["thickness"]))
    measured = value.get("thickness_left_min_mm." + body["name"])
    assert thinnest == 255 if measured is None else abs(thinnest / 31 - measured) <= 1 / 31, (body["name"], thinnest, measured)

# The progress curves end at the measured values, and every event has a mark.
assert math.isclose(data["progress"]["target"][-1], value["target_removed_percent"], rel_tol=1e-9)
marks = data["marks"]
for body in data["bodies"]:
    if body["kind"] == "structure":
        named = [mark for mark in marks if mark["title"].endswith(": contact with " + body["name"])]
        assert len(named) == value["no_go_contacts." + body["name"]], (body["name"], named)
taken = [float(dict(mark["facts"])["removed outside"].split()[0]) for mark in marks if mark["kind"] == "outside"]
assert math.isclose(sum(taken), outside_mm3, rel_tol=0.01, abs_tol=1e-9), (sum(taken), outside_mm3)
assert all(mark["command"].endswith(f" --at {mark['time']:.6f}") for mark in marks)

if len(sys.argv) > 2:
    structure, *numbers = sys.argv[2:]
    time_s, *place = map(float, numbers)
    kind = "outside" if structure == "removed outside" else "contact"
    mark = next(mark for mark in marks if mark["kind"] == kind and (kind == "outside" or mark["title"].endswith(": contact with " + structure)))
    away_mm = math.dist(mark["place"], place)
    print(f"  its mark lies {away_mm:.3f} mm and {1000 * (mark['time'] - time_s):.1f} ms beside the script's")
    assert away_mm <= 0.1 and abs(mark["time"] - time_s) <= 0.00101, (mark, time_s, place)
