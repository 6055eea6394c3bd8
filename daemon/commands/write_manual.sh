#!/bin/sh
# Writes the manual pages and the completion for bash: help2man joins what sweepd says of itself with
# what is written by hand. Runs while sweepd is built.
#
#   write_manual.sh SWEEPD SOURCE_FOLDER OUTPUT_FOLDER CHANGELOG COMMAND...
set -eu
sweepd=$1 source=$2 output=$3 changelog=$4
shift 4

rm -f "$output"/sweepd*  # pages of commands that there are no more
version=$("$sweepd" --version)
SOURCE_DATE_EPOCH=$(date -d "$(sed -n 's/^ -- .*>  //p' "$changelog" | head -n 1)" +%s)
export SOURCE_DATE_EPOCH

# page NAME SECTION MANUAL HELP INCLUDE [NAME_PARAGRAPH]
# Then the page is put into the form of those written by hand. The command stands with the program in
# the synopsis. Headings have no colon, and the exit status is a section. Of an entry's name the value
# is in italics. What stands in backticks is bold.
page() {
  help2man --no-info --section="$2" --manual="$3" --source="$version" --version-string="$1 ${version#* }" \
    --help-option="$4" --include="$5" ${6:+--name="$6"} "$sweepd" >"$output/$1.$2.new"
  sed -e '/^\.B sweepd$/{N;s/\n\\fI\\,\([a-z\\-]*\) \\\/\\fR/ \1\n/}' \
    -e 's/^\.SS "Exit status:"/.SH "EXIT STATUS"/' -e 's/^\(\.SS ".*\):"$/\1"/' -e 's/^\.IP$/.PP/' \
    -e '/^\.TP$/{n;s/^\(\\fB.*\) \([A-Z].*\)$/\1 \\fI\2\\fR/;s/^[a-z]*$/\\fB&\\fR/
      s/^\([a-z_]*\) = \(.*\)$/\\fB\1\\fR = \\fI\2\\fR/}' "$output/$1.$2.new" |
    sed -z -e 's/`\([^`]*\)`/\x01\1\x02/g;:more;s/\(\x01[^\x02]*\)\\f[BR]/\1/;tmore' \
      -e 's/\x01/\\fB/g;s/\x02/\\fR/g' >"$output/$1.$2"
  rm "$output/$1.$2.new"
  gzip -9nkf "$output/$1.$2"
}

printf '.BR sweepd\\-%s (1),\n' "$@" >"$output/sweepd.pages"  # which the first page refers to
sed "/^\[SEE ALSO\]\$/r $output/sweepd.pages" "$source/sweepd.1.in" >"$output/sweepd.1.in"
page sweepd 1 'User commands' --help "$output/sweepd.1.in"
rm "$output/sweepd.pages" "$output/sweepd.1.in"
for command; do
  # The paragraph below the usage is what the command does.
  does=$("$sweepd" "$command" --help | sed -e 1,2d -e '/^$/,$d' | tr '\n' ' ' | sed 's/^\(.\)\(.*\)\. $/\l\1\2/')
  page "sweepd-$command" 1 'User commands' "$command --help" "$source/sweepd-command.1.in" "$does"
done
page sweepd.toml 5 'File formats' 'run --help-settings' "$source/sweepd.toml.5.in"
"$sweepd" --bash-completion >"$output/sweepd.bash"
