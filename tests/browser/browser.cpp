#include "tests/browser/browser.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnull-dereference"
#include <boost/beast/core/detail/base64.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#pragma GCC diagnostic pop

#include "tests/eventually.hpp"
#include "tests/scenarios/sweepd_process.hpp"

namespace sweepd::test {
namespace {

namespace http = boost::beast::http;
using boost::asio::ip::tcp;
using Json = Browser::Json;

}  // namespace

bool Browser::is_here() {
  return std::system("command -v chromedriver >/dev/null && command -v chromium >/dev/null") == 0;
}

Browser::Browser() : port_(free_tcp_port()) {
  std::string words[] = {"chromedriver", "--port=" + std::to_string(port_), "--log-level=SEVERE"};
  char* const arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 1, (folder_ / "driver").c_str(), kNew, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // Chromium is many processes
  const int failure =
      posix_spawnp(&driver_, arguments[0], &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::system_error(failure, std::generic_category(), "chromedriver");
  try {
    const bool ready = eventually([&] {
      try {
        return command("GET", "/status", nullptr)["ready"] == true;
      } catch (const std::exception&) {
        return false;
      }
    });
    if (!ready) throw std::runtime_error("chromedriver says: " + content(folder_ / "driver"));
    const Json options = {
        {"args",
         {"--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
          "--disable-background-networking", "--no-first-run", "--hide-scrollbars",
          "--user-data-dir=" + (folder_ / "profile").string()}}};
    const Json wanted = {{"browserName", "chrome"},
                         {"goog:chromeOptions", options},
                         {"goog:loggingPrefs", {{"browser", "ALL"}, {"performance", "ALL"}}}};
    session_ = command("POST", "/session", {{"capabilities", {{"alwaysMatch", wanted}}}})
                   .at("sessionId")
                   .get<std::string>();
  } catch (...) {
    kill(-driver_, SIGKILL);
    waitpid(driver_, nullptr, 0);
    throw;
  }
}

Browser::~Browser() {
  try {
    command("DELETE", "/session/" + session_, nullptr);
  } catch (const std::exception&) {
    // It is ended in any case.
  }
  kill(-driver_, SIGKILL);
  waitpid(driver_, nullptr, 0);
}

void Browser::open(const std::string& url) {
  in_session("/url", {{"url", url}});
}

Json Browser::run(const std::string& script) {
  return in_session("/execute/sync", {{"script", script}, {"args", Json::array()}});
}

Json Browser::run_later(const std::string& script) {
  return in_session("/execute/async", {{"script", script}, {"args", Json::array()}});
}

std::string Browser::text(const std::string& expression) {
  const Json value = run("return String(" + expression + ")");
  return value.get<std::string>();
}

bool Browser::becomes(const std::string& expression, int seconds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  while (run("return Boolean(" + expression + ")") != true) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

void Browser::size(int width, int height, bool phone) {
  devtools("Emulation.setDeviceMetricsOverride", {{"width", width},
                                                  {"height", height},
                                                  {"deviceScaleFactor", phone ? 2 : 1},
                                                  {"mobile", phone}});
}

void Browser::scheme(bool dark) {
  const Json wish = {{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}};
  devtools("Emulation.setEmulatedMedia", {{"features", {wish}}});
}

void Browser::key(const std::string& name) {
  for (const char* type : {"keyDown", "keyUp"})
    devtools("Input.dispatchKeyEvent", {{"type", type}, {"key", name}, {"code", name}});
}

void Browser::screenshot(const std::filesystem::path& file, bool whole) {
  const Json shot = devtools("Page.captureScreenshot",
                             {{"format", "png"},
                              {"captureBeyondViewport", whole},
                              {"clip", [&]() -> Json {
                                 const Json size =
                                     run("const page = document.documentElement;"
                                         "return [innerWidth, innerHeight, page.scrollHeight]");
                                 return {{"x", 0},
                                         {"y", 0},
                                         {"width", size[0]},
                                         {"height", whole ? size[2] : size[1]},
                                         {"scale", 1}};
                               }()}});
  namespace base64 = boost::beast::detail::base64;
  const auto encoded = shot.at("data").get<std::string>();
  std::string bytes(base64::decoded_size(encoded.size()), '\0');
  bytes.resize(base64::decode(bytes.data(), encoded.data(), encoded.size()).first);
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

std::vector<std::string> Browser::console() {
  std::vector<std::string> lines;
  for (const auto& line : in_session("/se/log", {{"type", "browser"}}))
    lines.push_back(line.at("message").get<std::string>());
  return lines;
}

std::vector<std::string> Browser::requested() {
  std::vector<std::string> addresses;
  for (const auto& line : in_session("/se/log", {{"type", "performance"}})) {
    const Json message = Json::parse(line.at("message").get<std::string>()).at("message");
    if (message.at("method") == "Network.requestWillBeSent")
      addresses.push_back(message.at("params").at("request").at("url").get<std::string>());
  }
  return addresses;
}

Json Browser::in_session(const std::string& path, const Json& body) {
  return command("POST", "/session/" + session_ + path, body);
}

Json Browser::devtools(const std::string& name, const Json& parameters) {
  return in_session("/goog/cdp/execute", {{"cmd", name}, {"params", parameters}});
}

Json Browser::command(const std::string& method, const std::string& path, const Json& body) {
  boost::asio::io_context context;
  tcp::socket socket(context);
  socket.connect({boost::asio::ip::address_v4::loopback(), port_});
  http::request<http::string_body> request(http::string_to_verb(method), path, 11);
  request.set(http::field::host, "localhost");
  request.set(http::field::connection, "close");
  if (!body.is_null()) {
    request.set(http::field::content_type, "application/json");
    request.body() = body.dump();
  }
  request.prepare_payload();
  http::write(socket, request);
  boost::beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(64 << 20);
  http::read(socket, buffer, parser);
  const Json answer = Json::parse(parser.get().body());
  const Json value = answer.value("value", Json());
  if (value.is_object() && value.contains("error"))
    throw std::runtime_error("chromedriver: " + path + ": " + value.dump().substr(0, 500));
  return value;
}

}  // namespace sweepd::test
