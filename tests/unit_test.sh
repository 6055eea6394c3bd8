#!/usr/bin/env bash
# The systemd unit has no mistakes, and exposes little.
#
#   unit_test.sh UNIT SWEEPD [TENTHS]
#
# TENTHS: the exposure that it may have, in tenths; 15 without it.
set -euo pipefail

unit=$1
sweepd=$2
most=${3:-15}
name=${unit##*/}
if ! command -v systemd-analyze >/dev/null; then
  echo "not installed here: systemd-analyze"
  exit 0
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

# exposed UNIT: whether its exposure is above that, of 10.
exposed() {
  ! systemd-analyze security --offline=yes --threshold="$most" "$1" >"$folder/exposure" 2>&1
}

# The program is not where the package will put it.
verify() {
  sed "s|/usr/bin/sweepd|$sweepd|" "$1" >"$folder/$name"
  systemd-analyze verify --man=no "$folder/$name" 2>&1 | grep -F "${name%@*}" || true
}

if exposed "$unit"; then
  echo "the unit exposes too much:"
  grep -F '✗' "$folder/exposure" || cat "$folder/exposure"
  failed=1
fi
tail -n 1 "$folder/exposure"
findings=$(verify "$unit")
if [[ -n $findings ]]; then
  echo "$findings"
  failed=1
fi

# %I makes a / of each - in the name: the interface br-lan would be br/lan.
if grep -q '%I' "$unit"; then
  echo "the unit unescapes the name of its instance"
  failed=1
fi

# Both would see what is wrong.
grep -v '^\(CapabilityBoundingSet\|SystemCallFilter\|ProtectSystem\)=' "$unit" >"$folder/open.service"
if ! exposed "$folder/open.service"; then
  echo "a unit without its sandbox passes"
  failed=1
fi
sed 's/^Restart=.*/Restart=now-and-then/' "$unit" >"$folder/wrong.service"
if [[ -z $(verify "$folder/wrong.service") ]]; then
  echo "a unit with a mistake passes"
  failed=1
fi
exit $failed
