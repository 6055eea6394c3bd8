#!/usr/bin/env bash
# Installs, runs, upgrades, removes and purges the Debian package in a fresh Debian, as root.
#
#   package_trial.sh PACKAGE MIRROR SUITE
#
# Every command inside has processes, mounts and, where it is about robots, a network of its own, so
# that nothing of it is left when it ends, however it ends.
set -euo pipefail

package=$(realpath "$1")
mirror=$2
suite=$3  # bookworm, trixie

fail() {
  echo "package_trial: $1" >&2
  exit 1
}
((EUID == 0)) || fail "it takes root to make a Debian: sudo scripts/package --try"
for tool in debootstrap ip; do
  command -v "$tool" >/dev/null || fail "no $tool: apt-get install debootstrap iproute2"
done

work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
root=$work/root
export LC_ALL=C DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin

isolated() { unshare --mount --pid --fork --kill-child "$@"; }
# inside [--network-of-its-own] COMMAND…
inside() {
  local network='' alone=()
  if [[ $1 == --network-of-its-own ]]; then
    alone=(--net)
    network='ip link set lo up;'
    shift
  fi
  # shellcheck disable=SC2016
  isolated "${alone[@]}" --mount-proc="$root/proc" bash -c "$network"' exec chroot "$@"' bash "$root" "$@"
}
say() { echo "package_trial: $1"; }
# shown COMMAND…: runs it with its output indented.
shown() { "$@" 2>&1 | sed 's/^/  /'; }
traces() {
  inside find / -xdev -name '*sweepd*' -not -path '/proc/*' -not -path '/var/log/*' \
    -not -path '/var/cache/apt/*'
}

say "a fresh Debian $suite from $mirror"
isolated debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$work/debootstrap.log" ||
  { tail -n 5 "$work/debootstrap.log" >&2; fail "debootstrap failed"; }
[[ -z $(traces) ]] || fail "something is called sweepd already: $(traces)"

say "install"
cp "$package" "$root/first.deb"

inside apt-get -q update >"$work/apt.log"
inside apt-get -q -y --no-install-recommends install /first.deb >"$work/apt.log" 2>&1 ||
  { cat "$work/apt.log" >&2; fail "apt does not install it"; }
shown inside dpkg-query -W -f '${Package} ${Version} ${db:Status-Status}\n' sweepd
shown inside getent passwd sweepd
[[ $(inside dpkg -V sweepd) == '' ]] || fail "files are not as they were packed"
shown inside sweepd --version

say "sweepd check, on the settings as they are shipped"
shown inside --network-of-its-own sweepd check || fail "the settings are not sound here"

say "sweepd run and sweepd simulate, each as shipped"
cat >"$root/serve" <<'SERVE'
set -eu
sweepd run >/tmp/daemon.log 2>&1 &
daemon=$!
await() {
  for ((i = 0; i < 600; i++)); do
    if eval "$1"; then return 0; fi
    kill -0 $daemon 2>/dev/null || break
    sleep 0.1
  done
  echo "in vain: $1"
  cat /tmp/daemon.log
  return 1
}
await 'grep -q ":C000 " /proc/net/udp'
sweepd simulate --robot /etc/sweepd/robots/kr5_arc.toml --plan /etc/sweepd/plans/kr5_arc_90deg.toml \
  --to 127.0.0.1:49152 || echo "A late reply is no matter on this machine, the result is."
await 'grep -qs "\"ended\"" /var/lib/sweepd/*/*/run.json'
kill -TERM $daemon
wait $daemon
SERVE
shown inside --network-of-its-own bash /serve || fail "see above"
rm "$root/serve"
result=$(echo "$root"/var/lib/sweepd/kr5-arc/*/result.json)
grep -q '"status": *"complete"' "$result" || fail "no complete result: $result"
shown echo "complete: ${result#"$root"}"
shown sed -n 1,14p "${result%result.json}report.txt"

say "edit the settings, upgrade to a package whose settings differ"
settings=$root/etc/sweepd/sweepd.toml
echo '# edited by the plant' >>"$settings"
sed -i 's/^#silence_ms = 2000/silence_ms = 3000/' "$settings"
grep -q '^silence_ms = 3000' "$settings" || fail "the shipped settings have no silence_ms to edit"
edited=$(sha256sum <"$settings")
dpkg-deb -R "$package" "$work/second"
sed -i 's/^Version: .*/&+trial/' "$work/second/DEBIAN/control"
sed -i '1i # another first line' "$work/second/etc/sweepd/sweepd.toml"
dpkg-deb --root-owner-group -b "$work/second" "$root/second.deb" >/dev/null
inside apt-get -q -y -o Dpkg::Options::=--force-confdef -o Dpkg::Options::=--force-confold \
  install /second.deb >"$work/apt.log" 2>&1 || { cat "$work/apt.log" >&2; fail "no upgrade"; }
shown inside dpkg-query -W -f '${Package} ${Version} ${db:Status-Status}\n' sweepd
[[ $(sha256sum <"$settings") == "$edited" ]] || fail "the upgrade changed the settings"
shown grep -n 'edited by the plant\|^silence_ms' "$settings"
shown inside --network-of-its-own sweepd check || fail "the settings are not sound here"

say "remove: settings and recordings stay"
inside apt-get -q -y remove sweepd >"$work/apt.log" 2>&1 || { cat "$work/apt.log" >&2; fail "no removal"; }
[[ $(sha256sum <"$settings") == "$edited" && -f $result && ! -e $root/usr/bin/sweepd ]] ||
  fail "removal left or took what it should not"
shown inside find /etc/sweepd /var/lib/sweepd -maxdepth 1

say "purge: nothing stays"
inside apt-get -q -y purge sweepd >"$work/apt.log" 2>&1 || { cat "$work/apt.log" >&2; fail "no purge"; }
left=$(traces)
[[ -z $left ]] || fail "left: $left"
! inside getent passwd sweepd || fail "user sweepd is left"
! inside getent group sweepd || fail "group sweepd is left"
say "all as it should be"
