#include "daemon/service/robot_service.hpp"

#include <exception>
#include <utility>

#include <spdlog/fmt/ranges.h>

#include "daemon/results/report.hpp"
#include "daemon/service/robot_server.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/counted.hpp"
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

Say say_for(const std::string& name) {
  return [log = Log(name)](Importance importance, const std::string& text) {
    log.say(importance, text);
  };
}

}  // namespace

RobotService::RobotService(const RobotSettings& settings, std::shared_ptr<RobotThreads> threads)
    : inputs_(RobotInputs::read(settings)),
      server_(make_server(settings)),
      local_(server_->local()),
      device_port_(settings.device.there() ? std::make_unique<DevicePort>(settings.device)
                                           : nullptr),
      log_(settings.name),
      status_(std::make_shared<RobotStatus>()),
      threads_(std::move(threads)),
      recorder_(threads_->recorders, inputs_.disk, settings.recording, say_for(settings.name),
                // Results that an earlier sweepd did not write are made of recordings alone.
                {.may_delete = [of = status_] { return of->earlier_finished.load(); }}),
      identifier_(status_),
      reply_thread_(*server_),
      reloaded_(settings),
      session_log_(settings.name),
      tally_(inputs_.first_state(*server_)),
      live_(status_->live) {
  status_->facts.publish(inputs_.facts());
  status_->state.publish(inputs_.first_state(*server_));
  inputs_.make_folder(log_);
}

RobotService::~RobotService() {
  stop();
}

void RobotService::start() {
  say_real_time(reply_thread_.start(inputs_.settings.real_time));
  if (device_port_) device_port_->start();
  acquisition_ = threads_->acquisition.begin(0, [this] { return TurnThreads::Next{turn()}; });
  identifier_.finish_earlier(inputs_.folder(), inputs_.setup, inputs_.hashes, log_);
  if (const auto& tap = inputs_.settings.tap)
    log_.note("watching {} {} on {}, and sending nothing", rsi::text(server_->transport()),
              rsi::text(local()), tap->interface);
  else
    log_.note("listening on {} {}, receive buffer {} KiB", rsi::text(server_->transport()),
              rsi::text(local()), server_->receive_buffer() / 1024);
}

void RobotService::reload(const RobotSettings& settings) {
  reloaded_.reload(settings, log_);
  recorder_.reconfigure(settings.recording);
  recorder_.write_to(settings.output / settings.name);
  identifier_.write_to(settings.output / settings.name);
}

void RobotService::take_over() {
  auto inputs = reloaded_.take();
  if (!inputs) return;
  disk_ = inputs->disk;
  take_over_live(inputs_.settings, std::move(inputs->settings));
  inputs->setup.device = inputs_.setup.device;  // its port is the old one
  inputs_.setup = std::move(inputs->setup);
  inputs_.hashes = std::move(inputs->hashes);
  facts_told_ = false;
}

bool RobotService::stop(std::chrono::seconds patience) {
  if (!reply_thread_.runs()) return true;
  acquisition_.reset();
  server_->settle();
  bool all = drain();
  for (const auto until = Steady::now() + patience; !all && Steady::now() < until;) all = drain();
  if (!all)
    log_.error("{} is flooded: what came last is not recorded; see who sends", rsi::text(local_));
  end_session();
  publish();
  // The result waits for the recording.
  const bool recorded = recorder_.stop(Steady::now() + patience);
  const bool written = identifier_.drain(Steady::now() + (recorded ? kLongestResult : patience));
  if (!written)
    log_.error("the last result is not written: see what is wrong with the disk of {}",
               inputs_.settings.output.string());
  reply_thread_.stop();
  for (const auto& complaint : complaints_.rest(server_->counts())) log_.error("{}", complaint);
  if (const auto rest = device_port_ ? device_port_->rest() : std::nullopt) log_.error("{}", *rest);
  server_.reset();
  device_port_.reset();
  return recorded && written;
}

