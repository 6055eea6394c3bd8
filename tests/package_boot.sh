#!/usr/bin/env bash
# Boots a fresh Debian with the package in it, and tries the unit under its systemd, as root.
#
#   package_boot.sh PACKAGE MIRROR SUITE
#
# The machine has processes, mounts and a network of its own; nothing is left of it.
set -euo pipefail

package=$(realpath "$1")
mirror=$2
suite=$3  # bookworm, trixie

fail() {
  echo "package_boot: $1" >&2
  exit 1
}
((EUID == 0)) || fail "it takes root to boot a Debian: sudo scripts/package --boot"
for tool in debootstrap systemd-nspawn; do
  command -v "$tool" >/dev/null || fail "no $tool: apt-get install debootstrap systemd-container"
done

work=$(mktemp -d)
trap 'rm -rf --one-file-system "$work"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
root=$work/root
export LC_ALL=C DEBIAN_FRONTEND=noninteractive PATH=$PATH:/usr/sbin:/sbin

echo "package_boot: a fresh Debian $suite from $mirror"
unshare --mount debootstrap --variant=minbase --include=systemd,systemd-sysv,dbus,procps \
  "$suite" "$root" "$mirror" >"$work/log" || { tail -n 5 "$work/log" >&2; fail "debootstrap failed"; }
cp "$package" "$root/sweepd.deb"
cp /etc/resolv.conf "$root/etc/resolv.conf"
unshare --mount --pid --fork --kill-child --mount-proc="$root/proc" chroot "$root" sh -c \
  'apt-get -q update && apt-get -q -y --no-install-recommends install /sweepd.deb' >"$work/log" 2>&1 ||
  { tail -n 20 "$work/log" >&2; fail "apt does not install it"; }

# What is tried inside, once the machine has booted.
cat >"$root/trial" <<'TRIAL'
set -u
failed=0
say() { echo "package_boot: $*"; }
# expect WHAT COMMAND…
expect() {
  local what=$1
  shift
  if "$@"; then say "  $what"; else say "  FAILED: $what: $*"; failed=1; fi
}
of() { systemctl show --value -p "$1" sweepd; }
# await SECONDS COMMAND
await() {
  for ((i = 0; i < 10 * $1; i++)); do
    if eval "$2"; then return 0; fi
    sleep 0.1
  done
  return 1
}
journal() { journalctl -q -u sweepd -o cat "$@"; }
sessions() { find /var/lib/sweepd -name run.json -exec grep -l '"ended"' {} + | wc -l; }

say "after installation"
expect "the unit is neither enabled nor started" test "$(of UnitFileState) $(of ActiveState)" = "disabled inactive"

say "start"
systemctl start sweepd
expect "active" test "$(of ActiveState)" = active
expect "the port is bound when systemd says so" grep -q ':C000 ' /proc/net/udp
pid=$(of MainPID)
expect "user sweepd" test "$(stat -c %U "/proc/$pid")" = sweepd
expect "no capability" grep -q '^CapEff:[[:space:]]*0*$' "/proc/$pid/status"
policy() { chrt -p "$(grep -l '^reply$' "/proc/$pid"/task/*/comm | cut -d/ -f5)" | head -n 1; }
drop_ins=/run/systemd/system/sweepd.service.d
mkdir -p $drop_ins
if (($(awk '/^CapBnd/ { print "0x" $2 }' /proc/1/status) >> 24 & 1)); then
  expect "memory is locked: $(awk '/VmLck/ { print $2, $3 }' "/proc/$pid/status")" \
    sh -c "! grep -q 'VmLck:[[:space:]]*0 kB' /proc/$pid/status"
else
  say "  not permitted here: to raise limits (CAP_SYS_RESOURCE); a capability takes their place"
  printf '[Service]\nPrivateUsers=no\nCapabilityBoundingSet=CAP_SYS_NICE\nAmbientCapabilities=CAP_SYS_NICE\n' \
    >$drop_ins/limits.conf
  systemctl daemon-reload
  systemctl restart sweepd
  pid=$(of MainPID)
fi
expect "the reply thread: $(policy)" grep -q SCHED_FIFO <<<"$(policy)"
rm -f $drop_ins/limits.conf
systemctl daemon-reload
systemctl restart sweepd
pid=$(of MainPID)
systemd-analyze security sweepd | tail -n 1

say "a campaign, as shipped"
sweepd simulate --quiet --robot /etc/sweepd/robots/kr5_arc.toml --plan /etc/sweepd/plans/kr5_arc_90deg.toml \
  --to 127.0.0.1:49152 >/tmp/simulate.log 2>&1 || { cat /tmp/simulate.log; say "  one late reply on a busy machine is no matter here"; }
