#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/history/campaign_note.hpp"
#include "daemon/results/told_arm.hpp"

namespace sweepd {

/// What motors took of one joint, as result.json has it.
struct JointFriction {
  std::size_t joint = 0;  ///< counted from 0
  double friction_a = 0;
  double scatter_a = 0;  ///< from place to place
  double speed_deg_s = 0;
};

/// How a campaign's link did. Not a number where nobody knows.
struct LinkQuality {
  std::string verdict;  ///< good, marginal, bad
  double received = 0;
  double lost = 0;
  double late_replies = 0;
  double latency_p99_9_us = 0;
  double jitter_p99_9_us = 0;
};

/// A campaign as its files tell it, wherever these are kept. Empty: there is no such file.
struct CampaignTexts {
  std::string name;      ///< of its folder, or an identity elsewhere
  std::string result;    ///< result.json
  std::string problem;   ///< why result.json, which is there, cannot be read; empty: it can
  std::string run;       ///< run.json
  std::string link;      ///< link.json
  std::string currents;  ///< currents.csv, for results that do not tell friction themselves
  std::string notes;     ///< notes.jsonl
  std::chrono::nanoseconds written{};  ///< when the result was, since the Unix epoch
};

/// All of a campaign that a history tells.
struct CampaignRecord {
  std::string name;
  std::chrono::nanoseconds time{};  ///< since the Unix epoch
  /// Which one tells the time: a note, run.json, link.json, the folder's name or, worst, the age of
  /// its files.
  std::string time_from;
  std::optional<ToldArm> arm;
  std::string why_not;  ///< there is no arm
  std::vector<JointFriction> friction;
  std::optional<LinkQuality> link;
  std::vector<CampaignNote> notes;
  std::vector<std::size_t> broken_notes;  ///< lines

  /// The state that it is marked as being of; empty: none.
  [[nodiscard]] std::string same_state() const;
};

/// Never throws for what is wrong with a text: that is told in the record.
[[nodiscard]] CampaignRecord campaign_record(const CampaignTexts& texts);

/// A record in a short form and back, for an index. Throws std::exception of what is none.
[[nodiscard]] std::vector<std::uint8_t> packed(const CampaignRecord& record);
[[nodiscard]] CampaignRecord unpacked(const std::uint8_t* bytes, std::size_t size);

}  // namespace sweepd
