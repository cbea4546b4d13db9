#!/usr/bin/env bash
# No numeric option accepts a non-finite number, from the command line, a configuration file or a study; and a switch accepts only
# true and false. Tries every option that --help of every command lists.
set -euo pipefail
osteomill=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
faults=0
fault() { echo "FAILED: $1"; faults=1; }

# CODE TEXT COMMAND...
refused() {
  local expected=$1 text=$2 code=0
  shift 2
  timeout 20 "$osteomill" "$@" >out 2>err </dev/null || code=$?
  [ $code -eq "$expected" ] && [ "$(wc -l <err)" -eq 1 ] && grep -qE -- "$text" err ||
    fault "osteomill $*: exit code $code, expected $expected and one line with '$text': $(head -c 300 err)"
}

words='FILE|FOLDER|SERIES|DEVICE|HOST:PORT|LABEL,...|SETTING|TEXT'
options() { sed -nE 's/^  (-.,)?(--[a-z-]+)( ([^ ]+))?( .*)?$/\2 \4/p' <<<"$1" | grep -v -- "--help"; }
tried=0
for command in simulate compare live rates replay info mesh save devices settings report study; do
  help=$("$osteomill" "$command" --help)
  while read -r option type; do
    if grep -qE -- "^  $option( ?$|  )" <<<"$help"; then
      value=nan text="$option: nan .*true.*false"
    elif [[ "|$words|" == *"|$type|"* ]]; then
      continue
    else
      value=nan text="$option: .*nan"
      [ "$type" = X,Y,Z ] && value=0,nan,0
    fi
    tried=$((tried + 1))
    refused 2 "$text" "$command" "$option=$value"
    [ "$type" = "" ] || [ "$type" = X,Y,Z ] || refused 2 "$option: .*inf" "$command" "$option=inf"
    if [[ $help == *--config* ]]; then
      [ "$value" = nan ] && toml=nan || toml="[0, nan, 0]"
      [ "$command" != replay ] || printf 'time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,milling\n0,0,0,30,1,0,0,0,0\n' >t.csv
      for value in "$toml" "[]"; do
        echo "${option#--} = $value" >c.toml
        refused 1 "^osteomill: c.toml: line 1: .*${option#--}" "$command" $([ "$command" = replay ] && echo t.csv) --config c.toml
      done
    fi
  done < <(options "$help")
done
[ $tried -gt 150 ] || fault "only $tried options were tried"

while read -r option type; do
  [[ "|$words|" != *"|$type|"* ]] && [ "$option" != --quiet ] || continue
  case $option in --out | --config | --seeds | --threads | --match-stiffness | --no-stability | --max-memory) continue ;; esac
  [ "$type" = X,Y,Z ] && value='"0,nan,0"' || value=nan
  [ "$option" = --push ] && varied=seed || varied=push
  printf '[fixed]\n%s = %s\n[grid]\n%s = [1, 2]\n' "${option#--}" "$value" $varied >s.toml
  refused 1 "^osteomill: s.toml: .*(${option#--}: .*nan|nan)" study s.toml --list
done < <({ options "$("$osteomill" compare --help)"; printf -- '--rate Hz\n--voxel mm\n--device-damping N\n--grip NUMBER\n--draw-hand\n'; } | sort -u)
refused 2 "nan .*number" compare --set point-shell.scale=nan
refused 2 "stiffness .*number" compare --set surface-points.stiffness=inf
[ $faults -eq 0 ]
