#!/usr/bin/env bash
# Files and folders in use or with contents are never overwritten by another process, even with closed or full standard streams; a
# terminated program leaves no partial files.
#   nothing_lost.sh OSTEOMILL BALL.SH
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export TMPDIR=$folder/tmp __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null
mkdir tmp
bash "$2" >ball.nrrd
bone=(ball.nrrd --iso 750 --burr-radius 1 --shaft-radius 0.5)
live=("$osteomill" live "${bone[@]}" --quiet --algorithm line-proxy)

fault() { echo "FAILED: $1"; exit 1; }
until_there() { for ((k = 0; k < 1200; ++k)); do [ ! -e "$1" ] || return 0; sleep 0.05; done; fault "no $1"; }
runs() { # EXIT STDERR-REGEX COMMAND...: an empty regex expects silence
  local exit=$1 regex=$2 code=0
  shift 2
  "$@" >said.out 2>said.err || code=$?
  [ "$code" -eq "$exit" ] || fault "$*: exit code $code, $(cat said.err)"
  if [ -z "$regex" ]; then [ ! -s said.err ] || fault "$*: $(cat said.err)"; else
    [ "$(wc -l <said.err)" -eq 1 ] && grep -qE -- "$regex" said.err || fault "$*: $(cat said.err)"; fi
}

# Two recorders of the same file: the second is refused, the first is not affected.
"${live[@]}" --seconds 4 --record r.h5 >first.out 2>first.err &
first=$!
until_there r.part.h5
sleep 0.5
runs 1 "^osteomill: r.part.h5: another program is writing to it$" "${live[@]}" --seconds 0.5 --record r.h5
wait $first || fault "the first recorder: $(cat first.err)"
runs 0 "" "$osteomill" replay r.h5 ball.nrrd --verify --quiet
[ ! -e r.part.h5 ] || fault "a part is left"

# The unfinished recording of a killed program stays.
"${live[@]}" --seconds 600 --record r.h5 >first.out 2>first.err &
first=$!
until_there r.part.h5
sleep 2
kill -9 $first
wait $first 2>/dev/null || true
cp r.part.h5 left.h5
runs 0 "^osteomill: warning: r.part.h5: .*kept as r.part-1.h5$" "${live[@]}" --seconds 0.5 --record r.h5
cmp left.h5 r.part-1.h5 || fault "the unfinished recording has changed"
runs 0 "" "$osteomill" replay r.part-1.h5 ball.nrrd --verify --quiet

# A folder has one owner.
compare=("$osteomill" compare "${bone[@]}" --quiet --algorithm line-proxy --no-stability)
"${compare[@]}" --seconds 8 --out c >first.out 2>first.err &
first=$!
until_there c
sleep 0.2
runs 1 "^osteomill: c: another program is writing to it$" "${compare[@]}" --seconds 0.2 --out c
runs 1 "^osteomill: c: another program is writing to it$" "$osteomill" rates "${bone[@]}" --quiet --out c
runs 1 "^osteomill: c: another program is writing to it$" "$osteomill" report r.h5 --quiet --out c
wait $first || fault "the first comparison: $(cat first.err)"
[ -e c/report.html ] && [ -e c/line-proxy-holding.h5 ] || fault "the first comparison is not whole: $(ls c)"

# The descriptors of closed streams are not reused for files.
"$osteomill" mesh "${bone[@]:0:3}" --out a.ply >said.out 2>said.err
"$osteomill" mesh "${bone[@]:0:3}" --out b.ply >&- 2>&- <&- || fault "a mesh with closed streams"
cmp a.ply b.ply || fault "closed streams make another mesh"
(ulimit -f 64; exec "$osteomill" save ball.nrrd --out c.nrrd 2>&-) && fault "a save beyond the file size limit succeeded"
"${live[@]}" --seconds 0.5 --push 6 --record closed.h5 >&- 2>&- || fault "a recording with closed streams"
runs 0 "" "$osteomill" replay closed.h5 ball.nrrd --verify --quiet

# A message that cannot be written is dropped; failing output is an error.
for words in "0 info ball.nrrd" "1 info none.nrrd" "2 info --iso x" "0 mesh ball.nrrd --out a.ply"; do
  code=0
  "$osteomill" ${words#* } >said.out 2>/dev/full || code=$?
  [ $code -eq "${words%% *}" ] || fault "$words 2>/dev/full: $code"
done
for words in "info ball.nrrd --json" "info ball.nrrd" settings devices --help --version "study --help" "mesh ball.nrrd --iso 750 --out a.ply" \
  "save ball.nrrd --out a.nrrd" "report r.h5 --out rep --quiet" "rates --help"; do
  code=0
  "$osteomill" $words >/dev/full 2>said.err || code=$?
  [ $code -eq 1 ] && grep -q "^osteomill: standard output: cannot be written" said.err || fault "$words > /dev/full: $code, $(cat said.err)"
  code=0
  "$osteomill" $words >/dev/full 2>/dev/full || code=$?
  [ $code -eq 1 ] || fault "$words > /dev/full 2>/dev/full: $code"
done
code=0
"${live[@]}" --seconds 0.5 --record full.h5 >/dev/full 2>/dev/full || code=$?
[ $code -eq 1 ] && [ -e full.h5 ] || fault "live > /dev/full: $code"

# A terminated program leaves no files.
if command -v zip >/dev/null; then
  zip -q ball.zip ball.nrrd
  for signal in TERM HUP; do  # Background processes of the shell ignore INT.
    setsid "$osteomill" compare ball.zip "${bone[@]:1}" --quiet --seconds 600 --algorithm line-proxy --out stopped >said.out 2>said.err &
    first=$!
    until_there stopped
    sleep 0.5
    kill -$signal $first
    code=0
    wait $first || code=$?
    [ $code -gt 128 ] || fault "SIG$signal: $code"
    [ -z "$(ls -A tmp)" ] && [ -z "$(find . -name '*.writing-*' -o -path './stopped/*.part*')" ] || fault "SIG$signal left $(find tmp stopped)"
  done
fi

# A study's folder.
cat >study.toml <<TOML
[fixed]
scan = "ball.nrrd"
iso = 750
burr-radius = 1
shaft-radius = 0.5
seconds = 0.2
algorithm = "line-proxy"
[grid]
push = [0.5, 1.5]
TOML
"$osteomill" study study.toml --out s --slices 2 --quiet >said.out 2>said.err
mkdir bin
printf '#!/bin/sh\necho MaxArraySize = 100\n' >bin/scontrol
printf '#!/bin/sh\necho 1\n' >bin/sbatch
chmod +x bin/*
export PATH=$PATH:$folder/bin
runs 1 "sbatch cannot handle" "$osteomill" study study.toml --out $'two\nlines' --on slurm
[ ! -e $'two\nlines' ] || fault "a folder that cannot be submitted was made"
mv s/slice-0.h5 kept.h5
mkfifo s/slice-0.h5
runs 0 "" timeout 20 "$osteomill" study s --status
grep -q "slice-0.h5 cannot be used" said.out || fault "a slice that is a pipe: $(cat said.out)"
rm s/slice-0.h5
mv kept.h5 s/slice-0.h5
rm s/study.h5
mkfifo s/study.h5
runs 1 "^osteomill: s/study.h5: is not a file$" timeout 20 "$osteomill" study s --status
exit 0
