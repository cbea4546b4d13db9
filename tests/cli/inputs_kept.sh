#!/usr/bin/env bash
# No command overwrites a file that it reads: tries every input file, given directly or through another file, as every output file,
# under another of its names.
#   inputs_kept.sh OSTEOMILL MAKE_A_BALL
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# Disables pictures, which take longest.
export __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null

fault() { echo "FAILED: $1"; exit 1; }
bash "$2" >ball.nrrd
sed -e '/^encoding/,$d' ball.nrrd >ball.nhdr
printf 'encoding: text\ndata file: ball.txt\n' >>ball.nhdr
sed -e '1,/^$/d' ball.nrrd >ball.txt
{ sed -e '/^encoding/,$d' ball.nrrd; printf 'encoding: text\ndata file: labels.txt\n'; } >labels.nhdr
sed -e 's/[0-9]*/1/' ball.txt >labels.txt
echo '1 bone 255 0 0 255' >table.txt
echo 'cutting-reaction = true' >c.toml
printf 'time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,0,0,30,1,0,0,0,0\n' >poses.csv
bash "$2" 4 >other.nrrd
labels="--labels labels.nhdr --label-table table.txt"
"$osteomill" compare ball.nhdr --iso 750 --seconds 0.1 --no-stability --algorithm line-proxy --quiet --out made >said
milling=made/line-proxy-milling.h5 holding=made/line-proxy-holding.h5

# Fails if an option for a file or folder is not covered here.
for command in simulate compare live rates replay report info mesh save exercise debrief; do
  for option in $("$osteomill" $command --help | grep -oE '^  --[a-z-]+ (FILE|FOLDER)' | awk '{ print $1 }'); do
    case "$command $option" in
      *" --labels" | *" --label-table" | *" --config" | *" --after" | *" --out" | *" --record" | *" --exercise" | *" --picture") ;;
      *) fault "$command $option: add it to this test" ;;
    esac
  done
done

# kept INPUTS WRITTEN COMMAND...: tries each of INPUTS as the file WRITTEN.
tried=0
kept() {
  local inputs=$1 written=$2
  shift 2
  for input in $inputs; do
    rm -rf out
    mkdir out
    ln "$input" "out/$written"
    local code=0
    timeout 60 "$osteomill" "$@" --quiet >said 2>error || code=$?
    [ $code -eq 1 ] && [ "$(wc -l <error)" -eq 1 ] && grep -q "out/[^ ]*: is an input file" error ||
      fault "$*: $input as out/$written: $code, $(cat error)"
    [ "out/$written" -ef "$input" ] || fault "$*: $input was written over as out/$written"
    [ -z "$(find out -name '*.writing-*')" ] || fault "$*: left $(find out)"
    tried=$((tried + 1))
  done
}
scan="ball.nhdr ball.txt" beside="labels.nhdr labels.txt table.txt"
trial="--seconds 0.1 --algorithm line-proxy --config c.toml --iso 750 $labels"
kept "$scan $beside c.toml" line-proxy-milling.h5 compare ball.nhdr $trial --no-stability --out out
kept c.toml report.html compare ball.nrrd --seconds 0.1 --algorithm line-proxy --config c.toml --no-stability --out out
kept "$scan $beside c.toml" a.h5 live ball.nhdr $trial --record out/a.h5
kept ball.txt a.part.h5 live ball.nhdr $trial --record out/a.h5
kept c.toml rates.csv rates ball.nhdr $trial --out out
kept "poses.csv $scan $beside c.toml" a.csv replay poses.csv ball.nhdr --algorithm line-proxy --config c.toml --iso 750 $labels --out out/a.csv
kept "$holding $milling $scan c.toml" a.csv replay "$holding" ball.nhdr --config c.toml --out out/a.csv
kept "$holding $milling $scan c.toml" a.h5 replay "$holding" ball.nhdr --config c.toml --record out/a.h5
kept "$holding ball.nhdr" a.csv replay "$holding" --out out/a.csv
printf 'title = "t"\nscan = "ball.nhdr"\niso = 750\n[target]\nbox = { min = [-99, -99, -99], max = [99, 99, 99] }\n' >e.toml
kept "poses.csv $scan e.toml" a.h5 replay poses.csv --exercise e.toml --record out/a.h5
"$osteomill" replay poses.csv --exercise e.toml --record e.h5 --quiet >/dev/null
kept "$scan e.toml" a.png exercise e.toml --picture out/a.png
kept "e.h5 $scan e.toml" debrief.csv debrief e.h5 --out out
kept "$milling $holding" report.html report "$milling" "$holding" --out out
kept "$milling" line-proxy-milling.csv report "$milling" --csv --out out
kept "$scan $beside $milling $holding" a.ply mesh ball.nhdr $labels --after "$holding" --out out/a.ply
kept "$scan $milling $holding" a.nrrd save ball.nhdr --after "$holding" --out out/a.nrrd
echo "$tried pairs"
