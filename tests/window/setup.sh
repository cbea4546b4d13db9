# Sourced by the tests of the window with the tools that they need: skips the test if one is missing, enters an empty
# folder with a state folder of its own and no session bus, and removes it at the end. Reads the states printed by the window's
# driver from the file `said`:
#   . "$(dirname "${BASH_SOURCE[0]}")/setup.sh" xvfb-run [TOOL...]
for tool in "$@"; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: needs $tool"; exit 77; }
done
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export XDG_STATE_HOME=$folder/state DBUS_SESSION_BUS_ADDRESS=unix:path=$folder/no-bus

# Keeps the test's pictures if OSTEOMILL_PICTURES names a folder.
pictures() { [ -z "${OSTEOMILL_PICTURES:-}" ] || cp ./*.png "$OSTEOMILL_PICTURES" 2>/dev/null || true; }
fail() { pictures; echo "FAILED: $1"; cat said errors 2>/dev/null || true; exit 1; }
value() { sed -n "s/^$1\.$2=//p" said; }            # STATE KEY
part() { value "$1" "$2" | cut -d' ' -f"$3"; }      # STATE KEY NUMBER
is() { [ "$(value "$1" "$2")" = "$3" ] || fail "at $1, $2 is '$(value "$1" "$2")' and not '$3'"; }
