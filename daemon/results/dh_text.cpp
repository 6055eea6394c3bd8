
#include "daemon/results/outcome.hpp"
#include "daemon/results/report.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "identify/geometry/warning.hpp"

namespace sweepd {
namespace {

using identify::DhEstimate;
using identify::DhNumber;
using identify::Estimator;
using identify::Identification;
using identify::Knowledge;

constexpr int kMmDecimals = 5;
constexpr int kDegDecimals = 6;
constexpr std::size_t kName = 18;
constexpr std::size_t kValue = 13;
constexpr std::size_t kSigma = 10;

std::string title(Estimator estimator) {
  switch (estimator) {
    case Estimator::chain:
      return "DH parameters by the chain estimator (all sweeps in one fit)";
    case Estimator::circle:
      return "DH parameters by the paper's circles (estimator circle)";
    case Estimator::poses:
      return "DH parameters by the static poses, and sweeps where there are any (one fit)";
    case Estimator::axes:
      return "DH parameters of the given axes";
  }
  return "";
}

std::optional<double> value(const DhNumber& number, double scale) {
  if (number.knowledge == Knowledge::undetermined) return std::nullopt;
  return scale * number.value;
}

class Table {
 public:
  explicit Table(const Identification& found)
      : found_(found),
        differences_(compare_with_specified(found.dh, found.specified, found.home_rad)),
        with_circle_(found.estimator == Estimator::chain &&
                     found.circle_dh.size() == found.dh.size()) {}

  std::string text() {
    text_ = title(found_.estimator) + "\n\n" + left("joint", kName) + right("identified", kValue) +
            right("std unc", kSigma);
    if (with_circle_) text_ += right("circle", kValue);
    if (compared()) text_ += right("specified", kValue) + right("difference", kValue);
    text_ += "\n";
    for (std::size_t i = 0; i < found_.dh.size(); ++i) row(i);
    if (conventions_) text_ += "\n(set): not determined by the data, but set by convention.\n";
    if (homeless_)
      text_ += "\n" + paragraph("theta  ",
                                "-: not compared, since the controller's angles at home are not "
                                "known: give --plan, or angles.");
    formula();
    return std::move(text_);
  }

 private:
  void formula() {
    bool beta = false;
    for (const DhEstimate& row : found_.dh) beta = beta || has_beta(row);
    std::string way = "leads from frame i to i+1: Tz(b) Rz(theta) Tx(a) Rx(alpha)";
    if (beta) way += ", and Ry(beta) where axes are parallel";
    std::vector<std::size_t> linear;
    for (std::size_t i = 0; i < found_.dh.size(); ++i)
      if (found_.dh[i].linear) linear.push_back(i);
    if (linear.empty()) {
      text_ += "\n" + paragraph("Row i       ", way + ". theta is the angle at home.");
      return;
    }
    text_ += "\n" + paragraph("Row i       ",
                              way +
                                  ". theta is the angle at home, b of a linear joint its place at "
                                  "home.");
    text_ += paragraph(
        "Linear      ",
        identify::joints_named(linear) +
            ": b changes, theta stays. Such an axis has a direction and no place: by convention a "
            "of its row and b of the next are " +
            (compared() ? "as specified" : "zero") +
            ", or it lies on a next axis parallel to it. Where nothing of the arm tells, it passes "
            "by where the target is at home.");
  }

  struct Line {
    const char* name = "";
    DhNumber DhEstimate::*number = nullptr;
    double scale = 1;
    int decimals = 0;
    double specified = 0;
    std::optional<double> difference;
  };

  [[nodiscard]] bool compared() const { return !differences_.empty(); }

  void row(std::size_t i) {
    const DhEstimate& row = found_.dh[i];
    const identify::DhRow expected = compared() ? found_.specified[i] : identify::DhRow{};
    const identify::DhDifference off = compared() ? differences_[i] : identify::DhDifference{};
    const double degree = degrees(1);
    line(i, {"b      mm", &DhEstimate::b_mm, 1, kMmDecimals, expected.b_mm, off.b_mm});
    line(i, {"theta  deg", &DhEstimate::theta_rad, degree, kDegDecimals, expected.theta_rad,
             off.theta_rad});
    line(i, {"a      mm", &DhEstimate::a_mm, 1, kMmDecimals, expected.a_mm, off.a_mm});
    line(i, {"alpha  deg", &DhEstimate::alpha_rad, degree, kDegDecimals, expected.alpha_rad,
             off.alpha_rad});
    if (has_beta(row))
      line(i, {"beta   deg", &DhEstimate::beta_rad, degree, kDegDecimals, expected.beta_rad,
               off.beta_rad});
    if (i + 1 < found_.dh.size())
      text_ += "        to the next axis: " + std::string(identify::text(row.relation)) + "\n";
  }

  void line(std::size_t i, const Line& line) {
    const DhNumber& number_found = found_.dh[i].*line.number;
    const bool first = line.number == &DhEstimate::b_mm;
    text_ += right(first ? std::to_string(i + 1) : "", 5) + "   " + left(line.name, kName - 8) +
             number(value(number_found, line.scale), line.decimals, kValue);
    std::optional<double> sigma;
    if (number_found.has_sigma()) sigma = line.scale * number_found.sigma;
    if (number_found.knowledge == Knowledge::by_convention) {
      text_ += right("(set)", kSigma);
      conventions_ = true;
    } else {
      text_ += number(sigma, line.decimals, kSigma);
    }
    if (with_circle_) text_ += number(circle(i, line, number_found), line.decimals, kValue);
    if (compared()) {
      std::optional<double> difference;
      if (line.difference) difference = line.scale * *line.difference;
      homeless_ = homeless_ || (line.number == &DhEstimate::theta_rad && !found_.home_rad[i] &&
                                number_found.knowledge == Knowledge::identified);
      text_ += number(line.scale * line.specified, line.decimals, kValue) +
               number(difference, line.decimals, kValue);
    }
    text_ += "\n";
  }

  /// The circles' value; an angle within half a turn of the identified one.
  [[nodiscard]] std::optional<double> circle(std::size_t i, const Line& line,
                                             const DhNumber& found) const {
    DhNumber number = found_.circle_dh[i].*line.number;
    const double identified = found.value;
    if (line.scale != 1) number.value = identified + identify::wrapped(number.value - identified);
    return value(number, line.scale);
  }

  const Identification& found_;
  std::vector<identify::DhDifference> differences_;
  bool with_circle_;
  bool conventions_ = false;
  bool homeless_ = false;
  std::string text_;
};

}  // namespace

std::string dh_text(const Identification& found) {
  return Table(found).text();
}

}  // namespace sweepd
