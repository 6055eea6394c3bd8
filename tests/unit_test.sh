#!/usr/bin/env bash
# The systemd unit has no mistakes, and exposes little.
#
#   unit_test.sh UNIT SWEEPD
set -euo pipefail

unit=$1
sweepd=$2
if ! command -v systemd-analyze >/dev/null; then
  echo "not installed here: systemd-analyze"
  exit 0
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

# exposed UNIT: whether its exposure is above 1.5, of 10.
exposed() {
  ! systemd-analyze security --offline=yes --threshold=15 "$1" >"$folder/exposure" 2>&1
}

# The program is not where the package will put it.
verify() {
  sed "s|/usr/bin/sweepd|$sweepd|" "$1" >"$folder/sweepd.service"
  systemd-analyze verify --man=no "$folder/sweepd.service" 2>&1 | grep -F sweepd.service || true
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
