#include "daemon/commands/command_line.hpp"

#include <iostream>
#include <stdexcept>
#include <streambuf>
#include <vector>

#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using sweepd::CommandLine;

namespace {

int execute(const std::vector<const char*>& words) {
  std::vector<const char*> all{"sweepd"};
  all.insert(all.end(), words.begin(), words.end());
  return CommandLine().execute(static_cast<int>(all.size()), all.data());
}

std::string problem(const std::vector<const char*>& words) {
  try {
    static_cast<void>(execute(words));
  } catch (const std::invalid_argument& wrong) {
    return wrong.what();
  }
  return "no problem";
}

/// Takes the place of a stream's buffer.
class Instead {
 public:
  Instead(std::ostream& stream, std::streambuf* buffer)
      : stream_(stream), before_(stream.rdbuf(buffer)) {}
  ~Instead() { stream_.rdbuf(before_); }
  Instead(const Instead&) = delete;
  Instead& operator=(const Instead&) = delete;

 private:
  std::ostream& stream_;
  std::streambuf* before_;
};

/// A disk without room.
struct Full : std::streambuf {};

}  // namespace

TEST_CASE("what cannot be printed is told, and no success", "[command_line]") {
  Full full;
  std::stringbuf errors;
  int code = 0;
  {
    const Instead out(std::cout, &full);
    const Instead err(std::cerr, &errors);
    code = execute({"--help"});
  }
  CHECK(code == 1);
  CHECK_THAT(errors.str(), StartsWith("sweepd: standard output cannot be written"));
}

TEST_CASE("a description that watch cannot read is told before RSI comes", "[command_line]") {
  CHECK_THROWS_AS(execute({"watch", "--robot", "/nowhere/kr5.toml"}), sweepd::ConfigError);
}

TEST_CASE("wrong usage is told in this program's words", "[command_line]") {
  CHECK(problem({}) == "name a command: `sweepd --help` tells how it is used");
  CHECK_THAT(problem({"--foo"}), StartsWith("--foo is no option: `sweepd --help`"));
  CHECK_THAT(problem({"frob"}), StartsWith("frob is no command: `sweepd --help`"));
  CHECK_THAT(problem({"runn"}), StartsWith("runn is no command: did you mean run?"));
  CHECK_THAT(problem({"insepct", "x"}), StartsWith("insepct is no command: did you mean inspect?"));
  CHECK_THAT(problem({"help", "run"}), StartsWith("help is no command: `sweepd --help`"));
  CHECK_THAT(problem({"-x", "check"}), StartsWith("-x is no option: `sweepd --help`"));
  CHECK_THAT(problem({"replay", "x", "--robot", "a", "--robot", "b"}),
             StartsWith("--robot is given twice: give it once"));
  CHECK_THAT(problem({"inspect", "x", "--port"}),
             StartsWith("--port needs a value: give PORT, 1 to 65535"));
  CHECK_THAT(problem({"plan", "--robot", "r", "--poses", "20", "--device", "1,2"}),
             StartsWith("--device needs all of its values: give X,Y,Z"));
  CHECK_THAT(problem({"plan", "--robot", "r", "--plan", "p", "--krl", "krc3"}),
             StartsWith("--krl takes krc2, krc4, iiqka: found krc3"));
  CHECK_THAT(problem({"plan", "--robot", "r", "--plan", "p", "--cycle-ms", "0"}),
             StartsWith("--cycle-ms: expected 1 to 1000, found 0"));
  CHECK_THAT(problem({"plan", "--robot", "r", "--plan", "p", "--cycle-ms", "12.5"}),
             StartsWith("--cycle-ms: expected a whole number, 1 to 1000, found 12.5"));
  for (const char* option : {"--floor-mm=nan", "--device=0,nan,0", "--facing=inf,0,1",
                             "--keep-out=0,0,0,1,1,nan", "--tool-mm=nan,0,0"})
    CHECK_THAT(problem({"plan", "--robot", "r", "--poses", "20", option}),
               ContainsSubstring(": expected a number, found "));
  const std::vector<const char*> simulate{"simulate", "--robot", "r", "--plan", "p"};
  CHECK_THAT(problem(simulate), StartsWith("give --to or --write: `sweepd simulate --help`"));
  auto both = simulate;
  both.insert(both.end(), {"--to", "127.0.0.1:1", "--write", "x"});
  CHECK_THAT(problem(both), StartsWith("give --to or --write, and only one: "));
  CHECK_THAT(problem({"inspect", "--quite", "x"}),
             StartsWith("--quite is no option: did you mean --quiet?"));
  // And not that the one is missing that was meant.
  CHECK_THAT(problem({"plan", "--robt", "r", "--plan", "p"}),
             StartsWith("--robt is no option: did you mean --robot?"));
  CHECK_THAT(problem({"correct", "a", "--levl", "frames"}),
             StartsWith("--levl is no option: did you mean --level?"));
  CHECK_THAT(problem({"compare", "--level", "nan", "a", "b"}),
             StartsWith("--level: expected 0.000001 to 0.5, found nan"));
  CHECK_THAT(problem({"compare", "a", "b", "c"}), StartsWith("c is one argument too many: "));
}

