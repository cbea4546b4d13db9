#!/usr/bin/env bash
# Installs the build into an empty folder and uses only that: headers, examples, projects that use one component or all, pkg-config.
#   installed_package_test.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$1" --prefix "$folder/prefix" >/dev/null
cd "$folder"
config=$(find prefix -name osteomillConfig.cmake)
packages() { sed -nE "s/^set\(osteomill_($1)_packages (.*)\)$/\2/p" "$config" | sed -E 's/"([^ "]*)[^"]*"/\1/g' | tr ' ' '\n' | sort -u; }
IFS=';' read -ra components < <(sed -nE 's/^set\(osteomill_modules "(.*)"\)$/\1/p' "$config")
fail() { echo "$*" >&2; exit 1; }

for file in doc/osteomill/{LICENSE,README.md,docs/architecture.md,examples/press_on_a_ball.cpp} man/man1/osteomill{,-compare}.1 \
  bash-completion/completions/osteomill zsh/site-functions/_osteomill fish/vendor_completions.d/osteomill.fish \
  applications/osteomill.desktop icons/hicolor/scalable/apps/osteomill.svg mime/packages/osteomill.xml; do
  [ -s "prefix/share/$file" ] || fail "not installed: $file"
done

# All installed headers compile together; the dev preset compiles each alone.
export PKG_CONFIG_PATH=$folder/prefix/lib/pkgconfig
flags="-w $(pkg-config --cflags osteomill)"
(cd prefix/include && find osteomill -name '*.h') | sort >headers
[ "$(wc -l <headers)" -gt 100 ] || fail "only $(wc -l <headers) headers are installed"
sed 's/.*/#include "&"/' headers >all.cpp
g++ $flags -fsyntax-only all.cpp || fail "the headers do not compile together"

user() {  # NAME CMAKE_ARGUMENTS...
  cmake -S "$source/tests/package" -B "$1" -G Ninja -DCMAKE_PREFIX_PATH="$folder/prefix" \
    -DSOURCE="$source/examples/press_on_a_ball.cpp" "${@:2}" >"$1.log" 2>&1
}
# The haptics component alone, with all packages disabled that only other components need.
mapfile -t absent < <(packages '.*' | grep -vxF -f <(packages 'base|volume|haptics'))
[ ${#absent[@]} -gt 3 ] || fail "the packages of haptics alone are not known"
disabled=("${absent[@]/#/-DCMAKE_DISABLE_FIND_PACKAGE_}")
disabled=("${disabled[@]/%/=ON}")
user haptics -DCOMPONENTS=haptics "${disabled[@]}" || { cat haptics.log; fail "haptics alone wants ${absent[*]}"; }
cmake --build haptics >/dev/null && haptics/user >felt
! user recording -DCOMPONENTS=recording "${disabled[@]}" || fail "recording was found without HDF5"
! user session -DCOMPONENTS=session -DCMAKE_FIND_ROOT_PATH=/nowhere -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY &&
  grep -q 'component session needs the library spnav' session.log || fail "session was found without libspnav"
! user misspelt -DCOMPONENTS=haptix && grep -q 'no component haptix' misspelt.log || fail "haptix was found"

# All components, through CMake and pkg-config; links every library whole, so that missing symbols are found.
user everything -DCOMPONENTS="$(printf '%s\n' "${components[@]}" | paste -sd';')" ||
  { cat everything.log; fail "not everything was found"; }
cmake --build everything >/dev/null && everything/user | cmp - felt
g++ $(pkg-config --cflags osteomill) -c "$source/examples/press_on_a_ball.cpp" -o user.o
g++ user.o -o whole -Wl,--whole-archive prefix/lib/libosteomill_*.a -Wl,--no-whole-archive \
  $(pkg-config --static --libs osteomill)
./whole | cmp - felt
g++ user.o -o by_pkg_config $(pkg-config --static --libs osteomill)
./by_pkg_config | cmp - felt

# Builds the installed examples.
cmake -S prefix/share/doc/osteomill/examples -B examples -G Ninja -DCMAKE_PREFIX_PATH="$folder/prefix" >examples.log 2>&1 &&
  cmake --build examples >>examples.log || { cat examples.log; fail "the examples cannot be built"; }
mapfile -t examples < <(sed -nE 's/^add_executable\((\w+) .*/\1/p' "$source/examples/CMakeLists.txt")
[ ${#examples[@]} -gt 3 ] || fail "only ${#examples[@]} examples are found"
for example in "${examples[@]}"; do
  "examples/$example" >"$example.log" || { cat "$example.log"; fail "the example $example fails"; }
done

# Configures the CMake code of the documents: each find_package with the target_link_libraries after it.
mkdir copied
awk '/^    find_package\(osteomill/ { found = $0; next }
  found && match($0, /^    target_link_libraries\([a-z_]+/) {
    name = substr($0, 27, RLENGTH - 26)
    file = "copied/" ++count ".cmake"
    print found "\nadd_executable(" name " ${SOURCE})\n" $0 >file
  }
  { found = "" }' "$source"/README.md "$source"/docs/*.md
[ "$(ls copied | wc -l)" -gt 1 ] || fail "the documents have no CMake"
for copied in copied/*.cmake; do
  mkdir "${copied%.cmake}"
  { echo 'cmake_minimum_required(VERSION 3.25)
project(copied LANGUAGES CXX)'; cat "$copied"; } >"${copied%.cmake}/CMakeLists.txt"
  cmake -S "${copied%.cmake}" -B "${copied%.cmake}/build" -G Ninja -DCMAKE_PREFIX_PATH="$folder/prefix" \
    -DSOURCE="$source/examples/press_on_a_ball.cpp" >copied.log 2>&1 || { cat "$copied" copied.log; fail "is not configured"; }
done

# The table in library.md names only existing components.
mapfile -t named < <(sed -n '/^| to | components |/,/^$/p' "$source/docs/library.md" | awk -F'|' '{ print $3 }' | grep -oE '`[a-z]+`' | tr -d '`' | sort -u)
[ ${#named[@]} -gt 3 ] || fail "library.md names only ${#named[@]} components"
for component in "${named[@]}"; do
  [[ " ${components[*]} " == *" $component "* ]] || fail "library.md names the component $component, which does not exist"
done

# Programs give the same bits with any flags, although their objects contain their own copies of inline functions.
for flags in "-O1" "-O3 -march=native -ffp-contract=fast"; do
  user bits -DCOMPONENTS=session -DSOURCE="$source/tests/package/same_bits.cpp" -DCMAKE_CXX_FLAGS="$flags" &&
    cmake --build bits >/dev/null && bits/user >"bits with $flags" || { cat bits.log; fail "same_bits fails with $flags"; }
done
g++ -O3 -march=native -ffp-contract=fast $(pkg-config --cflags osteomill) "$source/tests/package/same_bits.cpp" \
  -o bits_by_pkg_config $(pkg-config --static --libs osteomill)
./bits_by_pkg_config >"bits by pkg-config"
for told in "bits with -O3 -march=native -ffp-contract=fast" "bits by pkg-config"; do
  diff "bits with -O1" "$told" || fail "other bits: $told"
done
# Without the flags that the package requires, a program with another layout must not compile.
! echo '#include <osteomill/base/pose.h>' | g++ -std=c++20 -march=x86-64-v3 -fsyntax-only -x c++ \
  -isystem /usr/include/eigen3 -I prefix/include - 2>/dev/null || fail "a Quat with another layout compiles"
