#!/usr/bin/env bash
# The libraries know only what their layer may know, and never print, log or abort.
#
#   layers_test.sh SOURCE_FOLDER
#
# First the check has to find violations planted in a folder of its own, then nothing in the tree.
set -euo pipefail

# Includes are listed by what is allowed: another library needs a decision here.
standard='<[a-z_0-9]+>'
posix='<([a-z_0-9]+|(sys|net|netinet|arpa|linux)/[a-z_0-9]+)\.h>'
talking='<(iostream|ostream|print|syncstream|cassert|assert\.h|syslog\.h)>'
busy='<(thread|mutex|shared_mutex|condition_variable|future|stop_token|semaphore|latch|barrier|atomic|fstream|filesystem|cstdio)>'

# violations LAYER ALLOWED FORBIDDEN: prints FILE:LINE: TEXT of each. Fails if there is no source.
violations() {
  local sources
  mapfile -t sources < <(find "$1" -type f ! -name CMakeLists.txt | sort)
  if ((${#sources[@]} == 0)); then
    echo "$1: no sources found"
    return
  fi
  awk -v allowed="^($2)" -v forbidden="^($3)" '
    { code = $0; sub(/\/\/.*/, "", code) }
    code ~ /^[ \t]*#[ \t]*include/ {
      header = code
      sub(/^[ \t]*#[ \t]*include[ \t]*/, "", header)
      if (header !~ allowed || header ~ forbidden) print FILENAME ":" FNR ": " $0
      next
    }
    code ~ /std::(cout|cerr|clog)/ ||
    code ~ /(^|[^A-Za-z0-9_])(v?f?printf|f?puts|putchar|perror|syslog|assert|abort|_?exit|_Exit|quick_exit|terminate)[ \t]*\(/ {
      print FILENAME ":" FNR ": " $0
    }' "${sources[@]}"
}

check_tree() (
  cd "$1"
  violations rsi "$standard|$posix|<boost/|<pugixml\.hpp>|<pcap/|\"rsi/" "$talking"
  violations identify "$standard|<Eigen/|\"identify/" "$talking|$busy"
)

plot=$(mktemp -d)
trap 'rm -rf "$plot"' EXIT
mkdir "$plot/rsi" "$plot/identify"
failed=0

# expect COUNT LAYER LINE: how many violations the check sees in a source that has just this line.
expect() {
  local seen
  echo '#include <vector>' | tee "$plot/rsi/some.hpp" >"$plot/identify/some.hpp"
  printf '%s\n' "$3" >"$plot/$2/planted.cpp"
  seen=$(check_tree "$plot" | wc -l)
  rm "$plot/$2/planted.cpp"
  if ((seen != $1)); then
    echo "the check sees $seen violations instead of $1 in $2: $3"
    failed=1
  fi
}

for header in '"identify/sample.hpp"' '"daemon/settings.hpp"' '"../daemon/settings.hpp"' \
  '<Eigen/Core>' '<spdlog/spdlog.h>' '<fmt/core.h>' '<toml++/toml.h>' '<nlohmann/json.hpp>' \
  '<CLI/CLI.hpp>' '<iostream>' '<cassert>'; do
  expect 1 rsi "#include $header"
done
for header in '"rsi/telegram.hpp"' '"daemon/settings.hpp"' '<boost/asio/buffer.hpp>' \
  '<pugixml.hpp>' '<pcap/pcap.h>' '<spdlog/spdlog.h>' '<thread>' '<mutex>' '<fstream>' \
  '<iostream>' '<filesystem>' '<sys/socket.h>' '<unistd.h>'; do
  expect 1 identify "  #  include $header  // needed here"
done
for layer in rsi identify; do
  for code in 'std::cout << 1;' '  std::cerr << 1;' 'printf("%d", 1);' 'std::fprintf(stderr, "x");' \
    'std::abort();' 'if (bad) exit(1);' '::_exit(1);' 'assert(n > 0);' 'std::terminate();'; do
    expect 1 "$layer" "$code"
  done
  for code in '// abort() would be wrong here' 'static_assert(sizeof(int) == 4);' \
    'std::snprintf(text, sizeof text, "x");' 'case operation_aborted: on_exit();' \
    "#include \"$layer/some.hpp\"" '#include <charconv>'; do
    expect 0 "$layer" "$code"
  done
done
expect 0 rsi '#include <boost/asio/buffer.hpp>'
expect 0 rsi '#include <sys/eventfd.h>'
expect 0 identify '#include <Eigen/Geometry>'

found=$(check_tree "$1")
if [[ -n $found ]]; then
  echo "A layer knows or does what it must not:"
  echo "$found"
  failed=1
fi
exit $failed