say "  status while it runs: $(of StatusText)"
expect "the session ends" await 60 '(($(sessions) == 1))'
expect "its result is complete" grep -q '"status": *"complete"' /var/lib/sweepd/kr5-arc/*/result.json
say "  status: $(of StatusText)"
expect "lines of the journal have robot, session and IPOC" sh -c \
  'journalctl -q -u sweepd -o json SWEEPD_ROBOT=kr5-arc | grep "sweep of" | grep SWEEPD_SESSION | grep SWEEPD_IPOC >/dev/null'
expect "and priorities" sh -c 'test -z "$(journalctl -q -u sweepd -p err -o cat)"'

say "reload"
systemctl reload sweepd
expect "the same process goes on" test "$(of MainPID) $(of ActiveState)" = "$pid active"
expect "and says so" await 10 'journal | grep -q "description and plan read again"'

say "watchdog, 6 s here: the process is stopped"
printf '[Service]\nWatchdogSec=6\n' >$drop_ins/watchdog.conf
systemctl daemon-reload
systemctl restart sweepd
pid=$(of MainPID)
kill -STOP "$pid"
expect "systemd starts it again" await 30 'test "$(of NRestarts)" = 1 && test "$(of ActiveState)" = active'
expect "another process serves" test "$(of MainPID)" != "$pid"
say "  $(journalctl -q -u sweepd -o cat | grep -i watchdog | tail -n 1)"

say "stop"
systemctl stop sweepd
expect "in order" test "$(of Result) $(of ExecMainStatus)" = "success 0"
expect "the last lines say so" sh -c 'journalctl -q -u sweepd -o cat | grep -q "ending on SIGTERM"'

say "wrong settings"
cp /etc/sweepd/sweepd.toml /tmp/kept.toml
sed -i 's/^name/nmae/' /etc/sweepd/sweepd.toml
systemctl start sweepd 2>/dev/null && say "  FAILED: it starts" && failed=1
sleep 3  # longer than RestartSec
expect "exit code 78, and no other try" test "$(of ExecMainStatus) $(of NRestarts) $(of ActiveState)" = "78 0 failed"
say "  $(journal | grep nmae)"
cp /tmp/kept.toml /etc/sweepd/sweepd.toml

say "a taken port"
systemctl reset-failed sweepd
perl -MSocket -e 'socket(S, PF_INET, SOCK_DGRAM, 0); bind(S, sockaddr_in(49152, INADDR_ANY)) or die; sleep 6' &
await 5 "grep -q ':C000 ' /proc/net/udp"
systemctl start sweepd 2>/dev/null
expect "sweepd comes once it is free" await 30 'test "$(of ActiveState)" = active'
say "  after $(of NRestarts) more tries"

say "upgrade while it runs"
pid=$(of MainPID)
dpkg-deb -R /sweepd.deb /tmp/second
sed -i 's/^Version: .*/&+trial/' /tmp/second/DEBIAN/control
dpkg-deb --root-owner-group -b /tmp/second /tmp/second.deb >/dev/null
dpkg -i /tmp/second.deb 2>&1 | grep 'goes on' | sed 's/^/package_boot:   /'
expect "the same process goes on" test "$(of MainPID) $(of ActiveState)" = "$pid active"

say "removal"
apt-get -q -y remove sweepd >/tmp/apt.log 2>&1 || cat /tmp/apt.log
expect "it was stopped" test ! -e "/proc/$pid"
if ((failed)); then
  journalctl -q -u sweepd -o short-precise
  say "FAILED"
else
  say "all as it should be"
fi
TRIAL
cat >"$root/etc/systemd/system/trial.service" <<'UNIT'
[Service]
Type=oneshot
ExecStart=/bin/bash -c 'bash /trial >/trial.log 2>&1'
ExecStopPost=/bin/systemctl --no-block poweroff
TimeoutStartSec=300
UNIT
mkdir -p "$root/etc/systemd/system/multi-user.target.wants"
ln -s ../trial.service "$root/etc/systemd/system/multi-user.target.wants/trial.service"

echo "package_boot: booting"
systemd-nspawn --quiet --register=no --keep-unit --private-network --console=pipe \
  -D "$root" -b >"$work/console" 2>&1 || true
[[ -s $root/trial.log ]] || { tail -n 30 "$work/console" >&2; fail "the machine did not come up"; }
cat "$root/trial.log"
grep -q '^package_boot: all as it should be' "$root/trial.log"
