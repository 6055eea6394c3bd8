// Runs a fuzz target without libFuzzer: the corpus, then so many mutations of it, the same ones
// each time. What breaks the target is kept as fuzz-finding-PROGRAM in the working directory.
//
//   fuzz_telegram CORPUS RUNS [DICTIONARY]
#include <algorithm>
#include <charconv>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/property.hpp"

/// Of the sanitizers; absent without one.
extern "C" void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongest = 4096;

std::string input;    // what runs now
std::string finding;  // where it goes if it breaks the target

void keep_input() {
  std::ofstream(finding, std::ios::binary) << input;
  std::fprintf(stderr, "fuzz: the input is kept in %s\n", finding.c_str());
}

void run() {
  // A copy of just this size: a sanitizer sees what reads beyond it.
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> read_corpus(const fs::path& folder) {
  std::vector<fs::path> files(fs::directory_iterator(folder), {});
  std::sort(files.begin(), files.end());
  std::vector<std::string> corpus;
  for (const auto& file : files) corpus.push_back(read(file));
  return corpus;
}

/// The tokens of a dictionary as libFuzzer takes it: one in quotes a line, with \xAB, \\ and \".
std::vector<std::string> read_tokens(const fs::path& path) {
  std::vector<std::string> tokens;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with('"')) continue;
    std::string token;
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      if (line[i] != '\\') {
        token += line[i];
      } else if (line[++i] == 'x') {
        unsigned code = 0;
        std::from_chars(line.data() + i + 1, line.data() + i + 3, code, 16);
        token += static_cast<char>(code);
        i += 2;
      } else {
        token += line[i];
      }
    }
    tokens.push_back(token);
  }
  return tokens;
}

class Mutator {
 public:
  Mutator(const std::vector<std::string>& corpus, const std::vector<std::string>& tokens)
      : corpus_(corpus), tokens_(tokens) {}

  std::string mutation() {
    std::string text = any(corpus_);
    for (auto edits = 1 + below(6); edits > 0; --edits) edit(text);
    text.resize(std::min(text.size(), kLongest));
    return text;
  }

 private:
  std::size_t below(std::size_t limit) { return limit == 0 ? 0 : random_() % limit; }
  const std::string& any(const std::vector<std::string>& texts) {
    return texts[below(texts.size())];
  }

  void edit(std::string& text) {
    const auto at = below(text.size() + 1);
    const auto length = 1 + below(below(4) == 0 ? text.size() : 8);
    switch (below(7)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, 1, static_cast<char>(below(256)));
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), length));
        break;
      case 4: {
        const auto& other = any(corpus_);
        text.replace(at, length, other.substr(below(other.size()), 1 + below(64)));
        break;
      }
      case 5:
        if (!tokens_.empty()) text.insert(at, any(tokens_));
        break;
      default:
        if (!tokens_.empty()) text.replace(at, length, any(tokens_));
    }
  }

  const std::vector<std::string>& corpus_;
  const std::vector<std::string>& tokens_;
  std::mt19937_64 random_{4};
};

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) {
    std::fprintf(stderr, "usage: %s CORPUS RUNS [DICTIONARY]\n", arguments[0]);
    return 2;
  }
  finding = "fuzz-finding-" + fs::path(arguments[0]).filename().string();
  if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(keep_input);
  std::signal(SIGABRT, [](int) {
    keep_input();
    std::_Exit(1);
  });

  const auto corpus = read_corpus(arguments[1]);
  const auto tokens = count > 3 ? read_tokens(arguments[3]) : std::vector<std::string>();
  const auto runs = std::strtoul(arguments[2], nullptr, 10);
  if (corpus.empty() || (count > 3 && tokens.empty())) {
    std::fprintf(stderr, "fuzz: nothing in %s or its dictionary\n", arguments[1]);
    return 2;
  }
  for (const auto& seed : corpus) {
    input = seed;
    run();
  }
  Mutator mutator(corpus, tokens);
  for (std::size_t i = 0; i < runs; ++i) {
    input = mutator.mutation();
    run();
  }
  std::printf("fuzz: %zu seeds and %zu mutations of them\n", corpus.size(),
              static_cast<std::size_t>(runs));
  return 0;
}
