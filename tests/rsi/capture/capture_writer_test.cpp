#include "rsi/capture/capture_writer.hpp"

#include <array>
#include <csignal>
#include <cstdio>
#include <random>

#include <sys/resource.h>

#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/packet.hpp"
#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"
#include "tests/rsi/capture_bytes.hpp"

using namespace rsi::test;
using namespace std::chrono_literals;
using Catch::Matchers::ContainsSubstring;
using rsi::CaptureReader;
using rsi::CaptureWriter;
using rsi::Datagram;
using rsi::Endpoint;
using rsi::Timestamp;

namespace {

Datagram datagram(std::string_view payload, Timestamp time = kCaptured) {
  return {time, kController, kServer, payload, false};
}

/// Files grow no further than this while it lives, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 4096> part{};
  while (const auto size = std::fread(part.data(), 1, part.size(), pipe))
    output.append(part.data(), size);
  pclose(pipe);
  return output;
}

}  // namespace

TEST_CASE("what was written is read back exactly", "[capture_writer]") {
  std::mt19937 random(4669);
  struct Record {
    Timestamp time;
    Endpoint source, destination;
    std::string payload;
    bool cut;
  };
  std::vector<Record> records;
  for (const std::size_t size :
       {0u, 1u, 2u, 27u, 100u, 365u, 1472u, 1473u, 9000u, 65506u, 65507u}) {
    std::string payload;
    for (std::size_t i = 0; i < size; ++i) payload += static_cast<char>(random());
    const auto back = records.size() % 2 == 1;
    records.push_back({kCaptured + Timestamp(random() % 1'000'000'000),
                       back ? kServer : kController, back ? kController : kServer, payload,
                       size == 1472});
  }
  records.push_back({0ns, kController, kServer, "at the epoch", false});
  records.push_back({4'000'000'000s, kController, kServer, "after 2038", false});
  records.push_back({999'999'999ns, kController, kServer, "just before a second", false});

  const TemporaryFile file;
  {
    CaptureWriter writer(file.path());
    for (const auto& [time, source, destination, payload, cut] : records)
      CHECK(writer.write({time, source, destination, payload, cut}));
    CHECK(writer.flush());
    CHECK(writer.error().empty());
    CHECK(writer.dropped() == 0);
  }
  CaptureReader reader(file.path());
  for (const auto& record : records) {
    CAPTURE(record.payload.size());
    const auto read = reader.next();
    REQUIRE(read);
    CHECK(read->time == record.time);
    CHECK(read->source == record.source);
    CHECK(read->destination == record.destination);
    CHECK(read->payload == record.payload);
    CHECK(read->cut == record.cut);
  }
  CHECK_FALSE(reader.next());
  CHECK(reader.counters().packets == records.size());
}

TEST_CASE("a flushed capture is readable while it is still being written", "[capture_writer]") {
  const TemporaryFile file;
  CaptureWriter writer(file.path());
  const auto count = [&] {
    CaptureReader reader(file.path());
    int datagrams = 0;
    while (reader.next()) ++datagrams;
    CHECK(reader.notes().empty());
    return datagrams;
  };
  CHECK(count() == 0);
  CHECK(writer.write(datagram("one")));
  CHECK(writer.flush());
  CHECK(count() == 1);
  CHECK(writer.write(datagram("two")));
  CHECK(writer.flush());
  CHECK(count() == 2);
}

TEST_CASE("a writer replaces what was there and flushes when it ends", "[capture_writer]") {
  const TemporaryFile file(std::string(1000, 'x'));  // longer than what will be written
  { CaptureWriter(file.path()).write(datagram("the last")); }
  CaptureReader reader(file.path());
  const auto read = reader.next();
  REQUIRE(read);
  CHECK(read->payload == "the last");
  CHECK_FALSE(reader.next());
  CHECK(reader.notes().empty());
}

TEST_CASE("tcpdump finds nothing wrong with a written capture", "[capture_writer]") {
  if (output_of("tcpdump --version").find("libpcap") == std::string::npos) {
    WARN("tcpdump is not installed");
    return;
  }
  const TemporaryFile file;
  {
    CaptureWriter writer(file.path());
    for (const std::size_t size : {0u, 1u, 365u, 1500u, 65507u}) {
      const std::string payload(size, 'x');
      CHECK(writer.write(datagram(payload)));
    }
  }
  const auto output = output_of("tcpdump -nn -vvv -tt --nano -r " + file.path().string());
  CHECK_THAT(output,
             ContainsSubstring("link-type RAW") && ContainsSubstring("1700000000.123456789") &&
                 ContainsSubstring("192.168.1.20.49153 > 192.168.1.10.49152: [udp sum ok] UDP, "
                                   "length 365") &&
                 ContainsSubstring("length 65507"));
  CHECK_THAT(output, !ContainsSubstring("bad") && !ContainsSubstring("incorrect") &&
                         !ContainsSubstring("truncated"));
}

TEST_CASE("a capture that cannot be created is an exception with the reason", "[capture_writer]") {
  CHECK_THROWS_WITH(CaptureWriter("/nowhere/trace.pcap"),
                    ContainsSubstring("cannot create capture /nowhere/trace.pcap: No such file"));
  CHECK_THROWS_WITH(CaptureWriter("/dev/full"),
                    ContainsSubstring("cannot write capture /dev/full: No space left") &&
                        ContainsSubstring("make room"));
}

TEST_CASE("a payload that UDP cannot carry is refused, and the next is written",
          "[capture_writer]") {
  const TemporaryFile file;
  CaptureWriter writer(file.path());
  CHECK_FALSE(writer.write(datagram(std::string(rsi::max_udp_payload + 1, 'x'))));
  CHECK_THAT(writer.error(), ContainsSubstring("larger than UDP can carry"));
  CHECK(writer.dropped() == 1);
  CHECK(writer.write(datagram("small")));
  CHECK(writer.flush());
}

TEST_CASE("a full disk loses only what finds no room, and leaves no damage once there is room",
          "[capture_writer]") {
  const TemporaryFile file;
  CaptureWriter writer(file.path());
  const std::string payload(1000, 'x');
  std::vector<Timestamp> kept;
  std::uint64_t dropped = 0;
  const auto write_some = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const auto time = kCaptured + 4ms * (kept.size() + dropped);
      if (writer.write(datagram(payload, time)))
        kept.push_back(time);
      else
        ++dropped;
    }
  };
  {
    const FileSizeLimit limit(100'000);  // in the middle of a packet
    write_some(200);
    CHECK_FALSE(writer.flush());
    CHECK_THAT(writer.error(),
               ContainsSubstring(file.path().string()) && ContainsSubstring("File too large"));
    CHECK(writer.dropped() == 0);  // the buffer takes the rest for now
    write_some(1000);
    CHECK(dropped > 0);
    CHECK(writer.dropped() == dropped);
  }
  const auto first_error = writer.error();
  CHECK_FALSE(writer.write(datagram(std::string(rsi::max_udp_payload + 1, 'x'))));
  const auto dropped_before = dropped;
  write_some(100);
  CHECK(dropped == dropped_before);
  CHECK(writer.flush());
  CHECK(writer.error() == first_error);

  CaptureReader reader(file.path());
  std::vector<Timestamp> read;
  while (const auto next = reader.next()) {
    CHECK(next->payload == payload);
    read.push_back(next->time);
  }
  CHECK(read == kept);
  CHECK(reader.notes().empty());
}
