#!/usr/bin/env bash
# The Debian package, as cpack makes it from what is built, without root and without a network.
#
#   package_test.sh SOURCE_FOLDER BUILD_FOLDER CPACK
set -euo pipefail

source=$1
build=$2
cpack=$3
for tool in dpkg-deb dpkg-shlibdeps dpkg-parsechangelog file; do
  command -v "$tool" >/dev/null || { echo "not available here: $tool"; exit 0; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
wrong() {
  echo "$*"
  failed=1
}
# check WHAT COMMAND…: the command has to succeed.
check() {
  local what=$1
  shift
  "$@" || wrong "$what"
}

# pack FOLDER: makes the package there, with an umask that must not matter.
pack() (
  umask 077
  SOURCE_DATE_EPOCH=1700000000 "$cpack" --config "$build/CPackConfig.cmake" -B "$1" >"$work/log" 2>&1 ||
    { cat "$work/log"; exit 1; }
)
pack "$work/once"
package=$(echo "$work"/once/*.deb)
pack "$work/twice"
check "the same sources do not give the same package" cmp "$package" "$work"/twice/*.deb

field() { dpkg-deb -f "$package" "$1"; }
version=$(dpkg-parsechangelog -l "$source/config/debian/changelog" -S Version)
[[ $(field Version) == "$version" ]] || wrong "version $(field Version), the changelog has $version"
[[ $(field Package) == sweepd ]] || wrong "name $(field Package)"
[[ ${package##*/} == "sweepd_${version}_$(dpkg --print-architecture).deb" ]] || wrong "file ${package##*/}"
[[ $(field Maintainer) =~ ^[^\<]+\ \<[^@]+@[^\>]+\>$ ]] || wrong "maintainer $(field Maintainer)"
[[ -n $(field Section) && -n $(field Installed-Size) ]] || wrong "no section or size"
for library in libc6 libstdc++6 libpcap0.8 libpq5; do
  [[ $(field Depends) == *"$library"* ]] || wrong "depends on $(field Depends): no $library"