TEST_CASE("an option is refused where what it belongs to is not asked for", "[command_line]") {
  const auto with = [](std::vector<const char*> words, std::initializer_list<const char*> more) {
    words.insert(words.end(), more);
    return problem(words);
  };
  const std::vector<const char*> plan{"plan", "--robot", "r", "--plan", "p"};
  CHECK_THAT(with(plan, {"--krl-tool", "2"}), StartsWith("--krl-tool requires --krl: "));
  CHECK_THAT(with(plan, {"--rsi-file", "a.rsi"}), StartsWith("--rsi-file requires --krl: "));
  CHECK_THAT(with(plan, {"--margin-deg", "9"}), StartsWith("--margin-deg: expected --propose, "));
  const std::vector<const char*> poses{"plan", "--robot", "r", "--poses", "20"};
  CHECK_THAT(with(poses, {"--name", "n"}), StartsWith("--name requires --output: "));
  CHECK_THAT(with(poses, {"--cycle-ms", "12"}), StartsWith("--cycle-ms requires --plan: "));
  CHECK_THAT(with(poses, {"--precision", "3"}), StartsWith("--precision requires --plan: "));
  const std::vector<const char*> write{"simulate", "--robot", "r", "--plan", "p", "--write", "w"};
  CHECK_THAT(with(write, {"--check", "sweepd"}), StartsWith("--check requires --to: "));
  CHECK_THAT(with(write, {"--timeout-cycles", "9"}),
             StartsWith("--timeout-cycles requires --to: "));
  const std::vector<const char*> correct{"correct", "result", "--level", "mastering"};
  CHECK_THAT(with(correct, {"--base", "{X 0}"}), StartsWith("--base requires --program: "));
  CHECK_THAT(with(correct, {"--largest-shift", "1"}),
             StartsWith("--largest-shift requires --program: "));
  CHECK_THAT(with(correct, {"--tool", "{X 0}"}), StartsWith("--tool needs --level targets or "));
  for (const char* option : {"--rebuild", "--index=i"})
    CHECK_THAT(problem({"history", "a/b/c", option, "--database", "dbname=x"}),
               ContainsSubstring(" excludes --"));
  CHECK_THAT(problem({"note", ".", "--at", "2026-03-01"}), StartsWith("--at dates a note, and "));
  CHECK_THAT(problem({"identify", "--axes", "a.csv", "--poses"}),
             StartsWith("--poses is for files of points: leave it out with --axes"));
}

TEST_CASE("a path that is empty is refused", "[command_line]") {
  const char* const refused = ": expected a path, found an empty one: `sweepd ";
  for (const std::vector<const char*>& words : std::vector<std::vector<const char*>>{
           {"report", ""},
           {"report", "a", "--output", ""},
           {"identify", ""},
           {"identify", "a.csv", "--output", ""},
           {"identify", "a.csv", "--angles", ""},
           {"replay", "a.pcap", ""},
           {"replay", "a.pcap", "--config", ""},
           {"export", "a.pcap", "--csv", ""},
           {"simulate", "--robot", "r", "--plan", "p", "--write", ""},
           {"correct", "result", "--level", "targets", "--program", "", "--write", "w"},
           {"compare", "a", ""},
           {"note", ""},
           {"run", "--config", ""}}) {
    INFO(words.front() << ' ' << words.back());
    CHECK_THAT(problem(words), ContainsSubstring(refused));
  }
}

TEST_CASE("a number that is too large, and a word that is too long, are told readably",
          "[command_line]") {
  const std::vector<const char*> seed{
      "simulate", "--robot", "r", "--plan", "p", "--write", "w", "--seed", "99999999999999999999"};
  CHECK_THAT(
      problem(seed),
      StartsWith("--seed: expected at most 18446744073709551615, found 99999999999999999999"));
  const std::string word(100'000, 'k');
  const std::string shown = std::string(60, 'k') + "...";
  CHECK(problem({word.c_str()}) == shown + " is no command: `sweepd --help` tells how it is used");
  CHECK_THAT(problem({"inspect", "x", "--port", word.c_str()}),
             StartsWith("--port: expected 1 to 65535, found " + shown + ": "));
}
