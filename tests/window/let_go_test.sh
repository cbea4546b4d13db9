#!/usr/bin/env bash
# A tool released deep in bone no longer presses, however it was held, with every algorithm:
#   let_go_test.sh OSTEOMILL
set -euo pipefail
osteomill=$1
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run
fail() { echo "FAILED: $1"; cat errors; grep force_N said; exit 1; }
"$here/ball.sh" >ball.nrrd

# The force of five moments: a tool that buzzes feels none in some of them.
five='&-1\nwait 0.03\n&-2\nwait 0.04\n&-3\nwait 0.05\n&-4\nwait 0.06\n&-5'
largest_N() { sed -n "s/^$1-[1-5]\.force_N=//p" said | sort -g | tail -n 1; }
# Mills a hole with a non-default burr; then presses and releases the tool in each way.
sed 's/ *;; */\n/g' <<'END' | sed -E "s/^state [a-z]+-(pressing|after)$/$five/" >actions
wait 0.5 ;; click S ;; glide 640 750 0 ;; key b ;; settle ;; wait 0.3 ;; key t ;; wheel 28 0.6 ;; wait 0.4 ;; key space ;; wait 1.2 ;; key space ;; wait 0.3 ;; state hole
wheel 15 0.3 ;; wait 0.7 ;; state t-pressing ;; key t ;; wait 1.5 ;; state t-after
key t ;; wheel 15 0.3 ;; wait 0.7 ;; state escape-pressing ;; key escape ;; wait 1.5 ;; state escape-after
press page-up ;; wait 1 ;; state keys-pressing ;; release page-up ;; wait 1.5 ;; state keys-after
click Find tool ;; wait 0.2 ;; glide 640 400 0.1 ;; wait 0.1 ;; press left ;; press page-up ;; wait 1 ;; release page-up ;; wait 0.5 ;; state drag-pressing
release left ;; wait 1.5 ;; state drag-after
close
END
for algorithm in line-proxy surface-points point-shell barrier-shell; do
  xvfb-run -a -s "-screen 0 1280x800x24" timeout 100 "$osteomill" simulate ball.nrrd --no-help --algorithm $algorithm \
    --burr-radius 1.2 --stiffness 3 --script actions >said 2>errors || fail "exit code $?"
  awk -v mm3="$(value hole removed_mm3)" 'BEGIN { exit !(mm3 > 0.1) }' || fail "with $algorithm there is no hole"
  for way in t escape keys drag; do
    before_N=$(largest_N $way-pressing) after_N=$(largest_N $way-after)
    echo "$algorithm, $way: $before_N N, then $after_N N"
    awk -v before="$before_N" -v after="$after_N" 'BEGIN { exit !(before > 0.2 && after < 0.02) }' ||
      fail "with $algorithm, a tool that is let go by $way presses with $after_N N of $before_N N"
    [ "$(value $way-after-5 spindle)" = false ] || fail "with $algorithm the spindle turns after $way"
  done
done
