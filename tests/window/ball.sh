#!/usr/bin/env bash
# Prints a scan of a ball of bone with a radius of 5 mm, in voxels of 0.5 mm, small enough to open and draw without delay.
#   ball.sh [RADIUS_MM] >ball.nrrd
printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 32 32 32\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
awk -v radius="${1:-5}" 'BEGIN {
  for (k = 0; k < 32; ++k) for (j = 0; j < 32; ++j) for (i = 0; i < 32; ++i) {
    share = radius - 0.5 * sqrt((i - 15.5)^2 + (j - 15.5)^2 + (k - 15.5)^2) + 0.5
    print int(1500 * (share < 0 ? 0 : share > 1 ? 1 : share))
  }
}'
