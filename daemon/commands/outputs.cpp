#include "daemon/commands/outputs.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <ostream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "daemon/results/result_files.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/system/line_file.hpp"
#include "daemon/text/file_names.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOfRecording = "it belongs to a recording";
constexpr const char* kAnotherFile = "name another file, or add --force";
constexpr const char* kAnotherFolder = "give --output a folder of its own, or add --force";

std::string beginning(const fs::path& file, std::size_t bytes) {
  std::string text(bytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return text;
}

/// The command that wrote the results of a folder, by its run.json; empty if that is not sweepd's.
std::string command_of(const fs::path& folder) {
  std::ifstream stream(folder / file_names::kRun, std::ios::binary);
  const auto run = nlohmann::json::parse(stream, nullptr, false);
  if (!run.is_object() || run.value("schema", nlohmann::json()) != schemas::kRun) return {};
  const auto command = run.find("command");
  return command != run.end() && command->is_string() ? command->get<std::string>() : "";
}

[[noreturn]] void refuse(const fs::path& file, const std::string& why, const std::string& remedy) {
  throw std::invalid_argument(file.string() + " is not overwritten: " + why + ": " + remedy);
}

[[noreturn]] void fail(const fs::path& path) {
  throw std::runtime_error(cannot_write(path, errno));
}

}  // namespace

Outputs::Outputs(std::vector<fs::path> inputs, bool force)
    : inputs_(std::move(inputs)), force_(force) {}

bool Outputs::in_the_way(const fs::path& file) const {
  std::error_code error;
  if (fs::status(file, error).type() != fs::file_type::regular) return false;
  for (const auto& input : inputs_)
    if (fs::equivalent(input, file, error))
      refuse(file, "this command reads it", "name another place for what is written");
  return !force_ && fs::file_size(file, error) > 0;
}

void Outputs::check_made_again(const fs::path& file, std::string_view ours) const {
  if (in_the_way(file) && beginning(file, ours.size()) != ours)
    refuse(file, "it is there already, and not of this command", kAnotherFile);
}

void Outputs::check(const fs::path& file, std::string_view ours) const {
  check_made_again(file, ours);
  if (in_the_way(file) && records_sessions(command_of(file.parent_path())))
    refuse(file, kOfRecording, kAnotherFile);
}

void Outputs::check_same(const fs::path& file, std::string_view content) const {
  if (in_the_way(file) && beginning(file, content.size() + 1) != content)
    refuse(file, "it is there already, and holds something else", kAnotherFile);
}

void Outputs::check_results(const fs::path& folder, const std::vector<std::string>& names) const {
  fs::path first;
  for (const auto& name : names)
    if (in_the_way(folder / name) && first.empty()) first = folder / name;
  if (first.empty()) return;
  const auto command = command_of(folder);
  if (records_sessions(command)) refuse(first, kOfRecording, kAnotherFolder);
  if (command.empty())
    refuse(first, "it is there already, and by run.json of that folder not sweepd's",
           kAnotherFolder);
}

void check_apart(const std::string& options, const fs::path& one, const fs::path& other) {
  if (fs::absolute(one).lexically_normal() == fs::absolute(other).lexically_normal())
    throw std::invalid_argument(options + " name one file, " + one.string() +
                                ": give each its own");
}

OutputFile::OutputFile(const fs::path& path) : path_(path), beside_(path) {
  std::error_code error;
  const auto type = fs::status(path, error).type();
  if (type != fs::file_type::regular && type != fs::file_type::not_found) return;
  // The file that a link leads to is meant, not the link.
  if (const auto real = fs::canonical(path, error); !error) path_ = real;
  beside_ = path_.parent_path() / ("." + path_.filename().string() + ".sweepd~");
  unlink(beside_.c_str());
  unfinished_.emplace(beside_);
  // Here, as an error is to name the file that was asked for.
  const int file = open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) fail(path);
  close(file);
}

OutputFile::~OutputFile() {
  if (beside_ != path_) unlink(beside_.c_str());
}

void OutputFile::commit() {
  if (beside_ == path_) return;
  const int file = open(beside_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  const int reason = errno;
  if (file >= 0) close(file);
  errno = reason;
  if (!synced || rename(beside_.c_str(), path_.c_str()) != 0) fail(path_);
}

void write_output(const fs::path& path, std::string_view content) {
  OutputFile output(path);
  {
    LineFile file(output.beside());
    if (content.ends_with('\n')) content.remove_suffix(1);
    file.append(content);
    file.flush();
    if (!file.error().empty()) throw std::runtime_error(file.error());
  }
  output.commit();
}

void write_edited(const Outputs& outputs, const std::optional<std::filesystem::path>& folder,
                  const std::vector<std::pair<std::filesystem::path, std::string>>& files,
                  std::ostream& out) {
  for (const auto& [file, content] : files) outputs.check_same(file, content);
  if (folder) make_folder(*folder);
  for (const auto& [file, content] : files) write_output(file, content);
  const char* before = "\nwritten     ";
  for (const auto& [file, content] : files) {
    out << before << file.string() << '\n';
    before = "            ";
  }
}

}  // namespace sweepd
