#!/usr/bin/env bash
# Manual pages and completions have every command and option of --help, the pages have no warnings, and bash and fish complete.
#   manual.sh OSTEOMILL MANUAL_FOLDER INSTALL_PACKAGES
set -euo pipefail
export LC_ALL=C.UTF-8
osteomill=$1 manual=$2 install_packages=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fault() { echo "FAILED: $1"; exit 1; }

shells() { command -v man && command -v mandoc && command -v zsh && command -v fish; } >/dev/null
shells || { [ "$(id -u)" = 0 ] && "$install_packages" man-db mandoc zsh fish; } || true
shells || { echo "SKIPPED: needs man, mandoc, zsh and fish, which cannot be installed here"; exit 77; }

mapfile -t commands < <("$osteomill" --help | sed -nE 's/^  ([a-z]+)( .*|$)/\1/p')
[ ${#commands[@]} -gt 10 ] || fault "--help has only ${#commands[@]} commands"
options_of() { "$osteomill" "$@" --help | sed -nE 's/^  (-[^ ]+).*/\1/p' | tr ',' '\n' | sed 's/{.*//'; }

# The pages.
[ "$(ls "$manual/man1" | wc -l)" -eq $((${#commands[@]} + 1)) ] || fault "the pages are $(ls "$manual/man1")"
for page in "$manual"/man1/*; do
  MANWIDTH=100 man --warnings=w -l "$page" 2>said | col -b >"${page##*/}.txt"
  [ ! -s said ] || { cat said; fault "man warns of ${page##*/}"; }
  mandoc -T lint -W warning "$page" >said || { cat said; fault "mandoc warns of ${page##*/}"; }
done
for command in "${commands[@]}"; do
  grep -qE "^ +$command( |$)" osteomill.1.txt || fault "osteomill(1) lacks $command"
  for option in $(options_of "$command"); do
    grep -qE -- "^ +(-.*, )?$option( |,|$)" "osteomill-$command.1.txt" || fault "osteomill-$command(1) lacks $option"
  done
done
grep -q 'mm³' osteomill-compare.1.txt || fault "osteomill-compare(1) has no unit mm³"

# Calls the completion function as bash does.
. "$manual/bash/osteomill"
completed() {  # WORDS...: completions of the last word
  COMP_WORDS=(osteomill "$@")
  COMP_CWORD=$#
  _osteomill 2>/dev/null
  printf '%s\n' "${COMPREPLY[@]}" | sort | paste -sd ' '
}
is() { [ "$1" = "$2" ] || fault "completed as '$1', not '$2'"; }
is "$(completed '')" "$(printf '%s\n' "${commands[@]}" | sort | paste -sd ' ')"
is "$(completed --)" "--help --version"
for command in "${commands[@]}"; do
  is "$(completed "$command" -)" "$(options_of "$command" | sort | paste -sd ' ')"
done
is "$(completed compare --algorithm po)" point-shell
is "$(completed compare --algorithm = po)" point-shell
is "$(completed compare --algorithm =)" "barrier-shell line-proxy point-shell surface-points"
is "$(completed live --device s)" "simulated spacemouse"
is "$(completed info --as '')" "labels scan"
is "$(completed study --on '')" slurm
mkdir "a folder"
touch "a scan.nrrd"
is "$(completed info a)" "a folder a scan.nrrd"
is "$(completed compare --out a)" "a folder"
is "$(completed save --out a)" "a folder a scan.nrrd"
is "$(completed compare --burr-radius a)" ""

# fish completes too; the zsh script lists every option under its command.
fish --no-execute "$manual/fish/osteomill.fish" || fault "fish does not read its script"
zsh -n "$manual/zsh/_osteomill" || fault "zsh does not read its script"
in_fish() { fish --no-config -c "source '$manual/fish/osteomill.fish'; complete -C 'osteomill $1'" | cut -f 1 | sort | paste -sd ' '; }
is "$(in_fish 'compare --algorithm po')" point-shell
for command in "${commands[@]}"; do
  in_zsh=$(sed -n "/^ *$command)$/,/;;$/p" "$manual/zsh/_osteomill")
  for option in $(options_of "$command"); do
    [[ $in_zsh == *"$option["* ]] || fault "zsh does not know $command $option"
  done
  in_fish=" $(in_fish "$command -") $(in_fish "$command --") "
  for option in $(options_of "$command"); do
    [[ $in_fish == *" $option "* ]] || fault "fish does not know $command $option"
  done
done
