#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "identify/change/compared_arms.hpp"
#include "identify/change/displacement.hpp"

namespace sweepd {

/// From home, where no limits are known. Of a linear joint these are mm.
inline constexpr int kUsualTurn_deg = 90;

/// What a result.json tells of an arm, as far as another is compared with it.
struct ToldArm {
  std::filesystem::path file;
  std::string robot;
  std::string status;
  std::string reason;     ///< why the status is not complete
  std::string describes;  ///< controller_model or arm
  identify::MeasuredArm arm;
  /// The description's limits; kUsualTurn_deg from home where they are not known.
  identify::ToolReach reach;
  bool with_limits = false;  ///< all ranges are the description's
  /// The table's. Where the data leave axes open, `arm` and `reach` end with the last before these.
  std::size_t all_joints = 0;

  [[nodiscard]] std::size_t joints() const { return arm.dh.size(); }
  [[nodiscard]] bool whole() const { return joints() == all_joints; }
  /// Leaves the first so many, at most joints(). The tool is then the last axis's own frame.
  void cut(std::size_t joints);
};

/// "A is doubtful: the device was moved."; empty where it is complete.
[[nodiscard]] std::string told_status(const std::string& who, const std::string& status,
                                      const std::string& reason);

/// A result.json, or that of a folder; throws std::runtime_error where it is none of this sweepd.
[[nodiscard]] std::filesystem::path result_file(const std::filesystem::path& path);
[[nodiscard]] nlohmann::ordered_json read_result(const std::filesystem::path& file);
/// The same of a text that is there already; `file` is what errors name.
[[nodiscard]] nlohmann::ordered_json parse_result(const std::filesystem::path& file,
                                                  std::string_view text);

/// `path` is a folder that holds result.json, or such a file. Throws std::runtime_error with what
/// is wrong and what to do where it cannot be compared: not there, no result, of another version,
/// failed, without covariance, or with fewer than three axes before the first that is open.
[[nodiscard]] ToldArm read_told_arm(const std::filesystem::path& path);
/// The same from the bytes of such a file; `file` is what errors name.
[[nodiscard]] ToldArm told_arm(std::string_view bytes, const std::filesystem::path& file);
/// The same of a result that was read; `file` is what errors name.
[[nodiscard]] ToldArm told_arm_in(const nlohmann::ordered_json& result,
                                  const std::filesystem::path& file);

}  // namespace sweepd
