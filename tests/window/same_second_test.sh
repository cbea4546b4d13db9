#!/usr/bin/env bash
# Two windows that record and save into one folder in the same second write separate files:
#   same_second_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
fail() { echo "FAILED: $1"; cat said-* errors-*; exit 1; }
"$here/ball.sh" >ball.nrrd

# Each waits until the other is running.
for n in 1 2; do
  printf '%s\n' "wait 0.2" "say ready" "await go" "click Record" "wait 0.3" "state recording" "click Save picture" \
    "wait 0.3" "state saved" "click Stop recording" "wait 0.2" "state recorded" close >actions-$n
done
cat >both <<'END'
for n in 1 2; do
  "$1" simulate ball.nrrd --no-help --out out --script actions-$n >said-$n 2>errors-$n & programs+=($!)
done
for n in 1 2; do
  until grep -q "^ready: " said-$n || ! kill -0 "${programs[n - 1]}"; do sleep 0.05; done
done
touch go
wait "${programs[0]}" && wait "${programs[1]}"
END
xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 bash both "$osteomill" || fail "exit code $?"
for n in 1 2; do
  grep -qx "recording.recording=true" said-$n || fail "window $n does not record"
  ! grep -q "\.dialogue=." said-$n || fail "window $n complains"
done
[ "$(ls out/*-recording.h5 | wc -l)" -eq 2 ] || fail "there should be two recordings"
[ "$(ls out/*-picture.png | wc -l)" -eq 2 ] || fail "there should be two pictures"
for recording in out/*-recording.h5; do
  "$osteomill" report "$recording" --out "report-$(basename "$recording")" >/dev/null || fail "$recording cannot be read"
done
