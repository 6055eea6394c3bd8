#include "identify/height_advice.hpp"

#include <string>

#include "identify/dh/base_height.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

/// At which height numbers from a row on are stated, and which ones are by convention for it.
std::string taken_at(const Identification& found, const std::vector<DhEstimate>& measured,
                     const Campaign& campaign, std::size_t first) {
  std::string names;
  bool by_b = false;
  for (std::size_t i = first; i < found.dh.size() && (i == first || found.joints[i].axis); ++i) {
    std::string of_row;
    for (const DhNumberName& of : kDhNumbers) {
      const bool is_b = of.number == &DhEstimate::b_mm;
      // That of a linear joint is by convention anyway; if it gives the height it went along.
      const bool went_along =
          is_b && found.dh[i].linear && found.dh[i].b_mm.value != measured[i].b_mm.value;
      if ((found.dh[i].*of.number).knowledge != Knowledge::by_convention ||
          ((measured[i].*of.number).knowledge != Knowledge::identified && !went_along) ||
          (i == 0 && (is_b || of.number == &DhEstimate::theta_rad)))
        continue;
      of_row += (of_row.empty() ? "" : ", ") + std::string(of.name);
      by_b = by_b || is_b;
    }
    if (!of_row.empty())
      names += (names.empty() ? "" : "; ") + of_row + " of row " + std::to_string(i + 1);
  }
  const std::string others = "Its a, and theta and a of the next row, are those at ";
  if (by_b)
    return "By convention it is where " + names + " is " +
           (campaign.specified ? "as specified" : "zero") + ". " + others + "that height";
  if (!names.empty())
    return "By convention it is level with the point stated of its axis. These numbers are not "
           "determined, and set as they are at that height: " +
           names;
  return others + "the height of the device's origin";
}

}  // namespace

std::vector<Warning> advice_on_height(const Identification& found,
                                      const std::vector<DhEstimate>& measured,
                                      const Campaign& campaign) {
  std::vector<Warning> advice;
  for (std::size_t i = 0; i + 1 < found.dh.size(); ++i) {
    const bool begins = i == 0 ? campaign.device_frame : !found.joints[i - 1].axis;
    if (!begins || found.dh[i].relation != Relation::parallel) continue;
    advice.push_back(
        {"height_unknown", i,
         joint_name(i) +
             ": its axis and the next are parallel, and nothing tells where along them the arm "
             "stands. " +
             taken_at(found, measured, campaign, i) + ". " + change_with_height(found.dh, i)});
  }
  return advice;
}

}  // namespace identify
