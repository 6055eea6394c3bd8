#include "daemon/record/session_folder.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using sweepd::test::TemporaryFolder;

TEST_CASE("sessions without an end are unfinished, the newest first, also where no trace is left",
          "[session_folder]") {
  const TemporaryFolder folder;
  const auto session = [&](const std::string& name, const std::string& run, bool trace) {
    std::filesystem::create_directory(folder / name);
    if (trace) static_cast<void>(folder.write(name + "/trace.pcap", ""));
    return folder.write(name + "/run.json", run).parent_path();
  };
  const auto with_trace = session("20250101T000000Z", R"({"command": "run"})", true);
  const auto without = session("20250102T000000Z", R"({"command": "run"})", false);
  const auto watched = session("20250103T000000Z", R"({"command": "watch"})", true);
  session("20250104T000000Z", R"({"command": "run", "ended": "20250104T010000Z"})", false);
  session("20250105T000000Z", R"({"command": "replay"})", true);
  session("20250106T000000Z", "{", false);  // of nobody knows whom
  session("notes", R"({"command": "run"})", true);
  CHECK(sweepd::unfinished_sessions(folder.path()) ==
        std::vector<std::filesystem::path>{watched, without, with_trace});
}
