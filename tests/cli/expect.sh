#!/usr/bin/env bash
# Runs one command line in an empty folder and compares its exit code and output with the expected ones:
#   expect.sh EXIT STDOUT_REGEX STDERR_REGEX [NEEDS] -- SETUP -- COMMAND...
# An empty regex expects no output, "*" accepts any. SETUP is shell code that makes the files of the case, or "". If the path NEEDS
# is missing, the case is skipped (exit 77, after a message).
set -euo pipefail
exit_expected=$1 stdout_expected=$2 stderr_expected=$3 needs=$4 setup=$5
shift 5

if [ -n "$needs" ] && [ ! -e "$needs" ]; then
  echo "SKIPPED: needs $needs, which is not on this machine"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
eval "$setup"

code=0
timeout 240 "$@" >"$folder/.stdout" 2>"$folder/.stderr" </dev/null || code=$?

fault() { echo "FAILED: $1"; echo "--- standard output"; head -c 3000 .stdout; echo "--- standard error"; head -c 3000 .stderr; exit 1; }
check() {  # NAME REGEX FILE
  case "$2" in
    "*") ;;
    "") [ ! -s "$3" ] || fault "$1 should be empty" ;;
    *) grep -qE -- "$2" "$3" || fault "$1 does not match: $2" ;;
  esac
}
[ "$code" -eq "$exit_expected" ] || fault "exit code $code, expected $exit_expected"
check "standard output" "$stdout_expected" .stdout
check "standard error" "$stderr_expected" .stderr
if [ "$exit_expected" -eq 1 ] && [ "$(wc -l <.stderr)" -ne 1 ]; then
  fault "invalid input should give one line"
fi
# A failed command leaves no partial files.
if [ "$exit_expected" -ne 0 ] && find . -name '*.writing-*' -o -name '*.part.*' | grep -q .; then
  fault "left a half-written file"
fi
