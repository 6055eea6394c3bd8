#!/usr/bin/env bash
# The manual pages are sound for groff and for mandoc, whichever is there.
#
#   manual_lint_test.sh PAGE…
set -euo pipefail

looked=false
for page in "$@"; do
  if command -v groff >/dev/null; then
    looked=true
    said=$(groff -man -Tutf8 -ww -rCHECKSTYLE=3 -z "$page" 2>&1)
    [[ -z $said ]] || { echo "$said"; exit 1; }
  fi
  if command -v mandoc >/dev/null; then
    looked=true
    mandoc -Tlint -Wwarning "$page"
  fi
done
$looked || echo "not available here: groff, mandoc"
