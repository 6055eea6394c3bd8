#pragma once

#include <ostream>
#include <string>

namespace sweepd {

/// What an examination found, printed as it comes, a finding a line: `ok`, `warning` or `error`,
/// what it is about, and for the latter two what to do.
class Findings {
 public:
  explicit Findings(std::ostream& out) : out_(out) {}

  /// What follows is about this.
  void heading(const std::string& text) { out_ << text << '\n'; }
  void ok(const std::string& text) { line("ok", text); }
  void warning(const std::string& text) { line("warning", text); }
  /// A file is wrong.
  void error(const std::string& text) {
    line("error", text);
    wrong_file_ = true;
  }
  /// The files may be right, but this machine cannot do what they say.
  void not_ready(const std::string& text) {
    line("error", text);
    not_ready_ = true;
  }
  /// A fact by itself: "reply  <Sen ...>".
  void line(const std::string& label, const std::string& text) {
    out_ << "  " << label << std::string(label.size() < 9 ? 9 - label.size() : 1, ' ') << text
         << '\n';
  }

  [[nodiscard]] bool wrong_file() const { return wrong_file_; }
  [[nodiscard]] bool not_ready() const { return not_ready_; }

 private:
  std::ostream& out_;
  bool wrong_file_ = false;
  bool not_ready_ = false;
};

}  // namespace sweepd
