#include "daemon/service/robot_service.hpp"

#include <exception>
#include <fstream>
#include <sstream>
#include <utility>

#include <spdlog/fmt/ranges.h>

#include "daemon/results/report.hpp"
#include "daemon/service/robot_server.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

/// Acquisition looks for new telegrams so often. Waking it for each would cost the reply thread a
/// system call, and the machine a change of threads.
constexpr auto kTick = 100ms;

/// Other robots wait for their turn meanwhile: some 10 ms.
constexpr std::size_t kMostInATurn = 2000;

/// And so often it tells how the robot is.
constexpr auto kPublished = 1s;

/// At the end an identification takes seconds, on a machine that is busy with other things minutes.
/// More, after the recording was written, is a disk that has stopped answering.
constexpr auto kLongestResult = 10min;

/// So many datagrams of others than the session's controller wait for the answer to whose stream it
/// is: a server needs a few telegrams to tell.
constexpr std::size_t kMostWaitingDatagrams = 64;

Say say_for(const std::string& name) {
  return [log = Log(name)](Importance importance, const std::string& text) {
    log.say(importance, text);
  };
}

std::vector<std::filesystem::path> inputs_of(const RobotSettings& settings) {
  std::vector<std::filesystem::path> inputs{settings.description};
  for (const auto& file : {settings.plan, settings.ethernet_config})
    if (file) inputs.push_back(*file);
  return inputs;
}

