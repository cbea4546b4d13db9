#!/usr/bin/env python3
"""Writes the poses of a scripted session: the burr sweeps a box or an upright cylinder in layers from above.
    exercise_poses.py box XMIN YMIN ZMIN XMAX YMAX ZMAX BURR_RADIUS SPEED >poses.csv
    exercise_poses.py cylinder X Y ZMIN ZMAX RADIUS BURR_RADIUS SPEED >poses.csv
    exercise_poses.py crown ZMIN ZFLAT ZMAX RADIUS RADIUS_TO OUTER BURR_RADIUS SPEED >poses.csv
                         around a stump about (0, 0): RADIUS at ZMIN, RADIUS_TO at ZFLAT, bone out to OUTER
    exercise_poses.py plunge X Y ZFROM ZTO SPEED >poses.csv
Lengths are in mm, the speed in mm/s; one pose per millisecond.
"""
import math
import sys

kind, numbers = sys.argv[1], [float(n) for n in sys.argv[2:]]
corners = []
if kind == "plunge":
    x, y, z_from, z_to, speed = numbers
    corners = [(x, y, z_from), (x, y, z_to)]
elif kind == "crown":
    bottom, flat, top, radius, radius_to, outer, burr, speed = numbers
    # Layers down to the flat top, and then down to the shoulder.
    upper = math.ceil((top - flat) / (0.6 * burr))
    lower = math.ceil((flat - bottom) / (0.5 * burr))
    heights = [top + burr + (flat - top) * n / upper for n in range(1, upper + 1)]
    heights += [flat + burr + (bottom - flat) * n / lower for n in range(1, lower + 1)]
    for z in heights:
        # Position of the burr's centre beside the wall, or beside the edge of the top.
        wall = radius + (radius_to - radius) * (z - bottom) / (flat - bottom)
        inner = 0 if z >= flat + burr - 1e-9 else wall + burr * 1.0025
        if flat <= z < flat + burr - 1e-9:
            inner = radius_to + math.sqrt(burr ** 2 - (z - flat) ** 2)
        rings = max(1, math.ceil((outer - inner) / (0.5 * burr)))
        for ring in range(rings + 1):
            r = outer + (inner - outer) * ring / rings
            for step in range(65):
                a = 2 * math.pi * step / 64
                corners.append((r * math.cos(a), r * math.sin(a), z))
    corners.insert(0, (*corners[0][:2], top + 3 * burr))
    corners.append((corners[-1][0] + 2, *corners[-1][1:]))
else:
    *shape, burr, speed = numbers
    if kind == "box":
        x0, y0, bottom, x1, y1, top = shape
        middle, half = ((x0 + x1) / 2, (y0 + y1) / 2), ((x1 - x0) / 2 - burr, (y1 - y0) / 2 - burr)
    else:
        x, y, bottom, top, radius = shape
        middle, half = (x, y), (radius - burr, radius - burr)
    layers = max(1, math.ceil((top - bottom - burr) / (0.6 * burr)))
    for layer in range(1, layers + 1):
        z = top - (top - bottom - burr) * layer / layers
        if kind == "cylinder":
            rings = max(1, math.ceil(half[0] / (0.5 * burr)))
            for ring in range(rings + 1):
                r = half[0] * ring / rings
                for step in range(65):
                    a = 2 * math.pi * step / 64
                    corners.append((middle[0] + r * math.cos(a), middle[1] + r * math.sin(a), z))
        else:
            lines = max(1, math.ceil(2 * half[1] / (0.5 * burr)))
            for line in range(lines + 1):
                y = middle[1] - half[1] + 2 * half[1] * line / lines
                ends = (-half[0], half[0]) if line % 2 == 0 else (half[0], -half[0])
                corners += [(middle[0] + end, y, z) for end in ends]
            # Once around along the walls.
            corners += [(middle[0] + i * half[0], middle[1] + j * half[1], z)
                        for i, j in ((1, 1), (-1, 1), (-1, -1), (1, -1), (1, 1))]
    first = corners[0]
    corners.insert(0, (first[0], first[1], top + 3 * burr))
    corners.append((corners[-1][0], corners[-1][1], top + 3 * burr))

print("time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling")
tick = 0
for a, b in zip(corners, corners[1:]):
    steps = max(1, round(math.dist(a, b) / speed * 1000))
    for step in range(steps):
        x, y, z = (a[n] + (b[n] - a[n]) * step / steps for n in range(3))
        print(f"{tick / 1000:.3f},{x:.6f},{y:.6f},{z:.6f},1,0,0,0,1")
        tick += 1
