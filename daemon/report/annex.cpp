#include <algorithm>
#include <array>

#include "daemon/report/report_parts.hpp"
#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

/// So many joints stand beside each other.
constexpr std::size_t kColumns = 6;

std::vector<std::string> fields_of(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const auto end = std::min(text.find(at, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool is_word(const std::string& text) {
  return !text.empty() && text.find_first_of("0123456789") == std::string::npos;
}

/// One column a joint, one row a name; in blocks of so many joints as fit a page.
void add_columns(Markup parent, const std::string& caption, const std::vector<std::string>& names,
                 const std::vector<std::vector<std::string>>& joints) {
  for (std::size_t from = 0; from < joints.size(); from += kColumns) {
    const std::size_t to = std::min(from + kColumns, joints.size());
    auto table = parent.add("table", {{"class", "all"}});
    if (from == 0) table.put("caption", caption);
    auto head = table.add("thead").add("tr");
    head.put("th", "joint", {{"scope", "col"}});
    for (std::size_t j = from; j < to; ++j)
      head.put("th", std::to_string(j + 1), {{"scope", "col"}, {"class", "number"}});
    auto body = table.add("tbody");
    for (std::size_t k = 0; k < names.size(); ++k) {
      auto row = body.add("tr");
      row.put("th", names[k], {{"scope", "row"}});
      for (std::size_t j = from; j < to; ++j) {
        const std::string text = k < joints[j].size() ? joints[j][k] : "";
        row.put("td", text.empty() ? "–" : text, {{"class", is_word(text) ? "word" : "number"}});
      }
    }
  }
}

void add_dh_csv(Markup parent, const std::string& csv) {
  auto lines = fields_of(csv, '\n');
  if (lines.size() < 2) return;
  auto names = fields_of(lines.front(), ',');
  std::vector<std::vector<std::string>> joints;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i].empty()) continue;
    auto cells = fields_of(lines[i], ',');
    if (!cells.empty()) cells.erase(cells.begin());
    joints.push_back(std::move(cells));
  }
  names.erase(names.begin());
  add_columns(parent, "All numbers of dh.csv.", names, joints);
}

std::string cell(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fixed(value.get<double>(), 6);
  return value.is_number() ? value.dump() : std::string();
}

bool is_number_of_arm(const std::string& key) {
  return key != "joint" && key != "by_convention" && key.find("_sigma") == std::string::npos;
}

struct Form {
  const char* key;
  const char* title;
};
constexpr std::array<Form, 6> kForms{
    {{"dh", "Denavit-Hartenberg, with base and tool."},
     {"modified_dh", "Modified Denavit-Hartenberg (Craig)."},
     {"hayati", "Hayati: Denavit-Hartenberg, and β between parallel axes."},
     {"s_model", "S-model (Stone)."},
     {"exponentials", "Product of exponentials: twists at home."},
     {"urdf", "URDF: origins of the joints."}}};

void add_model(Markup parent, const char* title, const Json& model) {
  const Json joints = list_of(model, "joints");
  std::vector<std::string> names;
  for (const Json& joint : joints)
    for (const auto& [key, value] : joint.items())
      if (is_number_of_arm(key) && std::find(names.begin(), names.end(), key) == names.end())
        names.push_back(key);
  std::vector<std::vector<std::string>> columns;
  for (const Json& joint : joints) {
    auto& column = columns.emplace_back();
    for (const auto& name : names) column.push_back(cell(part_of(joint, name)));
  }
  add_columns(parent, title, names, columns);
  for (const char* const name : {"base", "tool"}) {
    const Json& end = part_of(model, name);
    if (!end.is_object()) continue;
    std::string text = std::string(name) + ":";
    for (const auto& [key, value] : end.items())
      if (is_number_of_arm(key)) text += " " + key + " " + cell(value) + ";";
    text.back() = '.';
    parent.put("p", text, {{"class", "fine"}});
  }
}

/// A word of a command as a shell takes it.
std::string shell_word(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("/._-+=:,@").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string joined(const Json& words) {
  std::string text;
  for (const Json& word : words)
    text += (text.empty() ? "" : " ") +
            shell_word(word.is_string() ? word.get<std::string>() : word.dump());
  return text;
}

/// The command that makes the same result.json again, as far as run.json tells.
void add_command(Markup parent, const Json& run) {
  std::string how = "This command makes the same result.json again:";
  std::string command;
  if (const Json& words = list_of(run, "arguments"); !words.empty()) {
    command = "sweepd " + joined(words);
  } else if (text_of(run, "command") == "run") {
    how =
        "SETTINGS is the settings file of the daemon. In the folder of this session, if it was "
        "recorded, this command makes the same result.json again:";
    command = "sweepd replay trace*.pcap --config SETTINGS --output again";
  }
  if (command.empty()) return;
  parent.put("p", how);
  parent.add("pre").add("bdi").text(command);
}

void add_origin(Markup parent, const ReportFolder& folder) {
  parent.put("h3", "Where it comes from");
  const Json& run = folder.run;
  const Json& recovered = part_of(run, "recovered");
  const Json& made_of = recovered.is_object() ? recovered : run;
  if (run.is_object())
    parent.put("p", "sweepd " + text_of(made_of, "sweepd") + ", command " +
                        text_of(run, "command") +
                        ". Estimator: " + text_of(folder.result, "estimator") + ".");
  if (run.is_object()) add_command(parent, run);
  const Json inputs = run.is_object() ? list_of(made_of, "inputs") : Json::array();
  if (inputs.empty()) return;
  auto table = parent.add("table", {{"class", "inputs"}});
  table.put("caption", "Files that the run has read.");
  auto head = table.add("thead").add("tr");
  for (const char* const title : {"file", "bytes", "SHA-256"})
    head.put("th", title, {{"scope", "col"}});
  auto body = table.add("tbody");
  for (const Json& input : inputs) {
    auto row = body.add("tr");
    row.add("td").add("bdi").text(text_of(input, "file"));
    row.put("td", cell(part_of(input, "bytes")), {{"class", "number"}});
    row.put("td", text_of(input, "sha256"), {{"class", "hash"}});
  }
}

}  // namespace

void add_annex(Markup parent, const ReportFolder& folder) {
  add_origin(parent, folder);
  parent.put("h3", "The table in full");
  add_dh_csv(parent, folder.dh_csv);
  const Json& models = part_of(folder.result, "models");
  if (!models.is_object()) return;
  parent.put("h3", "The same arm in other forms");
  for (const Form& form : kForms)
    if (const Json& model = part_of(models, form.key); model.is_object())
      add_model(parent, form.title, model);
}

}  // namespace sweepd
