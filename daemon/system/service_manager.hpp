#pragma once

#include <string>

namespace sweepd {

/// What systemd is told of the service that it started (sd_notify(3)). Nothing happens where the
/// program was started by someone else. Any thread; never throws.
namespace service_manager {

/// What can be served is; or the settings are taken over.
void ready() noexcept;
/// The settings are read again; ready() follows.
void reloading() noexcept;
/// The service ends, in order.
void stopping() noexcept;
/// A line for `systemctl status`.
void status(const std::string& text) noexcept;
/// The service is alive (WatchdogSec=): due every second or so.
void beat() noexcept;

}  // namespace service_manager

}  // namespace sweepd
