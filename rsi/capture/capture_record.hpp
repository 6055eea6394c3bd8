#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "rsi/datagram.hpp"

namespace rsi {

// The bytes of a capture file: pcap with nanoseconds, link type "raw IP", headers of IPv4 and UDP
// made up around the payload (https://www.tcpdump.org/manpages/pcap-savefile.5.txt). Numbers are in
// the byte order of the writing machine; the magic number tells the reader.

/// What a file begins with.
[[nodiscard]] std::string capture_header();

/// Appends the record of a datagram. The payload has at most max_udp_payload bytes. Times from 1970
/// to 2106.
void append_capture_record(const Datagram& datagram, std::string& out);

/// How many bytes append_capture_record() adds.
[[nodiscard]] std::size_t capture_record_size(const Datagram& datagram) noexcept;

/// Of the record that `bytes` begin with; 0 if they are too few to tell.
[[nodiscard]] std::size_t capture_record_size(std::string_view bytes) noexcept;

}  // namespace rsi
