#include "daemon/commands/export_command.hpp"

#include <algorithm>
#include <sstream>

#include "rsi/capture/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::export_csv;
using namespace sweepd::test;
namespace fs = std::filesystem;

namespace {

struct Exported {
  int code = 0;
  std::string csv;
  std::string errors;
};

Exported exported(const std::vector<fs::path>& traces, rsi::ConversationFilter filter = {}) {
  std::ostringstream out;
  std::ostringstream errors;
  const int code = export_csv({traces, "-", filter}, out, errors);
  return {code, out.str(), errors.str()};
}

}  // namespace

TEST_CASE("an export has time, IPOC, RIst, then every other signal as it was printed",
          "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file)
      .add(telegram(1000,
                    R"(<DiL>0</DiL><Tech C11="1.0"  C17="-2.50"/><RIst X="1.5" Y="2" Z="3"/>)"))
      .add(telegram(1004,
                    R"(<DiL>7</DiL><Tech C11="1.1"  C17="-2.51"/><RIst X="1.6" Y="2" Z="3"/>)"));
  const auto result = exported({file});
  CHECK(result.code == 0);
  CHECK(result.errors.empty());
  CHECK(result.csv ==
        "t_s,ipoc,RIst.X,RIst.Y,RIst.Z,DiL,Tech.C11,Tech.C17\n"
        "0.000,1000,1.5,2,3,0,1.0,-2.50\n"
        "0.004,1004,1.6,2,3,7,1.1,-2.51\n");
}

TEST_CASE("a value that CSV would take for more than one is quoted", "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file).add(telegram(1000, R"(<EStr>a, "b"</EStr><Note>plain</Note>)"));
  CHECK(exported({file}).csv == "t_s,ipoc,EStr,Note\n0.000,1000,\"a, \"\"b\"\"\",plain\n");
}

TEST_CASE("telegrams that differ share the columns of all, and leave empty what they lack",
          "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file)
      .add("<Rob><IPOC>1000</IPOC></Rob>")  // the first packet of old controllers
      .add(telegram(1004, R"(<A>1</A><B X="2"/>)"))
      .add(telegram(1008, R"(<B X="3"/><C>4</C><A>5</A>)"))
      .add(telegram(1012, R"(<A>6</A><RIst X="7"/>)"));
  CHECK(exported({file}).csv ==
        "t_s,ipoc,RIst.X,A,B.X,C\n"
        "0.000,1000,,,,\n"
        "0.004,1004,,1,2,\n"
        "0.008,1008,,5,3,4\n"
        "0.012,1012,7,6,,\n");
}

TEST_CASE("rows come in the order of reception: swapped and doubled telegrams show",
          "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file)
      .add(telegram(1000, ""))
      .add(telegram(1008, ""))
      .add(telegram(1004, ""))
      .add(telegram(1004, ""));
  CHECK(exported({file}).csv == "t_s,ipoc\n0.000,1000\n0.008,1008\n0.004,1004\n0.004,1004\n");
}

TEST_CASE("datagrams that are no telegrams have no row, and are said", "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file)
      .add(telegram(1000, "<A>1</A>"))
      .add("binary \xff\xfe")
      .add("<Rob Type=\"KUKA\"><A>2</A>")
      .add("<Sen Type=\"ImFree\"><IPOC>1000</IPOC></Sen>", kServer, kController)
      .add(telegram(1004, "<A>3</A>"));
  const auto result = exported({file});
  CHECK(result.code == 0);
  CHECK(result.csv == "t_s,ipoc,A\n0.000,1000,1\n0.004,1004,3\n");
  CHECK_THAT(result.errors, ContainsSubstring("sweepd: 2 datagrams"));
}

TEST_CASE("several captures are one stream, and one conversation of several is chosen",
          "[export_command]") {
  const TemporaryFolder folder;
  const auto other = *rsi::parse_endpoint("192.168.1.30:49200");
  const auto first = folder / "1.pcap";
  const auto second = folder / "2.pcap";
  Capture(first).add(telegram(1000, "")).add(telegram(5, "<B/>"), other).add(telegram(1004, ""));
  Capture(second).add(telegram(1008, ""));
  const auto result = exported({first, second});
  CHECK(result.csv == "t_s,ipoc\n0.000,1000\n0.004,1004\n0.008,1008\n");
  CHECK_THAT(result.errors, ContainsSubstring("192.168.1.30") && ContainsSubstring("--controller"));
  const auto chosen = exported({first, second}, {{}, other.address});
  CHECK_THAT(chosen.csv, ContainsSubstring("0.000,5"));
}

TEST_CASE("a capture without RSI is exit 1 with one sentence, and leaves no file",
          "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file).add("something else");
  std::ostringstream errors;
  CHECK(export_csv({{file}, folder / "x.csv", {}}, errors, errors) == 1);
  CHECK_THAT(errors.str(),
             ContainsSubstring("sweepd: no RSI among 1 UDP datagram (IPv4) in 1 packet:"));
  CHECK(std::count(errors.view().begin(), errors.view().end(), '\n') == 1);
  CHECK_FALSE(fs::exists(folder / "x.csv"));
}

TEST_CASE("an export into a file has the same bytes; a full disk is exit 1", "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  std::uint64_t ipoc = 1000;
  Capture(file).add_stroke(ipoc, 0, 60);
  std::ostringstream out;
  std::ostringstream errors;
  CHECK(export_csv({{file}, folder / "x.csv", {}}, out, errors) == 0);
  CHECK(out.str().empty());
  CHECK(errors.str().empty());
  CHECK(content(folder / "x.csv") == exported({file}).csv);
  CHECK(export_csv({{file}, "/dev/full", {}}, out, errors) == 1);
  CHECK_THAT(errors.str(), ContainsSubstring("sweepd: cannot write /dev/full") &&
                               ContainsSubstring("free space"));
  CHECK_THROWS_WITH(export_csv({{file}, file / "x.csv", {}}, out, errors),
                    ContainsSubstring("Not a directory"));
}

TEST_CASE("a capture that is cut off is exported as far as it goes, and said", "[export_command]") {
  const TemporaryFolder folder;
  const auto file = folder / "x.pcap";
  Capture(file).add(telegram(1000, "<A>1</A>")).add(telegram(1004, "<A>2</A>"));
  fs::resize_file(file, fs::file_size(file) - 5);
  const auto result = exported({file});
  CHECK(result.code == 0);
  CHECK(result.csv == "t_s,ipoc,A\n0.000,1000,1\n");
  CHECK_THAT(result.errors, ContainsSubstring("cut off"));
}
