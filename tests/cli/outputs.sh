#!/usr/bin/env bash
# Existing outputs keep their kind: a link stays a link, a device a device. A full disk gives one line and leaves no files.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
mounted=""
trap '[ -z "$mounted" ] || umount "$folder/small"; rm -rf "$folder"' EXIT
cd "$folder"

fault() { echo "FAILED: $1"; exit 1; }
printf 'time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,0,0,30,1,0,0,0,0\n0.001,0,0,30,1,0,0,0,1\n' >poses.csv
replay() { "$osteomill" replay poses.csv --quiet --algorithm line-proxy --out "$1" >out.txt 2>err.txt; }

replay log.csv
echo old >real.csv
ln -s real.csv link.csv
replay link.csv
[ -L link.csv ] || fault "the link was replaced"
[ "$(wc -l <real.csv)" -eq 3 ] || fault "the link's target was not written"

mkfifo pipe.csv
replay pipe.csv && fault "writing to a pipe without a reader succeeded"
grep -q "^osteomill: pipe.csv: .*pipe" err.txt || fault "a pipe that no program reads: $(cat err.txt)"
replay >(cat >read.csv)
wait $!
[ "$(wc -l <read.csv)" -eq 3 ] || fault "the pipe's reader got nothing"

# A copy of /dev/null, if the machine allows it.
if mknod -m 666 null.csv c 1 3 2>err.txt; then
  replay null.csv
  [ -c null.csv ] || fault "the device was replaced"
else
  echo "no devices can be made here, so none was written to"
fi

# A recording is refused if its path exists and is not a regular file, which stays. In a read-only folder it leaves no files.
[ ! -c null.csv ] || mv null.csv null.h5
mkdir locked
chmod 555 locked
for out in pipe.csv null.h5 locked/a.h5; do
  [ -e "$out" ] || [ "$(id -u)" -ne 0 -a "$out" = locked/a.h5 ] || continue
  code=0
  "$osteomill" live --quiet --seconds 0.2 --algorithm line-proxy --record "$out" >out.txt 2>err.txt || code=$?
  [ "$code" -eq 1 ] && [ "$(wc -l <err.txt)" -eq 1 ] || fault "a recording to $out: exit code $code, $(cat err.txt)"
  [ ! -f "$out" ] || fault "$out was replaced"
done
[ -z "$(ls locked)" ] || fault "something was left in a folder that may not be written"

mkdir small
for size in 100k 400k 3m; do
  if ! mount -t tmpfs -o size=$size none small 2>err.txt; then
    echo "no small disk can be mounted here, so none was filled"
    break
  fi
  mounted=yes
  code=0
  timeout 120 "$osteomill" compare --seconds 4 --quiet --algorithm line-proxy --no-stability --out small/out >out.txt 2>err.txt ||
    code=$?
  [ "$code" -eq 1 ] || fault "a disk of $size: exit code $code, $(cat err.txt)"
  [ "$(wc -l <err.txt)" -eq 1 ] || fault "a disk of $size: $(cat err.txt)"
  umount small
  mounted=""
done
exit 0
