// Ethernet files as they lie on controllers, from KR C2 to KR C4.

#include <algorithm>
#include <iostream>
#include <set>
#include <sstream>
#include <utility>

#include <pugixml.hpp>

#include "daemon/commands/check_command.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"

using namespace acceptance;
namespace fs = std::filesystem;

namespace {

/// The values of a reply in their order: "Element" or "Element.attribute", and the text.
using Values = std::vector<std::pair<std::string, std::string>>;

/// What `sweepd check` printed about one file.
struct Finding {
  std::string ok;
  std::vector<std::string> warnings;
  std::string reply;
};

std::vector<fs::path> ethernet_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".xml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Finding> findings(const std::string& printed) {
  constexpr std::size_t kText = 11;
  std::vector<Finding> all;
  for (const auto line : fields(printed, '\n')) {
    const std::string text(line.substr(std::min(kText, line.size())));
    if (line.starts_with("  ok ")) all.push_back({text, {}, {}});
    if (all.empty()) continue;
    if (line.starts_with("  warning ")) all.back().warnings.push_back(text);
    if (line.starts_with("  reply ")) all.back().reply = text;
  }
  return all;
}

/// What a reply to a controller with this file must hold, worked out from the file alone.
Values expected_values(const pugi::xml_node& root) {
  Values values;
  for (const auto& node : root.child("RECEIVE").child("ELEMENTS").children("ELEMENT")) {
    std::string tag = node.attribute("TAG").value();
    const std::string type = node.attribute("TYPE").value();
    const std::string zero = type == "STRING" ? "" : type == "DOUBLE" ? "0.0" : "0";
    const bool internal = tag.starts_with("DEF_");
    if (internal) tag.erase(0, 4);
    if (internal && tag.starts_with("Tech."))  // DEF_Tech.T2: T21 to T210
      for (int i = 1; i <= 10; ++i) values.emplace_back(tag + std::to_string(i), zero);
    else
      values.emplace_back(tag, zero);
  }
  return values;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// No XML parser takes names that begin with a digit: they get an x before it. In replies, blanks
/// stand before attributes only.
std::string well_formed(const std::string& reply) {
  std::string xml;
  for (const char c : reply) {
    if (!xml.empty() && xml.back() == ' ' && is_digit(c)) xml += 'x';
    xml += c;
  }
  return xml;
}

/// Of what well_formed() made.
Values values_of(const pugi::xml_node& sen) {
  Values values;
  for (const auto& element : sen.children()) {
    const std::string name = element.name();
    if (name == "IPOC") continue;
    if (!element.first_attribute()) values.emplace_back(name, element.text().get());
    for (const auto& attribute : element.attributes()) {
      std::string key = attribute.name();
      if (key.size() > 1 && key[0] == 'x' && is_digit(key[1])) key.erase(0, 1);
      values.emplace_back(name + "." + key, attribute.value());
    }
  }
  return values;
}

void check_reply(const Finding& found, const pugi::xml_node& root) {
  const pugi::xml_node config = root.child("CONFIG");
  if (std::string(config.child("ONLYSEND").text().get()) == "TRUE") {
    CHECK_THAT(found.reply, Catch::Matchers::StartsWith("none"));
    return;
  }
  pugi::xml_document xml;
  REQUIRE(xml.load_string(well_formed(found.reply).c_str()).status == pugi::status_ok);
  const pugi::xml_node sen = xml.child("Sen");
  CHECK(std::string(sen.attribute("Type").value()) == config.child("SENTYPE").text().get());
  CHECK(std::string(sen.child("IPOC").text().get()) == "123456");
  CHECK(std::string(sen.last_child().name()) == "IPOC");
  CHECK(values_of(sen) == expected_values(root));

  std::set<std::string> elements;  // dotted tags of one element are folded into it
  std::size_t children = 0;
  for (const auto& child : sen.children()) {
    elements.insert(child.name());
    ++children;
  }
  CHECK(children == elements.size());
}

}  // namespace

TEST_CASE("Every Ethernet file from a controller is read and gets the right reply",
          "[ethernet_files]") {
  const auto folder = real_data("ethernet-configs");
  if (!folder) return;
  const auto files = ethernet_files(*folder);
  REQUIRE(files.size() == 6);
  std::ostringstream out;
  CHECK(sweepd::check({{}, files}, out) == 0);
  std::cout << out.str() << '\n';
  const auto found = findings(out.str());
  REQUIRE(found.size() == files.size());

  std::cout << left("file", 28) << left("Type", 8) << "tags  values  placeholder\n";
  for (std::size_t i = 0; i < files.size(); ++i) {
    INFO(files[i].filename().string());
    CHECK_THAT(found[i].ok, Catch::Matchers::StartsWith(files[i].string()));
    pugi::xml_document file;
    REQUIRE(file.load_file(files[i].c_str()));
    const pugi::xml_node root = file.child("ROOT");
    check_reply(found[i], root);

    const std::string ip = root.child("CONFIG").child("IP_NUMBER").text().get();
    const bool placeholder = ip.find_first_not_of("0123456789.") != std::string::npos;
    const bool warned =
        std::any_of(found[i].warnings.begin(), found[i].warnings.end(),
                    [&](const std::string& text) { return text.find(ip) != std::string::npos; });
    CHECK(warned == placeholder);
    const auto tags = root.child("RECEIVE").child("ELEMENTS").children("ELEMENT");
    std::cout << left(files[i].filename().string(), 28)
              << left(root.child("CONFIG").child("SENTYPE").text().get(), 8)
              << right(static_cast<double>(std::distance(tags.begin(), tags.end())), 0, 4)
              << right(static_cast<double>(expected_values(root).size()), 0, 8) << "  "
              << (placeholder ? ip + ", warned about" : "") << '\n';
  }
}
