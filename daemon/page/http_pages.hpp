#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/service/service_status.hpp"
#include "daemon/settings/settings.hpp"

namespace sweepd {

/// What counts of an HTTP request.
struct HttpRequest {
  std::string_view method = "GET";
  std::string_view target;                ///< "/metrics", or "http://HOST/metrics"
  std::vector<std::string_view> hosts;    ///< every Host header: one is right
  std::vector<std::string_view> origins;  ///< every Origin header: browsers send one
  bool has_body = false;
  std::vector<std::string_view> accepts = {};  ///< every Accept header
};

struct HttpResponse {
  int status = 200;
  std::string_view type = "text/plain; charset=utf-8";
  std::string body;
  std::string_view cache = "no-store";
  /// Of an answer that goes on: what is to be sent now, perhaps nothing; no text at its end. Null:
  /// the body is all.
  std::function<std::optional<std::string>()> more = {};
};

/// The pages that tell how sweepd is; they change nothing. Any thread.
///
/// A browser in the plant shows pages from anywhere, and their scripts must not read these: a
/// request has to name this machine by a name that is known to be its own, and what comes from a
/// script of another page, by its Origin, is refused.
class HttpPages {
 public:
  using Clock = std::chrono::steady_clock;

  HttpPages(const Published<ServiceStatus>& status, const HttpSettings& settings,
            std::function<Clock::time_point()> now = Clock::now);

  /// Also to a HEAD as if it were a GET; who sends it leaves the body out.
  [[nodiscard]] HttpResponse answer(const HttpRequest& request) const;

 private:
  /// A host and perhaps a port.
  [[nodiscard]] bool is_ours(std::string_view authority) const;
  [[nodiscard]] HttpResponse page(std::string_view path, std::string_view query,
                                  bool wants_html) const;

  const Published<ServiceStatus>& status_;
  std::vector<std::string> hosts_;
  std::function<Clock::time_point()> now_;
};

}  // namespace sweepd
