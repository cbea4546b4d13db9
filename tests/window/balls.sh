#!/usr/bin/env bash
# Prints a scan of three pieces of bone in voxels of 0.5 mm: a ball of 5 mm around (6, 7.75, 7.75) mm, one of 1.5 mm around (17,
# 7.75, 7.75) mm, and a single voxel:
#   balls.sh >balls.nrrd
printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 40 32 32\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
awk 'function share(radius, middle) { return radius - 0.5 * sqrt((i - middle)^2 + (j - 15.5)^2 + (k - 15.5)^2) + 0.5 }
  BEGIN { for (k = 0; k < 32; ++k) for (j = 0; j < 32; ++j) for (i = 0; i < 40; ++i) {
    most = share(5, 12); small = share(1.5, 34); most = small > most ? small : most
    if (i == 38 && j == 2 && k == 2) most = 1
    print int(1500 * (most < 0 ? 0 : most > 1 ? 1 : most)) } }'
