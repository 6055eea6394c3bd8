// What the reply thread does while it serves: it takes no memory, and asks nothing of the system
// but to receive and to send. Every way to allocate is replaced here by one that counts, and a
// seccomp filter on the thread reports every other system call: a lock that waits (futex), a log or
// a file (write, open), a sleep.

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#include "rsi/server/tcp_server.hpp"
#include "rsi/server/udp_server.hpp"
#include "tests/catch.hpp"

namespace {

thread_local bool watched = false;
std::atomic<int> allocations{0};
std::atomic<int> system_calls{0};
std::atomic<int> first_system_call{-1};

void note_allocation() {
  if (watched) ++allocations;
}

}  // namespace

// glibc lets a program put its own in place of these; its own stay within reach. operator new ends
// in malloc.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note_allocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  note_allocation();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note_allocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  note_allocation();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}

namespace {

void on_other_system_call(int, siginfo_t* info, void*) {
  if (!watched) return;
  int none = -1;
  first_system_call.compare_exchange_strong(none, info->si_syscall);
  ++system_calls;
}

/// Lets the calling thread do this, tell the time and end; all else ends in SIGSYS, and is not
/// done. False where the system does not permit filters.
bool only_these(std::vector<int> calls) {
  // The thread's first allocation makes its arena, by system calls.
  free(malloc(1));  // NOLINT(cppcoreguidelines-no-malloc)
  struct sigaction action {};
  action.sa_sigaction = on_other_system_call;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);

