#!/usr/bin/env bash
# Regression tests of inputs that were once handled wrongly: invalid input gives one line and exit code 1.
#   found.sh OSTEOMILL FOLDER
set -euo pipefail
osteomill=$1 found=$2
if [ ! -e "$found" ]; then
  echo "SKIPPED: needs $found, which is not on this machine"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
# EXIT REGEX COMMAND...: expects one line of error message within a minute.
told() {
  local code=0
  timeout 60 "${@:3}" >out.txt 2>err.txt || code=$?
  [ "$code" -eq "$1" ] || fault "${*:3}: exit code $code, expected $1: $(head -c 500 err.txt)"
  [ "$(wc -l <err.txt)" -eq 1 ] || fault "${*:3}: should be one line: $(head -c 500 err.txt)"
  grep -qE -- "$2" err.txt || fault "${*:3}: $(cat err.txt)"
}
# SCAN REGEX...: expects that the scan can be read, and matches of `info`.
read_as() {
  timeout 60 "$osteomill" info "$1" >out.txt 2>err.txt || fault "$1 should be read: $(cat err.txt)"
  for regex in "${@:2}"; do grep -qE -- "$regex" out.txt || fault "$1: no $regex in $(cat out.txt)"; done
}

told 1 "rle_segments_0/IM007.dcm: " "$osteomill" info "$found/rle_segments_0"
told 1 "rle_segments_7fffffff/IM005.dcm: " "$osteomill" info "$found/rle_segments_7fffffff"
told 1 "jpeg_abort/.*dcm: .*decoded" "$osteomill" info "$found/jpeg_abort"
# Both contain the same slices, compressed differently.
for codec in j2k jpegls; do
  read_as "$found/${codec}_two_fragments" "512 x 512 x 2" "^values +-2048 to 1433, mean -754.293$"
done
told 1 "icon: .*one slice" "$osteomill" info "$found/icon"
read_as "$found/nrrd_LAS.nrrd" "^origin +10, -20, 30 mm" "^i runs along 1, 0, 0" "^j runs along 0, -1, 0"
told 1 "nrrd_long_field.nrrd: " "$osteomill" info "$found/nrrd_long_field.nrrd"
told 1 "nrrd_ascii_long_token.nrrd: " "$osteomill" info "$found/nrrd_ascii_long_token.nrrd"
told 1 "spacing_1e-6.mha: .*voxels 1e-06 mm" "$osteomill" info "$found/spacing_1e-6.mha"
told 1 "spacing_1e-6.mha: .*voxels" "$osteomill" compare "$found/spacing_1e-6.mha" --iso 668 --out out
told 1 "spacing_1e308.mha: .*voxels 1e\\+308 mm" "$osteomill" info "$found/spacing_1e308.mha"
told 1 "direction_1e200.mha: .*TransformMatrix" "$osteomill" info "$found/direction_1e200.mha"
# Anisotropic voxels take no more work than cubes.
for spacing in "100 0.001 100" "1.2 0.001 1.7" "0.01 0.01 1"; do
  sed "s/^ElementSpacing = .*/ElementSpacing = $spacing/" "$found/spacing_100_0.001.mha" >long.mha
  timeout 5 "$osteomill" info long.mha >out.txt 2>err.txt || fault "voxels of $spacing mm: $(cat err.txt)"
done
told 1 "deep.toml: line 1: .*1000 parts" "$osteomill" compare --config "$found/deep.toml" --out out

