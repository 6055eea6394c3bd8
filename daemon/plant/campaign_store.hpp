#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/plant/database.hpp"
#include "daemon/plant/link_day.hpp"
#include "daemon/plant/topics.hpp"

namespace sweepd {

/// The campaigns of a plant's robots in PostgreSQL. What is stored twice is there once. All throw
/// DatabaseError. One thread.
class CampaignStore {
 public:
  /// Brings the tables to what this sweepd knows.
  explicit CampaignStore(Database& database);

  /// A result.json, byte for byte, with what was told beside it. False where it was there already.
  /// Throws std::invalid_argument where it is no result.
  bool add_result(const RobotPlace& place, std::string_view bytes,
                  const std::map<std::string, std::string>& names);
  /// What `compare --json` told of a result and the one before. Throws std::invalid_argument.
  void add_change(const RobotPlace& place, std::string_view bytes,
                  const std::map<std::string, std::string>& names);
  /// What came since the last state of each robot, all in one transaction.
  void add_links(const std::map<std::string, std::pair<RobotPlace, ToldLink>>& links);
  /// What is nothing of these, so that nothing is lost.
  void add_refused(const std::string& topic, std::string_view bytes, const std::string& why);

 private:
  std::string robot(const RobotPlace& place);  ///< its id

  Database& database_;
};

/// A campaign of a robot, as it was stored.
struct StoredCampaign {
  std::string session;  ///< when it started, as its folder was named
  std::string result;   ///< the bytes of its result.json
};
/// In the order of their sessions; of a session that was identified again only the newest result.
/// `session` empty: all of them. Throws DatabaseError.
[[nodiscard]] std::vector<StoredCampaign> stored_campaigns(Database& database,
                                                           const RobotPlace& place,
                                                           const std::string& session = {});

}  // namespace sweepd
