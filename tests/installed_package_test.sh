#!/usr/bin/env bash
# Installs the built tree into an empty folder and builds and runs the examples against it alone.
#   installed_package_test.sh BUILD_DIR EXAMPLES_DIR
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$1" --prefix "$folder/prefix" >/dev/null
cmake -S "$2" -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH="$folder/prefix" >/dev/null
cmake --build "$folder/build"
"$folder/build/press_on_a_ball"
"$folder/build/mill_live"
