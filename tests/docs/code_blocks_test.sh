#!/usr/bin/env bash
# Checks the code blocks of README.md and docs/: C++ compiles, studies and exercises can be read, Python runs on a comparison,
# MATLAB reads only what exists, and commands in indented lines have the options used. (CMake: the package test.)
#   code_blocks_test.sh SOURCE_DIR PROGRAM
set -euo pipefail
source=$1 osteomill=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
faults=0
fault() { echo "FAILED: $*"; faults=$((faults + 1)); }
pages=("$source"/README.md "$source"/docs/*.md)

# Writes the blocks to files PAGE.LINE.LANGUAGE
for page in "${pages[@]}"; do
  awk -v to="$folder/$(basename "$page" .md)" '
    /^```[a-z]+$/ { file = to "." NR "." substr($0, 4); next }
    /^```$/ { file = "" }
    file { print > file }' "$page"
done

flags=(-std=c++20 -fsyntax-only -w -DEIGEN_MAX_ALIGN_BYTES=16 -isystem /usr/include/eigen3)
for module in "$source"/osteomill/*/; do flags+=(-I "${module}include"); done
shopt -s nullglob
for block in "$folder"/*.cpp; do
  # Wraps a program fragment in a function that has the bone.
  if ! grep -q 'int main' "$block"; then
    { sed 's/.*/#include "&"/' <<'HEADERS'
osteomill/session/connected_device.h
osteomill/session/hardware.h
osteomill/base/real_time.h
osteomill/ct/read_scan.h
osteomill/live/live_milling.h
osteomill/session/milling_entry.h
osteomill/session/trajectory.h
osteomill/recording/replay_recording.h
osteomill/volume/bone_densities.h
osteomill/volume/builtin_tooth.h
HEADERS
      echo 'void part(const std::shared_ptr<osteomill::Volume>& bone) {'; cat "$block"; echo '}'; } >"$block.whole"
    mv "$block.whole" "$block"
  fi
  g++ "${flags[@]}" "$block" || fault "${block##*/} does not compile"
done
for block in "$folder"/*.toml; do
  if grep -q '^\[target\]' "$block"; then
    "$osteomill" exercise "$block" --check >/dev/null || fault "${block##*/} is not a valid exercise"
  else
    "$osteomill" study "$block" --list >/dev/null || fault "${block##*/} is not a valid study"
  fi
done

# Runs them in the folder with the comparison that they read.
cd "$folder"
"$osteomill" compare --algorithm point-shell --seconds 0.3 --out osteomill-comparison >compare.log 2>&1 ||
  { cat compare.log; fault "the comparison failed"; }
for block in *.python; do
  /usr/bin/python3 "$block" >"$block.out" && [ -s "$block.out" ] || fault "$block does not run"
done
for block in *.matlab; do
  /usr/bin/python3 - "$block" <<'CHECK' || fault "$block reads fields that do not exist"
import re, sys
import h5py
text = open(sys.argv[1]).read()
with h5py.File(re.search(r"^file = '(.+)';$", text, re.M)[1]) as f:
    read = [f[path][:] for path in re.findall(r"h5read\(file, '([^']+)'\)", text)]
    read += [f[path].attrs[name] for path, name in re.findall(r"h5readatt\(file, '([^']+)', '([^']+)'\)", text)]
assert len(read) == text.count("h5read"), "a reading is not understood"
CHECK
done
cd "$OLDPWD"
for block in "$folder"/*.[0-9]*.*; do
  [[ $block =~ \.(cpp|toml|python|matlab|out)$ ]] || fault "${block##*/} has an unknown language"
done
for language in cpp toml python matlab; do
  compgen -G "$folder/*.$language" >/dev/null || fault "no $language is found"
done

lines=0
while read -r program command rest; do
  [[ $command =~ ^[a-z]+$ ]] || continue
  help=$("$osteomill" "$command" --help 2>/dev/null) || { fault "no command: $program $command"; continue; }
  lines=$((lines + 1))
  for option in $(grep -oE -- '(^| )--[a-z-]+' <<<"${rest%%#*}" || true); do
    grep -qE -- "(^|[ ,])$option([ ,]|$)" <<<"$help" || fault "$command has no $option: $rest"
  done
done < <(sed -e ':join' -e '/\\$/{N;s/\\\n *//;b join' -e '}' "${pages[@]}" | grep -hE '^    (\$ )?(\./scripts/run|osteomill) ' | sed 's/^    \(\$ \)\?//; s/ [|;&].*//')
[ "$lines" -gt 5 ] || fault "only $lines commands are found"
[ "$faults" -eq 0 ]
