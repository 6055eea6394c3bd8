#include "daemon/check_command.hpp"

#include <set>
#include <string>

#include "daemon/config_error.hpp"
#include "daemon/robot_setup.hpp"
#include "daemon/settings.hpp"
#include "rsi/ethernet_config.hpp"
#include "rsi/reply.hpp"

namespace sweepd {
namespace {

constexpr int kConfigError = 78;  // EX_CONFIG of sysexits.h

class Check {
 public:
  explicit Check(std::ostream& out) : out_(out) {}

  [[nodiscard]] int exit_code() const { return wrong_ ? kConfigError : 0; }

  void settings(const std::filesystem::path& file) {
    try {
      const Settings settings = load_settings(file);
      ok(file, std::to_string(settings.robots.size()) +
                   (settings.robots.size() == 1 ? " robot" : " robots"));
      for (const auto& robot : settings.robots) check(robot);
    } catch (const ConfigError& problem) {
      error(problem.what());
    }
  }

  std::optional<rsi::EthernetConfig> ethernet(const std::filesystem::path& file) {
    try {
      auto config = rsi::EthernetConfig::load(file);
      ok(file, "sends " + count(config.send.size(), "tag") + ", receives " +
                   count(config.receive.size(), "tag") + ", port " + std::to_string(config.port) +
                   ", " + (config.protocol == rsi::EthernetConfig::Protocol::TCP ? "TCP" : "UDP"));
      for (const auto& text : config.warnings) warning(text);
      if (config.only_send)
        out_ << "  reply    none: ONLYSEND is TRUE\n";
      else
        out_ << "  reply    " << rsi::Reply(config).with_ipoc("123456") << '\n';
      return config;
    } catch (const rsi::EthernetConfigError& problem) {
      error(problem.what());
      return std::nullopt;
    }
  }

 private:
  void check(const RobotSettings& robot) {
    out_ << "robot " << robot.name << '\n';
    try {
      const RobotSetup setup = load_setup(robot);
      ok(robot.description,
         count(setup.joints, "joint") + (setup.description->arm ? "" : ", no specified DH table"));
      if (robot.plan)
        ok(*robot.plan, count(setup.plan->sweeps.size(), "sweep") + ", fits the robot");
    } catch (const ConfigError& problem) {
      error(problem.what());
    }
    if (!robot.ethernet_config) {
      warning(robot.name +
              ": ethernet_config: not set: replies carry Type ImFree and the IPOC "
              "alone; name the file that lies on the controller");
      return;
    }
    if (const auto config = ethernet(*robot.ethernet_config)) compare(robot, *config);
  }

  void compare(const RobotSettings& robot, const rsi::EthernetConfig& config) {
    if (config.port != robot.listen.port)
      error(config.name + ": PORT: expected " + std::to_string(robot.listen.port) +
            " as in `listen` of robot " + robot.name + ", found " + std::to_string(config.port) +
            ": make them equal");
    const auto address = rsi::parse_address(config.ip_number);
    if (address && robot.listen.address != 0 && *address != robot.listen.address)
      error(config.name + ": IP_NUMBER: expected " + rsi::address_text(robot.listen.address) +
            " as in `listen` of robot " + robot.name + ", found " + config.ip_number +
            ": make them equal");
    std::set<std::string> sent;
    for (const auto& element : rsi::wire_layout(config.send))
      for (const auto& field : element.fields)
        sent.insert(field.attribute.empty() ? element.name : element.name + "." + field.attribute);
    const auto want = [&](const std::string& signal, const std::string& consequence) {
      if (sent.contains(signal)) return true;
      warning(config.name + ": SEND: " + signal + " of `signals` is not sent: " + consequence);
      return false;
    };
    for (const auto& signal : robot.signals.position)
      if (!want(signal,
                "without positions nothing can be identified; add DEF_RIst, or name the "
                "signal that holds it"))
        break;
    for (const auto& signal : robot.signals.angles)
      if (!want(signal,
                "without angles the joints are known from the plan's order alone; add "
                "DEF_AIPos, or set `plan`"))
        break;
  }

  static std::string count(std::size_t number, const std::string& noun) {
    return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
  }

  void ok(const std::filesystem::path& file, const std::string& text) {
    out_ << "  ok       " << file.string() << ": " << text << '\n';
  }
  void warning(const std::string& text) { out_ << "  warning  " << text << '\n'; }
  void error(const std::string& text) {
    out_ << "  error    " << text << '\n';
    wrong_ = true;
  }

  std::ostream& out_;
  bool wrong_ = false;
};

}  // namespace

int check(const CheckOptions& options, std::ostream& out) {
  Check check(out);
  if (options.config) check.settings(*options.config);
  for (const auto& file : options.ethernet_configs) check.ethernet(file);
  return check.exit_code();
}

}  // namespace sweepd
