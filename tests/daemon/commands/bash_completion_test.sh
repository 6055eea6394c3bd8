#!/usr/bin/env bash
# The completion for bash, called as bash calls it.
#
#   bash_completion_test.sh COMPLETION SWEEPD
set -euo pipefail

# shellcheck source=/dev/null
source "$1"
sweepd=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir recordings
touch 'my robot.toml' trace.pcap
failed=0

# complete WORD…: what is offered for the last word, sorted, in one line with | between.
complete_words() {
  COMP_WORDS=(sweepd "$@")
  COMP_CWORD=$#
  COMPREPLY=()
  _sweepd
  printf '%s\n' "${COMPREPLY[@]}" | sort | paste -sd '|'
}

# expect OFFERED WORD…
expect() {
  local expected=$1 offered
  shift
  offered=$(complete_words "$@")
  if [[ $offered != "$expected" ]]; then
    echo "for: sweepd $*"
    echo "  expected: $expected"
    echo "  offered:  $offered"
    failed=1
  fi
}

# The commands and options that --help tells are those that are offered.
commands=$("$sweepd" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p')
[[ $commands == *simulate* ]]
expect "$(printf '%s\n' $commands --help --version | sort | paste -sd '|')" ''
for command in $commands; do
  options=$("$sweepd" "$command" --help | sed -n 's/^  \(-h, \)\?\(--[a-z-]*\).*/\2/p' | sort -u | paste -sd '|')
  expect "$options" "$command" --
done

expect 'replay|report' re
expect '--version' --v
expect '--listen' run --l
expect 'device|robot' identify --frame ''
expect 'robot' identify --frame r
expect 'robot' identify --frame = r
expect 'device|robot' identify --frame =
files='my robot.toml|recordings|trace.pcap'
expect "$files" replay ''
expect 'trace.pcap' replay my.pcap t
expect "$files" run --config ''
expect 'my robot.toml' simulate --robot m
expect 'recordings' run --output ''
expect "$files" check --ethernet-config one.xml ''
expect '' check one.xml ''
expect '' run --listen ''
expect '' simulate --seed ''
expect "$files" identify --quiet ''
expect '' frobnicate ''
exit $failed
