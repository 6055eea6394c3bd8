#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/settings/plant_settings.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/toml_table.hpp"

namespace sweepd {

/// Where an option's value goes. Its type says how it is written.
using Field = std::variant<
    std::string*, std::filesystem::path*, rsi::Endpoint*, TextPort*, ColumnList*, BrokerAddress*,
    Words*, std::optional<std::string>*, std::optional<std::filesystem::path>*,
    std::optional<std::uint32_t>*, std::optional<rsi::Endpoint>*, bool*, std::chrono::milliseconds*,
    std::chrono::seconds*, std::chrono::days*, std::size_t*, int*, std::vector<int>*, RealTime*,
    std::array<std::string, 3>*, std::vector<std::string>*, HostNames*, TagNames*>;

/// A key of the settings file.
struct Option {
  std::string_view key;
  Field field;
  std::string_view help;
  std::int64_t least = 0;  ///< of a whole number
  std::int64_t most = 0;
  TakesEffect takes_effect = TakesEffect::next_session;
  bool required = false;  ///< may not be left out
};
using Options = std::vector<Option>;

[[nodiscard]] Option required(Option option);
[[nodiscard]] Option at_once(Option option);
[[nodiscard]] Option after_restart(Option option);

/// Fills the fields of what `table` holds; there may also be `more_keys` in it, which are somebody
/// else's, and `elsewhere` are the keys of other tables. Relative paths start at `folder`. Throws a
/// ConfigError with all mistakes.
void read_options(const TomlTable& table, const Options& options,
                  std::initializer_list<std::string_view> more_keys,
                  const std::filesystem::path& folder,
                  const std::vector<KeyElsewhere>& elsewhere = {});

/// `prefix` stands before each key. The fields hold the defaults.
[[nodiscard]] std::vector<OptionText> option_texts(const Options& options,
                                                   const std::string& prefix = {});

/// The keys, after `prefix`, of which the two values differ. Both are of the same options.
[[nodiscard]] SettingsChange differing(const Options& from, const Options& to,
                                       const std::string& prefix = {});

/// Sets those that are live to what `from` has. Both are of the same options.
void take_over_live(const Options& to, const Options& from);

}  // namespace sweepd
