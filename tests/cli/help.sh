#!/usr/bin/env bash
# Help fits into 80 columns, and every option is in a named group.
set -euo pipefail
osteomill=$1

fault() { echo "FAILED: $1"; exit 1; }
for command in "" simulate compare live rates replay report info mesh save settings; do
  help=$("$osteomill" $command --help)
  wide=$(awk 'length > 80' <<<"$help")
  [ -z "$wide" ] || fault "$command --help is wider than 80 columns: $wide"
  twice=$(grep -oE '^  --[a-z-]+' <<<"$help" | sort | uniq -d || true)
  [ -z "$twice" ] || fault "$command --help lists twice: $twice"
done
help=$("$osteomill" compare --help)
for group in "Scan:" "Tool:" "Cutting:" "The hand and its device:" "Options:"; do
  grep -qx "$group" <<<"$help" || fault "compare --help has no group $group"
done
[ "$(sed -n '/^Tool:/,/^$/p' <<<"$help" | grep -c '^  --')" -eq 4 ] || fault "a tool has a name and three sizes"
sed -n '/^Tool:/,/^$/p' <<<"$help" | grep -q -- '--burr-radius mm .*\[1.5\]' || fault "unit or default is missing"
cpu=$(taskset -cp $$ | sed 's/.*: //; s/[-,].*//')
taskset -c "$cpu" "$osteomill" compare --help | sed -n '/--threads /,/\]/p' | grep -q '\[1\]$' || fault "one processor has more than one thread"
help=$("$osteomill" --help)
[ "$(grep -cE '^  (simulate|compare|live|rates|replay|report|info|mesh|save|settings) ' <<<"$help")" -eq 10 ] ||
  fault "--help does not list every command"
exit 0