done
[[ $(field Depends) == *procps* ]] || wrong "depends on $(field Depends): no procps, and the units reload by /bin/kill"
while IFS= read -r line; do
  ((${#line} <= 80)) || wrong "a line of the description is too long: $line"
done < <(field Description)

# What it is made of: each library that it depends on, and what was compiled into it; no test's.
if [[ -f $build/build.ninja ]] && command -v ninja >/dev/null; then
  SOURCE_DATE_EPOCH=1700000000 "$source/scripts/sbom" "$build" "$package" "$work/made_of.json"
  while read -r library; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$library" 2>/dev/null) == installed ]] || continue  # a name that another package provides
    check "made_of: no $library" grep -q "\"name\": \"$library\"" "$work/made_of.json"
  done < <(field Depends | tr ',' '\n' | sed 's/ *(.*//' | grep '^ *lib'; echo libeigen3-dev)
  check "made_of: no uPlot" grep -q '"name": "uplot"' "$work/made_of.json"
  ! grep -q '"name": "catch2"' "$work/made_of.json" || wrong "made_of: the tests' Catch is no part"
  python3 - "$work/made_of.json" "$(sha256sum <"$package" | cut -d' ' -f1)" "$version" <<'SPDX' || wrong "made_of"
import json, sys
made = json.load(open(sys.argv[1]))
own = made["packages"][0]
assert (made["spdxVersion"], own["versionInfo"]) == ("SPDX-2.3", sys.argv[3]), own
assert own["checksums"] == [{"algorithm": "SHA256", "checksumValue": sys.argv[2]}], own
named = [one["SPDXID"] for one in made["packages"]]
assert len(set(named)) == len(named), named
assert all(one["relatedSpdxElement"] in named for one in made["relationships"]), named
assert made["creationInfo"]["created"] == "2023-11-14T22:13:20Z", made["creationInfo"]
SPDX
fi

# Contents: mode, owner, path.
dpkg-deb -c "$package" | awk '{print $1, $2, $6}' >"$work/contents"
for path in usr/share/man/man1/sweepd-watch.1.gz \
  usr/bin/sweepd usr/libexec/sweepd/sweepd-plant usr/lib/systemd/system/sweepd{,-publish,-collect,-watch@}.service usr/lib/sysusers.d/sweepd.conf \
  etc/sweepd/sweepd.toml etc/sweepd/{collect,watch}.toml etc/needrestart/conf.d/sweepd.conf \
  usr/share/man/man1/sweepd.1.gz usr/share/man/man1/sweepd-{run,replay,inspect,identify}.1.gz \
  usr/share/man/man1/sweepd-{simulate,plan,export,check}.1.gz usr/share/man/man5/sweepd.toml.5.gz \
  usr/share/bash-completion/completions/sweepd usr/share/doc/sweepd/copyright \
  usr/share/doc/sweepd/changelog.gz usr/share/doc/sweepd/README.md usr/share/doc/sweepd/SECURITY.md; do
  check "no /$path" grep -q " \./$path$" "$work/contents"
done
# So are the pages, with what they show and link to.
while IFS= read -r file; do
  check "no /usr/share/doc/sweepd/$file" grep -q " \./usr/share/doc/sweepd/$file$" "$work/contents"
done < <(cd "$source" && find docs -type f)
while IFS= read -r file; do
  check "no /usr/share/doc/sweepd/$file" grep -q " \./usr/share/doc/sweepd/$file$" "$work/contents"
done < <(cd "$source" && find config/monitoring -type f)
# All that the settings can name is shipped.
for folder in robots plans controller; do
  while IFS= read -r file; do
    check "no /etc/sweepd/$file" grep -q " \./etc/sweepd/$file$" "$work/contents"
  done < <(cd "$source/config" && find "$folder" -type f)
done
while read -r mode owner path; do
  [[ $owner == root/root ]] || wrong "$path belongs to $owner"
  case $mode$path in
    drwxr-xr-x*/ | -rwxr-xr-x./usr/bin/sweepd | -rwxr-xr-x./usr/libexec/sweepd/sweepd-plant | -rw-r--r--./etc/* | -rw-r--r--./usr/[ls]*) ;;
    *) wrong "$path has mode $mode" ;;
  esac
  case $path in
    ./ | ./usr/ | ./etc/ | ./etc/sweepd/* | ./etc/needrestart/* | ./usr/bin/* | ./usr/share/* | ./usr/lib/ | ./usr/lib/sys* | ./usr/libexec/*) ;;
    *) wrong "$path does not belong into a package" ;;
  esac
done <"$work/contents"

dpkg-deb -R "$package" "$work/root"
diff <(sed 's/^/./' "$work/root/DEBIAN/conffiles" | sort) <(cd "$work/root" && find ./etc -type f | sort) ||
  wrong "conffiles are not what lies in /etc"
for script in postinst prerm postrm; do
  check "$script cannot be run" test -x "$work/root/DEBIAN/$script"
  check "$script" sh -n "$work/root/DEBIAN/$script"
  check "$script does not stop at its first error" grep -q '^set -e$' "$work/root/DEBIAN/$script"
done
# A restart while RSI runs would stop the robot; a start has no robot to serve yet.
! grep -Eq '(systemctl|deb-systemd-invoke|service) +(--[a-z]+ +)*(re)?start|systemctl +(--[a-z]+ +)*enable' \
  <(grep -v 'echo' "$work/root/DEBIAN/postinst") || wrong "postinst starts or enables the service"
(cd "$work/root" && md5sum --quiet -c DEBIAN/md5sums) || wrong "md5sums"
for page in "$work"/root/usr/share/man/man*/*.gz "$work"/root/usr/share/doc/sweepd/*.gz; do
  check "$page" gzip -t "$page"
  # No name and no time of a source file: gzip -n; best compression: -9.
  [[ $(od -An -tx1 -N 10 "$page" | tr -d ' \n') == 1f8b080000000000020[03] ]] || wrong "$page is not by gzip -9n"
done
check "the program has its symbols still" grep -q ', stripped' <(file "$work/root/usr/bin/sweepd")
check "the unit runs another program" grep -q '^ExecStart=/usr/bin/sweepd run --config /etc/sweepd/sweepd.toml$' \
  "$work/root/usr/lib/systemd/system/sweepd.service"
# What answers robots has no code of brokers or databases.
! objdump -p "$work/root/usr/bin/sweepd" | grep -E 'NEEDED.*(paho|libpq|libssl)' || wrong "sweepd links them"
! grep -rqF -e "$build" -e "$source" "$work/root/etc" "$work/root/usr/share" "$work/root/usr/lib" ||
  wrong "files name folders of this machine"

# Elsewhere than in /usr, everything stays below the prefix, and what was edited stays as it is.
install_local() { cmake --install "$build" --prefix "$work/local" >/dev/null; }
install_local
check "no settings below the prefix" test -f "$work/local/etc/sweepd/sweepd.toml"
check "the unit below the prefix runs another program" \
  grep -q "^ExecStart=$work/local/bin/sweepd run --config $work/local/etc/sweepd/sweepd.toml$" \
  "$work/local/lib/systemd/system/sweepd.service"
echo '# edited' >>"$work/local/etc/sweepd/sweepd.toml"
install_local
check "an installation overwrites settings" grep -q '^# edited$' "$work/local/etc/sweepd/sweepd.toml"
exit $failed