void RobotService::say_real_time(const RealTimeReport& report) {
  if (!report.granted.empty()) log_.note("reply thread: {}", fmt::join(report.granted, ", "));
  if (inputs_.settings.real_time.wish == RealTime::require && !report.refused.empty()) {
    reply_thread_.stop();
    throw std::runtime_error(inputs_.settings.name + ": " + report.refused.front() +
                             "; or set realtime to \"try\"");
  }
  for (const auto& refused : report.refused) log_.warning("{}", refused);
}

RobotService::Steady::time_point RobotService::turn() {
  ++acquisition_beats_;
  if (!session_) take_over();
  const auto heard = server_->heard_until();  // what came before is drained now
  const bool all = drain();
  if (link_wanted_.exchange(false)) say_link();
  const auto now = Steady::now();
  if (all && session_ && heard - last_datagram_ > inputs_.settings.silence) {
    session_log_.note("RSI has been silent for {} ms: the stream has ended",
                      inputs_.settings.silence.count());
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
  if (device_port_) take_device();
  if (session_) watch_.count(server_->counts(), before_);
  while (const auto remark = server_->remark()) session_log_.warning("{}", *remark);
  complain();
  return taken < kMostInATurn;
}

void RobotService::complain() {
  for (const auto& complaint : complaints_.about(server_->counts(), Steady::now()))
    session_log_.error("{}", complaint);
}

/// Lines of the device that came while no session was under way are of no use.
void RobotService::take_device() {
  rsi::Datagram datagram;
  for (std::size_t i = 0; i < kMostInATurn && device_port_->pop(datagram); ++i) {
    if (!session_) continue;
    recorder_.datagram(datagram);
    device_->device(datagram);
  }
  if (const auto news = device_port_->news()) log_.say(news->importance, news->text);
  if (const auto complaint = device_port_->complaint(Steady::now()))
    session_log_.error("{}", *complaint);
}

void RobotService::take(const rsi::Datagram& datagram, rsi::Handling handling) {
  const bool sent = handling.sent;
  const auto peer = (sent ? datagram.destination : datagram.source).address;
  if (session_ && peer != controller_) return take_from_other(datagram, handling, peer);
  if (!session_) {
    // A stream begins with what can be answered; stray datagrams are no session.
    if (sent) return;
    if (rsi::find_ipoc(datagram.payload).empty())
      return log_.warning(
          "{} sends packets without an IPOC, which cannot be answered: check what it is",
          rsi::address_text(peer));
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
  device_->telegram(datagram);
  session_->telegram(datagram);
}

void RobotService::take_from_other(const rsi::Datagram& datagram, rsi::Handling handling,
                                   std::uint32_t peer) {
  waiting_.add(datagram, handling, peer);
  if (!handling.streams) return;
  session_log_.note("{} streams: it is the controller now; before it was {}, with {}",
                    rsi::address_text(peer), rsi::address_text(controller_),
                    rsi::counted(session_->link().statistics().counts().telegrams, "telegram"));
  end_session();
  waiting_.leave_only(peer);
  take_waiting();
}

void RobotService::take_waiting() {
  waiting_.hand_over([this](const auto& datagram, auto handling) { take(datagram, handling); });
}

void RobotService::begin_session(const rsi::Datagram& first) {
  controller_ = first.source.address;
  started_ = utc_name(rsi::now());
  watch_ = {rsi::Conversation{controller_, first.destination}, server_->replies()};
  session_.emplace(inputs_.setup, inputs_.settings.record ? "trace" : "live",
                   static_cast<StreamSink&>(*this), first.payload);
  ++threads_->streaming;
  interim_pace_.begin_session();
  device_.emplace(inputs_.setup);
  turns_ = PlannedTurns(campaign(inputs_.setup, {}).order);
  complaints_.new_stream();
  session_log_.about(started_, rsi::find_ipoc(first.payload));
  session_log_.note("RSI from {}", rsi::text(first.source));
  if (!session_->missing_signals().empty()) session_log_.warning("{}", session_->missing_signals());
  SessionStart start{inputs_.folder(), started_, inputs_.settings.record, session_->csv_header(),
                     std::exchange(disk_, std::nullopt)};
  start.on_folder = [facts = run_facts(), log = session_log_](const std::filesystem::path& folder) {
    auto run = facts;
    run.folder = folder;
    log.note("files in {}", folder.string());
    try {
      write_atomically(folder / file_names::kRun, run_json(run));
    } catch (const std::exception& error) {
      log.error("{}", error.what());
    }
  };
  start.on_pause = mark_recording_paused;
  start.on_loss = mark_recording_deleted;
  recording_ = recorder_.begin(std::move(start));
  tally_.begin_session({started_, rsi::now(), first.source.address}, recording_);
  live_.begin_session(started_);
  published_ = {};
}

void RobotService::end_session() {
  if (!session_) return;
  session_->finish();
  complaints_.new_stream();
  complain();  // what of this one was not answered is not said of the next
  show();
  if (const auto& seen = device_->counts(); seen.datagrams > 0)
    session_log_.note("the device sent {}, and {} that the columns do not fit",
                      rsi::counted(seen.points, "point"), rsi::counted(seen.others, "line"));
  recorder_.end();
  RunFacts run = run_facts();
  run.ended = utc_name(rsi::now());
  identifier_.last({inputs_.folder(),
                    started_,
                    recording_,
                    {},
                    device_->with_device(session_->snapshot()),
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
  --threads_->streaming;
  session_log_.about({}, {});
  before_ = server_->counts();
}

void RobotService::sweep(const identify::Sweep& sweep) {
  const auto planned = turns_.joint_of(sweep);
  const auto limits = inputs_.setup.limits();
  const std::string words = sweep_line(sweep, planned, limits) +
                            (sweep.defect == identify::SweepDefect::none ? "" : " (not usable)");
  session_log_.note("{}", words);
  tally_.sweep(sweep, words);
  const auto joint = sweep.joint ? sweep.joint : planned;
  live_.sweep(sweep, joint, joint && *joint < limits.size() && limits[*joint].linear, words);
  const auto now = Steady::now();
  if (!interim_pace_.due(now, identifier_.took(), threads_->streaming)) return;
  if (!session_->worth_identifying()) return;
  interim_pace_.begin(now);
  identifier_.interim(recording_, session_->snapshot(), session_log_);
}

void RobotService::say_link() {
  if (session_)
    identifier_.link(recording_, watch_.files(session_->link(), false), session_log_);
  else
    session_log_.note("no RSI at the moment, so there is no link to tell of");
}

void RobotService::show() {
  if (!session_) return;
  const std::chrono::duration<double> since = Steady::now() - began_;
  live_.tick(session_->link(), watch_.expects_replies, since.count());
}

void RobotService::publish() {
  std::optional<rsi::Link::Reports> under_way;
  if (session_) under_way = watch_.reports(session_->link());
  tally_.results(identifier_.results());
  tally_.disk_free(recorder_.disk_free());
  const RobotState& state = tally_.state(server_->counts(), recorder_.paused(), under_way);
  // A reader is never waited for: then it is told at the next tick.
  facts_told_ = facts_told_ || status_->facts.try_publish(inputs_.facts());
  if (status_->state.try_publish(state)) published_ = Steady::now();
}

RunFacts RobotService::run_facts() const {
  RunFacts facts = inputs_.run_facts();
  facts.started = started_;
  facts.listen = server_->local();
  facts.link = server_->counts();
  facts.queue_full = watch_.queue_full;
  if (inputs_.settings.tap) facts.watched_on = inputs_.settings.tap->interface;
  return facts;
}

}  // namespace sweepd
