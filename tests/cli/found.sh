#!/usr/bin/env bash
# Inputs that were once got wrong, each kind as it should be now: an input at fault is one line and exit code 1.
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
# EXIT REGEX COMMAND...: what a user is told, in one line, within a minute: none hangs.
told() {
  local code=0
  timeout 60 "${@:3}" >out.txt 2>err.txt || code=$?
  [ "$code" -eq "$1" ] || fault "${*:3}: exit code $code, expected $1: $(head -c 500 err.txt)"
  [ "$(wc -l <err.txt)" -eq 1 ] || fault "${*:3}: should be one line: $(head -c 500 err.txt)"
  grep -qE -- "$2" err.txt || fault "${*:3}: $(cat err.txt)"
}
# SCAN REGEX...: is read, and `info` says so.
read_as() {
  timeout 60 "$osteomill" info "$1" >out.txt 2>err.txt || fault "$1 should be read: $(cat err.txt)"
  for regex in "${@:2}"; do grep -qE -- "$regex" out.txt || fault "$1: no $regex in $(cat out.txt)"; done
}

told 1 "rle_segments_0/IM007.dcm: " "$osteomill" info "$found/rle_segments_0"
told 1 "rle_segments_7fffffff/IM005.dcm: " "$osteomill" info "$found/rle_segments_7fffffff"
told 1 "jpeg_abort/.*dcm: cannot be decoded" "$osteomill" info "$found/jpeg_abort"
# Both hold the same slices, in another compression each.
for codec in j2k jpegls; do
  read_as "$found/${codec}_two_fragments" "512 x 512 x 2" "^values +-2048 to 1433, mean -754.293$"
done
told 1 "icon: only one slice" "$osteomill" info "$found/icon"
read_as "$found/nrrd_LAS.nrrd" "^origin +10, -20, 30 mm" "^i runs along 1, 0, 0" "^j runs along 0, -1, 0"
told 1 "nrrd_long_field.nrrd: " "$osteomill" info "$found/nrrd_long_field.nrrd"
told 1 "nrrd_ascii_long_token.nrrd: " "$osteomill" info "$found/nrrd_ascii_long_token.nrrd"
told 1 "spacing_1e-6.mha: has voxels 1e-06 mm apart" "$osteomill" info "$found/spacing_1e-6.mha"
told 1 "spacing_1e-6.mha: has voxels" "$osteomill" compare "$found/spacing_1e-6.mha" --iso 668 --out out
told 1 "spacing_1e308.mha: has voxels 1e\\+308 mm apart" "$osteomill" info "$found/spacing_1e308.mha"
told 1 "deep.toml: line 1: has a name of over 1000 parts" "$osteomill" compare --config "$found/deep.toml" --out out

# Values and names that a header gives at length, and blanks at a line's end.
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
told 1 "pipe.nhdr: its data file pipe is no regular file" "$osteomill" info pipe.nhdr
told 2 "scan: is empty" "$osteomill" info ""
told 2 "--iso: is empty" "$osteomill" info --iso ""
told 1 "new[?]line: no such file" "$osteomill" info "$(printf 'new\nline')"
{ printf '\xef\xbb\xbf'; cat "$found/p.csv"; } >mark.csv
timeout 60 "$osteomill" replay mark.csv --quiet --algorithm point-shell --out mark.log >out.txt || fault "a byte order mark is refused"
told 2 "--seed: -1 is not a whole number" "$osteomill" compare --seed -1 --out out
exit 0
