#!/usr/bin/env bash
# Every command has a manual page, to which that of sweepd refers, and nothing else has one. The
# pages are sound for groff and for mandoc, whichever is there.
#
#   manual_lint_test.sh SWEEPD FOLDER_OF_PAGES
set -euo pipefail
sweepd=$1
folder=$2

fail() {
  echo "$*"
  exit 1
}

pages=("$folder/sweepd.1" "$folder/sweepd.toml.5")
for command in $("$sweepd" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p'); do
  pages+=("$folder/sweepd-$command.1")
  grep -qx "\.BR sweepd.\?-$command (1)," "$folder/sweepd.1" || fail "sweepd.1 does not refer to sweepd-$command"
done
((${#pages[@]} >= 9)) || fail "only ${#pages[@]} pages"
for page in "$folder"/sweepd*.[15]; do
  [[ " ${pages[*]} " == *" $page "* ]] || fail "$page is of no command"
done

for page in "${pages[@]}"; do
  [[ -f $page ]] || fail "there is no $page"
  sections='NAME SYNOPSIS DESCRIPTION OPTIONS "EXIT STATUS" "SEE ALSO"'
  [[ $page == *.5 ]] && sections='NAME SYNOPSIS DESCRIPTION EXAMPLE FILES "SEE ALSO"'
  while IFS= read -r section; do
    grep -qx "\.SH $section" "$page" || fail "$page has no section $section"
  done < <(xargs -n 1 <<<"$sections" | sed 's/.* .*/"&"/')
  # What stands in backticks is set in bold, and each heading of --help became one of the page.
  ! grep -n '`' "$page" || fail "$page has backticks"
  ! grep -n '^\.S[HS] .*:"\?$' "$page" || fail "$page has a heading with a colon"
done

looked=false
for page in "${pages[@]}"; do
  if command -v groff >/dev/null; then
    looked=true
    said=$(groff -man -Tutf8 -ww -rCHECKSTYLE=3 -z "$page" 2>&1)
    [[ -z $said ]] || fail "$said"
  fi
  if command -v mandoc >/dev/null; then
    looked=true
    mandoc -Tlint -Wwarning "$page"
  fi
done
$looked || echo "not available here: groff, mandoc"