# A scan with few values is not a label map: its bone is the same as with lifted values, which cannot be labels.
read_as "$found/few_values_phantom.nrrd" "^isovalue +[0-9]+ suggested" "^bone +112979 voxels"
grep -q "label" out.txt && fault "a phantom is read as labels"
# SHAPE OFFSET LIFT: a scan of air, one intermediate value and bone by a signed distance in voxels; LIFT is added to all values.
few_values() {
  printf 'NRRD0004\ntype: float\ndimension: 3\nsizes: 24 24 24\nspacings: 0.5 0.5 0.5\nencoding: ascii\n\n'
  awk -v shape="$1" -v offset="$2" -v lift="$3" 'function max(a, b) { return a > b ? a : b }
    BEGIN { for (k = 0; k < 24; ++k) for (j = 0; j < 24; ++j) for (i = 0; i < 24; ++i) {
      x = i - 11; y = j - 11; z = k - 11 - offset
      d = shape == "plane" ? (y + z) / sqrt(2) : shape == "edge" ? max(z, x + z) : sqrt(x * x + y * y + (z + 6) ^ 2) - 6
      print lift + 1000 * (d < -0.4 ? 2 : d > 0.4 ? 0 : 1)
    } }'
}
printf 'time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,5.6,5.6,10,1,0,0,0,0\n0.2,5.6,5.6,6.2,1,0,0,0,0\n' >press.csv
for shape in "plane 0" "edge 0.5" "ball 0.25"; do
  few_values $shape 0 >few.nrrd
  few_values $shape 0.5 >lifted.nrrd
  for algorithm in line-proxy surface-points point-shell barrier-shell; do
    "$osteomill" replay press.csv few.nrrd --iso 1000 --algorithm $algorithm --quiet --out few.csv >out.txt
    "$osteomill" replay press.csv lifted.nrrd --iso 1000.5 --algorithm $algorithm --quiet --out lifted.csv >out.txt
    awk -F, 'NR == 1 { for (n = 1; n <= NF; ++n) if ($n == "force_z_N") z = n } $z > 0.1 { felt = 1 } END { exit !(z && felt) }' few.csv ||
      fault "$algorithm feels nothing of the $shape"
    # Compares all columns except for times.
    cmp <(cut -d, -f-23 few.csv) <(cut -d, -f-23 lifted.csv) || fault "$shape of few values gives other results with $algorithm"
  done
done

# Labels detected from values, and set by options.
few_values ball 0 0 | sed 's/1000/0/; s/2000/7/' >mask.nrrd
read_as mask.nrrd "^isovalue +3.5 suggested" "^warning: looks like a label map: .*--as scan"
"$osteomill" info mask.nrrd --as scan | grep -q "label" && fault "--as scan does not decide"
"$osteomill" info few.nrrd --as labels | grep -q "^warning: is a label map" || fault "--as labels does not decide"
"$osteomill" info mask.nrrd --iso 3 | grep -q "label" && fault "a scan with --iso is read as labels"

# Very long header values and names, and trailing blanks.
head_of() { printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 1\nencoding: ascii\n'; }
long=$(printf 'x%.0s' $(seq 20000))
for field in kinds centers "measurement frame" "space units" labels; do
  { head_of; printf '%s: %s\n\n1 2 3 4 5 6 7 8\n' "$field" "$long"; } >long.nrrd
  code=0
  timeout 60 "$osteomill" info long.nrrd >out.txt 2>err.txt || code=$?
  [ "$code" -le 1 ] && [ "$(wc -l <err.txt)" -eq "$code" ] || fault "a long $field: $code, $(head -c 300 err.txt)"
done
blanks=$(printf ' %.0s' $(seq 5000))
printf 'NRRD0004\ntype: short%s\ndimension: 3\nsizes: 2 2 2%s\nspacings: 1 1 1\nspace: LPS%s\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: ascii\n\n1 2 3 4 5 6 7 8\n' \
  "$blanks" "$blanks" "$blanks" | grep -v spacings >blanks.nrrd
read_as blanks.nrrd "2 x 2 x 2"

mkfifo pipe
{ head_of | grep -v encoding; printf 'encoding: raw\nendian: little\ndata file: pipe\n'; } >pipe.nhdr
told 1 "pipe.nhdr: .*pipe .*regular file" "$osteomill" info pipe.nhdr
told 2 "scan: .*empty" "$osteomill" info ""
told 2 "--iso: .*empty" "$osteomill" info --iso ""
told 1 "new[?]line: no such file" "$osteomill" info "$(printf 'new\nline')"
{ printf '\xef\xbb\xbf'; cat "$found/p.csv"; } >mark.csv
timeout 60 "$osteomill" replay mark.csv --quiet --algorithm point-shell --out mark.log >out.txt || fault "a byte order mark is refused"
told 2 "--seed: -1 .*whole number" "$osteomill" compare --seed -1 --out out
exit 0