/// Empty if there is no file.
std::string content(const std::optional<std::filesystem::path>& file) {
  std::ostringstream text;
  if (file) text << std::ifstream(*file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

RobotService::RobotService(const RobotSettings& settings, std::shared_ptr<RobotThreads> threads)
    : settings_(settings),
      setup_(load_setup(settings)),
      server_(make_server(settings)),
      local_(server_->local()),
      log_(settings.name),
      status_(std::make_shared<RobotStatus>()),
      threads_(std::move(threads)),
      recorder_(threads_->recorders, file_system_of(settings.output / settings.name),
                settings.recording, say_for(settings.name)),
      identifier_(status_),
      given_(settings),
      ethernet_xml_(content(settings.ethernet_config)),
      inputs_(hashes_of(inputs_of(settings))),
      session_log_(settings.name),
      tally_(first_state()),
      live_(status_->live) {
  status_->facts.publish(facts());
  status_->state.publish(first_state());
  std::error_code error;
  std::filesystem::create_directories(settings_.output / settings_.name, error);
  if (error)
    throw std::runtime_error("cannot make the folder " +
                             (settings_.output / settings_.name).string() + " (" + error.message() +
                             "): give one that may be written with `output` or --output");
}

RobotService::~RobotService() {
  stop();
}

void RobotService::start() {
  std::promise<RealTimeReport> ready;
  auto report = ready.get_future();
  reply_thread_ =
      std::thread([this, ready = std::move(ready)]() mutable { serve(std::move(ready)); });
  say_real_time(report.get());
  acquisition_ = threads_->acquisition.begin(0, [this] { return TurnThreads::Next{turn()}; });
  identifier_.finish_earlier(settings_.output / settings_.name, setup_, log_);
  log_.note("listening on {} {}, receive buffer {} KiB", rsi::text(server_->transport()),
            rsi::text(local()), server_->receive_buffer() / 1024);
}

void RobotService::reload(const RobotSettings& settings) {
  const auto changed = change(given_, settings);
  RobotSetup setup = load_setup(settings);
  given_ = settings;
  if (!changed.after_restart.empty())
    log_.warning("only a restart of sweepd takes over {}", fmt::join(changed.after_restart, ", "));
  if (content(settings.ethernet_config) != ethernet_xml_)
    log_.warning("the Ethernet file has changed: restart sweepd before RSI uses it");
  log_.note("{}", changed.live.empty()
                      ? std::string("description and plan read again, for the next session")
                      : fmt::format("taken over for the next session: {}",
                                    fmt::join(changed.live, ", ")));
  recorder_.reconfigure(settings.recording);
  auto inputs = hashes_of(inputs_of(settings));
  const auto disk = file_system_of(settings.output / settings.name);
  const std::lock_guard lock(reload_mutex_);
  reloaded_ = {settings, std::move(setup), std::move(inputs), disk};
}

void RobotService::take_over() {
  const std::lock_guard lock(reload_mutex_);
  if (!reloaded_) return;
  auto& [settings, setup, inputs, disk] = *reloaded_;
  disk_ = disk;
  take_over_live(settings_, std::move(settings));
  setup_ = std::move(setup);
  inputs_ = std::move(inputs);
  facts_told_ = false;
  reloaded_.reset();
}

bool RobotService::stop(std::chrono::seconds patience) {
  if (!reply_thread_.joinable()) return true;
  acquisition_.reset();
  server_->settle();
  while (!drain()) {
  }
  end_session();
  publish();
  // The result waits for the recording.
  const bool recorded = recorder_.stop(Steady::now() + patience);
  const bool written = identifier_.drain(Steady::now() + (recorded ? kLongestResult : patience));
  if (!written)
    log_.error("the last result is not written: see what is wrong with the disk of {}",
               settings_.output.string());
  server_->stop();
  reply_thread_.join();
  server_.reset();
  return recorded && written;
}

void RobotService::serve(std::promise<RealTimeReport> ready) {
  name_thread("reply");
  RealTimeReport report;
  if (settings_.real_time.wish != RealTime::off) {
    lock_memory(report);
    enter_real_time(settings_.real_time, report);
  }
  server_->warm();
  ready.set_value(std::move(report));
  server_->run();
}

void RobotService::say_real_time(const RealTimeReport& report) {
  if (!report.granted.empty()) log_.note("reply thread: {}", fmt::join(report.granted, ", "));
  if (settings_.real_time.wish == RealTime::require && !report.refused.empty()) {
    server_->stop();
    reply_thread_.join();
    throw std::runtime_error(settings_.name + ": " + report.refused.front() +
                             "; or set realtime to \"try\"");
  }
  for (const auto& refused : report.refused) log_.warning("{}", refused);
}

RobotService::Steady::time_point RobotService::turn() {
  ++acquisition_beats_;
  if (!session_) take_over();
  const bool all = drain();
  if (link_wanted_.exchange(false)) say_link();
  const auto now = Steady::now();
  if (session_ && now - last_datagram_ > settings_.silence) {
    session_log_.note("RSI has been silent for {} ms: the stream has ended",
                      settings_.silence.count());
    end_session();
    server_->forget_controller();
    take_waiting();
  }
  if (all) show();
  if (now - published_ >= kPublished) publish();
  identifier_.try_again(now);
  return all ? now + kTick : now;
}

bool RobotService::drain() {
  rsi::Datagram datagram;
  rsi::Handling handling;
  std::size_t taken = 0;
  while (taken < kMostInATurn && server_->datagrams().pop(datagram, &handling)) {
    take(datagram, handling);
    ++acquisition_beats_;
    ++taken;
  }
  const auto counts = server_->counts();
  if (session_) watch_.withheld = counts.not_begun - not_begun_;
  for (const auto& complaint : complaints_.about(counts, Steady::now()))
    session_log_.error("{}", complaint);
  return taken < kMostInATurn;
}

void RobotService::take(const rsi::Datagram& datagram, rsi::Handling handling) {
  const bool sent = handling.sent;
  const auto peer = (sent ? datagram.destination : datagram.source).address;
  if (session_ && peer != controller_) return take_from_other(datagram, handling, peer);
  if (!session_) {
    // A stream begins with what can be answered; stray datagrams are no session.
    if (sent || rsi::find_ipoc(datagram.payload).empty()) return;
    begin_session(datagram);
  }
  const bool left = !sent || !datagram.payload.empty();
  if (left) recorder_.datagram(datagram);
  if (sent) return session_->reply(datagram);
  // Noise on the port does not keep a stream alive.
  if (const auto ipoc = rsi::find_ipoc(datagram.payload); !ipoc.empty()) {
    last_datagram_ = Steady::now();
    session_log_.about(started_, ipoc);
  }
  live_.telegram();
  session_->telegram(datagram);
}

void RobotService::take_from_other(const rsi::Datagram& datagram, rsi::Handling handling,
                                   std::uint32_t peer) {
  if (waiting_.size() == kMostWaitingDatagrams) waiting_.pop_front();
  waiting_.push_back({datagram, std::string(datagram.payload), handling, peer});
  if (!handling.streams) return;
  session_log_.note("{} streams: it is the controller, and what came before was none",
                    rsi::address_text(peer));
  end_session();
  std::erase_if(waiting_, [&](const Waiting& other) { return other.peer != peer; });
  take_waiting();
}

void RobotService::take_waiting() {
  for (auto& waiting : std::exchange(waiting_, {})) {
    waiting.datagram.payload = waiting.payload;
    take(waiting.datagram, waiting.handling);
  }
}

void RobotService::begin_session(const rsi::Datagram& first) {
  controller_ = first.source.address;
  started_ = utc_name(rsi::now());
  watch_ = {rsi::Conversation{controller_, first.destination}, server_->replies()};
  session_.emplace(setup_, settings_.record ? "trace" : "live", static_cast<StreamSink&>(*this));
  turns_ = PlannedTurns(campaign(setup_, {}).order);
  complaints_.new_stream();
  session_log_.about(started_, rsi::find_ipoc(first.payload));
  session_log_.note("RSI from {}", rsi::text(first.source));
  SessionStart start{settings_.output / settings_.name, started_, settings_.record,
                     session_->csv_header(), std::exchange(disk_, std::nullopt)};
  start.on_folder = [facts = run_facts(), log = session_log_](const std::filesystem::path& folder) {
    auto run = facts;
    run.folder = folder;
    log.note("files in {}", folder.string());
    try {
      write_atomically(folder / "run.json", run_json(run));
    } catch (const std::exception& error) {
      log.error("{}", error.what());
    }
  };
  recording_ = recorder_.begin(std::move(start));
  tally_.begin_session({started_, rsi::now(), first.source.address}, recording_);
  live_.begin_session(started_);
  published_ = {};
}

void RobotService::end_session() {
  if (!session_) return;
  session_->finish();
  show();
  recorder_.end();
  RunFacts run = run_facts();
  run.ended = utc_name(rsi::now());
  identifier_.last({settings_.output / settings_.name,
                    started_,
                    recording_,
                    {},
                    session_->snapshot(),
                    watch_.files(session_->link(), true),
                    [run = std::move(run), recording = recording_](const auto& folder) mutable {
                      run.folder = folder;
                      run.recording = recording->counts();
                      return run_json(run);
                    },
                    session_log_});
  tally_.end_session(watch_.report(session_->link()));
  published_ = {};
  session_.reset();
  session_log_.about({}, {});
  not_begun_ = server_->counts().not_begun;
}

void RobotService::sweep(const identify::Sweep& sweep) {
  const auto planned = turns_.joint_of(sweep);
  const auto limits = setup_.limits();
  const std::string words = sweep_line(sweep, planned, limits) +
                            (sweep.defect == identify::SweepDefect::none ? "" : " (not usable)");
  session_log_.note("{}", words);
  tally_.sweep(sweep, words);
  const auto joint = sweep.joint ? sweep.joint : planned;
  live_.sweep(sweep, joint, joint && *joint < limits.size() && limits[*joint].linear, words);
  // With many sweeps in one stream each identification takes longer: leave most of the time free.
  const auto now = Steady::now();
  if (now - last_identification_ < 10 * identifier_.took()) return;
  if (!session_->worth_identifying()) return;
  last_identification_ = now;
  identifier_.interim(recording_, session_->snapshot(), session_log_);
}

void RobotService::say_link() {
  if (session_)
    identifier_.link(recording_, watch_.files(session_->link(), false), session_log_);
  else
    session_log_.note("no RSI at the moment, so there is no link to tell of");
}

RobotState RobotService::first_state() const {
  RobotState state;
  state.name = settings_.name;
  state.listen = server_->local();
  state.transport = server_->transport();
  state.replies = server_->replies();
  for (std::size_t joint = 1; joint <= setup_.joints; ++joint) state.sweeps[joint] = {};
  return state;
}

RobotFacts RobotService::facts() const {
  RobotFacts facts{setup_.joints, {}, {}, setup_.limits()};
  if (setup_.description) {
    facts.home_deg = setup_.description->home_deg;
    if (setup_.description->arm) facts.specified = setup_.description->arm->rows;
  }
  return facts;
}

void RobotService::show() {
  if (!session_) return;
  const std::chrono::duration<double> since = Steady::now() - began_;
  live_.tick(session_->link(), watch_.expects_replies, since.count());
}

void RobotService::publish() {
  std::optional<rsi::LinkReport> under_way;
  if (session_) under_way = watch_.report(session_->link());
  tally_.results(identifier_.results());
  const RobotState& state =
      tally_.state(server_->counts(), recorder_.paused(), under_way ? &*under_way : nullptr);
  // A reader is never waited for: then it is told at the next tick.
  facts_told_ = facts_told_ || status_->facts.try_publish(facts());
  if (status_->state.try_publish(state)) published_ = Steady::now();
}

RunFacts RobotService::run_facts() const {
  RunFacts facts;
  facts.robot = settings_.name;
  facts.started = started_;
  facts.description = settings_.description;
  facts.ethernet_config = settings_.ethernet_config;
  facts.inputs = inputs_;
  facts.listen = server_->local();
  facts.link = server_->counts();
  return facts;
}

}  // namespace sweepd