  std::array<sock_filter, 64> program{};
  unsigned short size = 0;
  program[size++] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  // How a thread ends, and comes back from the handler.
  calls.insert(calls.end(), {SYS_clock_gettime, SYS_rt_sigreturn, SYS_rt_sigprocmask, SYS_madvise,
                             SYS_munmap, SYS_exit, SYS_exit_group});
  for (const int call : calls) {
    program[size++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(call), 0, 1);
    program[size++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  program[size++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  const sock_fprog filter{size, program.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &filter) == 0;
}

const std::vector<int> kOverUdp{SYS_recvmmsg, SYS_sendto};
/// With a new connection, and the end of the old one.
const std::vector<int> kOverTcp{SYS_epoll_wait, SYS_epoll_ctl,  SYS_recvmsg, SYS_sendmsg,
                                SYS_accept,     SYS_setsockopt, SYS_ioctl,   SYS_close};

std::string telegram(std::uint64_t ipoc) {
  return "<Rob Type=\"KUKA\"><RIst X=\"1.0\"/><IPOC>" + std::to_string(ipoc) + "</IPOC></Rob>\n";
}

void forget() {
  allocations = 0;
  system_calls = 0;
  first_system_call = -1;
}

}  // namespace

TEST_CASE("the watch sees what it is there for", "[reply_path]") {
  forget();
  bool filtered = false;
  std::thread([&] {
    filtered = only_these(kOverUdp);
    watched = true;
    const volatile auto* kept = new std::string(100, 'x');
    if (filtered) static_cast<void>(getppid());
    watched = false;
    delete kept;
  }).join();
  CHECK(allocations > 0);
  if (filtered)
    CHECK(first_system_call == SYS_getppid);
  else
    std::cout << "skipped: system calls are not watched, this system permits no seccomp filter\n";
}

TEST_CASE("from reception to reply the UDP server neither allocates nor asks for anything else",
          "[reply_path]") {
  rsi::UdpServer::Options options;
  options.listen = {0x7f000001, 0};
  options.reply.emplace("ImFree");
  options.queue_bytes = 64 << 10;  // overflows, too, are part of the path
  rsi::UdpServer server(std::move(options));
  forget();
  std::thread thread([&] {
    server.warm();
    only_these(kOverUdp);
    watched = true;
    server.run();
    watched = false;
  });

  boost::asio::io_context context;
  using boost::asio::ip::udp;
  udp::socket socket(context, {boost::asio::ip::address_v4::loopback(), 0});
  socket.connect({boost::asio::ip::address_v4::loopback(), server.local().port});
  udp::socket stranger(context, {boost::asio::ip::make_address_v4("127.0.0.2"), 0});
  stranger.connect({boost::asio::ip::address_v4::loopback(), server.local().port});
  const timeval ten_seconds{10, 0};
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &ten_seconds, sizeof ten_seconds);
  std::array<char, 2000> reply{};
  int answered = 0;
  for (std::uint64_t ipoc = 4; ipoc <= 4000; ipoc += 4) {
    if (ipoc % 100 == 0) {
      stranger.send(boost::asio::buffer(telegram(ipoc)));
      socket.send(boost::asio::buffer(std::string("junk")));
      socket.send(boost::asio::buffer(std::string(60'000, 'x')));
    }
    socket.send(boost::asio::buffer(telegram(ipoc)));
    answered += recv(socket.native_handle(), reply.data(), reply.size(), 0) > 0;
  }
  const auto beats = server.beats();
  while (server.beats() < beats + 3) std::this_thread::yield();  // silence is part of it
  server.stop();
  thread.join();
  CHECK(answered == 1000);
  CHECK(server.counts().answered == 1000);
  CHECK(server.counts().unanswerable == 80);
  CHECK(server.counts().foreign == 40);
  CHECK(server.counts().overflows > 0);
  CHECK(allocations == 0);
  INFO("first system call: " << first_system_call);
  CHECK(system_calls == 0);
}

TEST_CASE("from reception to reply the TCP server neither allocates nor asks for anything else",
          "[reply_path]") {
  rsi::TcpServer::Options options;
  options.listen = {0x7f000001, 0};
  options.controller = 0x7f000001;
  options.reply.emplace("ImFree");
  options.queue_bytes = 64 << 10;
  rsi::TcpServer server(std::move(options));
  forget();
  std::thread thread([&] {
    server.warm();
    only_these(kOverTcp);
    watched = true;
    server.run();
    watched = false;
  });

  boost::asio::io_context context;
  using boost::asio::ip::tcp;
  const tcp::endpoint address(boost::asio::ip::address_v4::loopback(), server.local().port);
  const timeval ten_seconds{10, 0};
  const std::size_t reply_size =
      std::string("<Sen Type=\"ImFree\"><IPOC>10000</IPOC></Sen>").size();
  std::array<char, 2000> reply{};
  int answered = 0;
  for (int connection = 0; connection < 10; ++connection) {
    tcp::socket stranger(context, tcp::v4());
    stranger.bind({boost::asio::ip::make_address_v4("127.0.0.2"), 0});
    stranger.connect(address);
    tcp::socket socket(context);  // takes the place of the one before
    socket.connect(address);
    socket.set_option(tcp::no_delay(true));
    setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &ten_seconds, sizeof ten_seconds);
    for (std::uint64_t ipoc = 10'000; ipoc < 10'400; ipoc += 4) {
      const auto text = telegram(ipoc);
      const bool with_length = ipoc % 40 == 0;
      const std::string length = with_length ? std::to_string(text.size()) : "";
      if (ipoc % 100 == 0) socket.send(boost::asio::buffer(std::string(3000, 'x')));
      socket.send(boost::asio::buffer(length + text));
      const auto size = reply_size + (with_length ? 2 : 0);
      answered += recv(socket.native_handle(), reply.data(), size, MSG_WAITALL) ==
                  static_cast<ssize_t>(size);
    }
  }
  const auto beats = server.beats();
  while (server.beats() < beats + 3) std::this_thread::yield();  // silence is part of it
  // A stop takes a lock of Asio's, for which the thread may wait then, and only then.
  const int asked = system_calls;
  server.stop();
  thread.join();
  CHECK(answered == 1000);
  CHECK(server.counts().answered == 1000);
  CHECK(server.counts().foreign == 10);
  CHECK(server.counts().overflows > 0);
  CHECK(allocations == 0);
  INFO("first system call: " << first_system_call);
  CHECK(asked == 0);
}
