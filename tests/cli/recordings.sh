#!/usr/bin/env bash
# Recordings of every kind replay bit for bit, or the reason is given; the recording of a killed program can be opened and lacks at
# most the last second; a full disk ends only the recording.
#   recordings.sh OSTEOMILL [KILLS]
set -euo pipefail
osteomill=$1
kills=${2:-3}
ball=$(cd "$(dirname "${BASH_SOURCE[0]}")/../window" && pwd)/ball.sh
folder=$(mktemp -d)
mounted=""
trap '[ -z "$mounted" ] || umount "$folder/small"; rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
same() { "$osteomill" replay "$@" --verify --quiet >said.txt 2>said.err || fault "$1: $(cat said.err)"; grep -q "^same: " said.txt || fault "$1"; }

"$osteomill" compare --seconds 1 --no-stability --quiet --cutting-reaction --passivity-controller --force-limit 2 --out c >/dev/null
for recording in c/*.h5; do same "$recording"; done
[ "$(ls c/*.h5 | wc -l)" -eq 8 ] || fault "there should be eight recordings"

# Replaying a hand motion with another algorithm also works, and a report shows both.
"$osteomill" replay c/line-proxy-milling.h5 --algorithm point-shell --stiffness 2 --quiet --out other.csv --record other.h5 >/dev/null
same other.h5
"$osteomill" report c/line-proxy-milling.h5 other.h5 --quiet --out both >/dev/null
"$osteomill" report c/line-proxy-milling.h5 --csv --quiet --out b >/dev/null
[ "$(wc -l <other.csv)" -eq "$(wc -l <b/line-proxy-milling.csv)" ] || fault "the log should have a head and a row a tick"
cmp -s <(cut -d, -f2-8 other.csv) <(cut -d, -f2-8 b/line-proxy-milling.csv) || fault "the hand's motion differs"
! cmp -s <(cut -d, -f16-21 other.csv) <(cut -d, -f16-21 b/line-proxy-milling.csv) || fault "another algorithm gave the same wrenches"

# Wrong inputs: another scan, a damaged one, options that a recording does not accept.
"$osteomill" save --out tooth.nrrd --quiet >/dev/null
"$osteomill" mesh --after c/line-proxy-holding.h5 --out after.ply --quiet >/dev/null || fault "the bone after both phases"
refused() { local reason=$1; shift; "$osteomill" replay "$@" --quiet >/dev/null 2>said.err && fault "$* was accepted"
  [ "$(wc -l <said.err)" -eq 1 ] && grep -q "$reason" said.err || fault "$*: $(cat said.err)"; }
"$osteomill" save --after c/line-proxy-milling.h5 --out milled.nrrd --quiet >/dev/null
same c/line-proxy-milling.h5 tooth.nrrd
refused "another scan" c/line-proxy-milling.h5 milled.nrrd --verify
refused "defined by the recording" c/line-proxy-milling.h5 --burr-radius 2 --out x.csv
refused "is not a recording" other.csv --verify
refused "nosuch.h5: no such file" nosuch.h5 --verify
mv c/line-proxy-milling.h5 c/away.h5
refused "line-proxy-milling.h5, which is missing" c/line-proxy-holding.h5 --verify

# Kills at any moment.
for ((n = 0; n < kills; ++n)); do
  __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null "$osteomill" live --record killed.h5 --seconds 600 --quiet --algorithm line-proxy >/dev/null 2>&1 &
  live=$!
  # Space is allocated just before the first ticks are written.
  for ((k = 0; k < 600; ++k)); do [ "$(stat -c %s killed.part.h5 2>/dev/null || echo 0)" -gt 600000 ] && break; sleep 0.05; done
  sleep $((RANDOM % 3)).$((RANDOM % 1000 + 1000))
  kill -9 $live
  wait $live 2>/dev/null || true
  same killed.part.h5
  rm killed.part.h5
done

# A disk of 1 MB if the machine allows one, otherwise a file size limit. The limit also applies to the bone's memory, so the
# scan is small.
mkdir small
bash "$ball" >ball.nrrd
if mount -t tmpfs -o size=1m none small 2>/dev/null; then mounted=yes; fi
limited() { if [ -n "$mounted" ]; then "$@"; else (ulimit -f 1024; exec "$@"); fi; }
code=0
limited "$osteomill" compare ball.nrrd --seconds 10 --algorithm line-proxy --no-stability --quiet --out small/c >said.txt 2>said.err || code=$?
[ $code -eq 1 ] && [ "$(wc -l <said.err)" -eq 1 ] && grep -qE "No space left on device|File too large" said.err || fault "compare on a full disk ended with $code: $(cat said.err)"
[ -z "$(find small -type f)" ] || fault "compare left $(find small -type f)"
code=0
limited "$osteomill" live ball.nrrd --seconds 12 --algorithm line-proxy --record small/live.h5 --quiet >said.txt 2>said.err || code=$?
[ $code -eq 1 ] && [ "$(wc -l <said.err)" -eq 1 ] || fault "live on a full disk ended with $code: $(cat said.err)"
grep -qE "small/live.part.h5: .*(No space left on device|File too large)" said.err || fault "live did not report the full disk: $(cat said.err)"
grep -q "^removed " said.txt || fault "live did not continue"
