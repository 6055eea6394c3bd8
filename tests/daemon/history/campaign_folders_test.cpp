#include "daemon/history/campaign_folders.hpp"

#include <algorithm>

#include "daemon/history/campaign_index.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/history/whole_result.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::campaigns_in;
using sweepd::FoundCampaigns;
using sweepd::IndexOptions;
using sweepd::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

/// A robot's folder with some campaigns, and an index beside it.
class CampaignTree {
 public:
  CampaignTree() {
    for (const char* name : {"2024-01-01", "2024-02-01", "2024-03-01"}) add(name);
  }
  void add(const std::string& name) const {
    fs::create_directories(robot() / name);
    (void)folder_.write("robot/" + name + "/result.json", sweepd::test::whole_result().dump());
  }
  void write(const std::string& name, const std::string& content) const {
    (void)folder_.write("robot/" + name, content);
  }
  [[nodiscard]] fs::path robot() const { return folder_ / "robot"; }
  [[nodiscard]] fs::path index() const { return folder_ / "index"; }
  [[nodiscard]] FoundCampaigns found(bool rebuild = false) const {
    return campaigns_in({robot()}, {index(), rebuild});
  }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

std::string all(const std::vector<std::string>& messages) {
  std::string text;
  for (const auto& message : messages) text += message + '\n';
  return text;
}

/// What an index knows of a folder, changed so that it can be told from the folder.
void forge(const CampaignTree& tree) {
  sweepd::CampaignIndex index(tree.index(), false);
  auto entries = index.entries();
  REQUIRE_FALSE(entries.empty());
  for (auto& [folder, entry] : entries) {
    auto record = sweepd::unpacked(entry.record.data(), entry.record.size());
    record.arm->robot = "forged";
    entry.record = packed(record);
  }
  index.update(entries, {});
}

std::size_t forged(const FoundCampaigns& found) {
  return static_cast<std::size_t>(
      std::count_if(found.records.begin(), found.records.end(),
                    [](const auto& record) { return record.arm->robot == "forged"; }));
}

}  // namespace

TEST_CASE("campaigns are found in a robot's folder and one level farther down",
          "[campaign_folders]") {
  const CampaignTree tree;
  tree.write("notes.jsonl", "{\"time\":\"2024-01-15\",\"text\":\"collision\"}\nnonsense\n");
  const FoundCampaigns found = campaigns_in({tree.folder().path()}, {});
  CHECK(found.records.size() == 3);
  REQUIRE(found.notes.size() == 1);
  CHECK_THAT(all(found.messages), ContainsSubstring("Line 2 of"));
  CHECK(campaigns_in({tree.robot() / "2024-01-01", tree.robot()}, {}).records.size() == 3);
  CHECK_FALSE(fs::exists(tree.robot() / sweepd::kIndexFile));  // they are few
  CHECK_THROWS_WITH(campaigns_in({tree.robot() / "nowhere"}, {}),
                    ContainsSubstring("nowhere is no folder"));
}

TEST_CASE("a folder that is reached on two ways is one, with its notes", "[campaign_folders]") {
  const CampaignTree tree;
  tree.write("notes.jsonl", "{\"time\":\"2024-01-15\",\"text\":\"collision\"}\n");
  fs::create_directory_symlink(tree.robot(), tree.folder() / "link");
  for (const fs::path& way : {tree.folder() / "link", tree.robot() / ".", tree.folder().path()}) {
    const FoundCampaigns found = campaigns_in({tree.robot(), way}, {});
    INFO(way);
    CHECK(found.records.size() == 3);
    CHECK(found.notes.size() == 1);
  }
}

TEST_CASE("half deleted folders are named", "[campaign_folders]") {
  const CampaignTree tree;
  fs::remove(tree.robot() / "2024-02-01" / "result.json");
  tree.write("2024-02-01/run.json", "{}");
  const FoundCampaigns found = tree.found();
  REQUIRE(found.records.size() == 3);
  CHECK_THAT(found.records[1].why_not, ContainsSubstring("2024-02-01 has no result.json"));
}

TEST_CASE("the index tells what has not changed, folders the rest", "[campaign_folders]") {
  const CampaignTree tree;
  CHECK(tree.found().records.size() == 3);
  forge(tree);
  CHECK(forged(tree.found()) == 3);
  SECTION("a folder that changed") {
    tree.write("2024-02-01/notes.jsonl", "{\"time\":\"2024-02-02\",\"text\":\"new gear\"}\n");
    const FoundCampaigns found = tree.found();
    CHECK(forged(found) == 2);
    CHECK(found.records[1].notes.size() == 1);
    CHECK(found.messages.empty());
  }
  SECTION("a new one") {
    tree.add("2024-04-01");
    CHECK(tree.found().records.size() == 4);
    forge(tree);
    CHECK(forged(tree.found()) == 4);
  }
  SECTION("one that vanished is named, once") {
    fs::remove_all(tree.robot() / "2024-02-01");
    const FoundCampaigns found = tree.found();
    CHECK(found.records.size() == 2);
    CHECK_THAT(
        all(found.messages),
        ContainsSubstring("Gone since the index was written: 1 campaign (robot/2024-02-01)."));
    CHECK(tree.found().messages.empty());
  }
  SECTION("made anew") {
    CHECK(forged(tree.found(true)) == 0);
    CHECK(forged(tree.found()) == 0);
  }
}

TEST_CASE("an index that cannot be used does no harm", "[campaign_folders]") {
  const CampaignTree tree;
  SECTION("a file of somebody") {
    (void)tree.folder().write("index", std::string(200, 'x'));
    for (const bool rebuild : {false, true}) {
      const FoundCampaigns found = tree.found(rebuild);
      CHECK(found.records.size() == 3);
      CHECK(all(found.messages) ==
            "The index " + tree.index().string() +
                " is a file of another program. Name another file with --index. All folders were "
                "read.\n");
    }
    CHECK(sweepd::test::content(tree.index()) == std::string(200, 'x'));
  }
  SECTION("a damaged one") {
    (void)tree.found();
    std::string bytes = sweepd::test::content(tree.index());
    std::fill(bytes.begin() + 100, bytes.end(), '\x5a');
    (void)tree.folder().write("index", bytes);
    FoundCampaigns found = tree.found();
    CHECK(found.records.size() == 3);
    CHECK(all(found.messages) ==
          "The index " + tree.index().string() +
              " cannot be used (database disk image is malformed). Make it anew with --rebuild, or "
              "name another file with --index. All folders were read.\n");
    found = tree.found(true);
    CHECK(found.records.size() == 3);
    CHECK(found.messages.empty());
    CHECK(tree.found().messages.empty());
  }
  SECTION("a folder in its place") {
    fs::create_directory(tree.index());
    const FoundCampaigns found = tree.found();
    CHECK(found.records.size() == 3);
    CHECK(all(found.messages) ==
          "The index " + tree.index().string() +
              " cannot be opened (unable to open database file). Check the path and the "
              "permissions, or name another file with --index. All folders were read.\n");
  }
  SECTION("a record of nonsense") {
    (void)tree.found();
    sweepd::CampaignIndex index(tree.index(), false);
    auto entries = index.entries();
    entries.begin()->second.record.assign(7, 0xff);
    index.update(entries, {});
    CHECK(tree.found().records.size() == 3);
  }
}
