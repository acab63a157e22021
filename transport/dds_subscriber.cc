#include <spdlog/spdlog.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/dds.h"
#include "transport/dds_participant.h"
#include "transport/dds_type.h"
#include "transport/receiving_subscriber.h"
#include "transport/versions.h"

namespace strandcast {
namespace {

namespace dds = eprosima::fastdds::dds;

constexpr std::chrono::milliseconds kWatchPeriod{400};
/// Time in which the writers of a known participant are discovered.
constexpr std::chrono::milliseconds kFindingTime{1200};
/// The same bound for a daemon that shares its groom: it sends no status while it starts or stands by.
constexpr std::chrono::milliseconds kStandbyTime{5000};
/// Fast DDS 2.9.1 repeats a lost handshake message only after a second. On two busy cores one program in
/// three needs a second more, one in twelve two, one in sixty four.
constexpr std::chrono::milliseconds kSecureAnswerTime{12000};
const eprosima::fastrtps::Duration_t kAcknowledgmentPoll{0, 50000000};
/// How often a reader looks whether its report has changed, and how many times until it sends it anyway.
constexpr std::chrono::milliseconds kReportPoll{200};
constexpr int kPollsPerReport = 5;
constexpr int kMaxStarvedChecks = 2;  // checks without a chunk; a daemon sends its status twice a second

class DdsSubscriber final : public ReceivingSubscriber {
 public:
  explicit DdsSubscriber(const DdsOptions& options)
      : ReceivingSubscriber(options.groom_id, options.profile == DdsProfile::kBestEffort),
        options_(options),
        neighbours_([this] { warnOnce(); }),
        groom_listener_([this](GroomChunk& chunk, const auto&) { receive(std::move(chunk)); }),
        hair_listener_([this](HairChunk& chunk, const auto&) { receive(std::move(chunk)); }),
        body_listener_([this](BodyChunk& chunk, const auto&) { receive(std::move(chunk)); }),
        collider_listener_([this](ColliderChunk& chunk, const auto&) { receive(std::move(chunk)); }),
        guide_listener_([this](GuideChunk& chunk, const auto&) { takeGuides(chunk); }),
        status_listener_([this](Status& status, const auto& writer) { receive(std::move(status), writer); },
                         {.left = [this](const auto& writer) { statuses_.remove(writer); },
                          .disposed = [this](const auto& writer) { statuses_.remove(writer); }}) {
    DdsNetwork network(options);
    // Statuses and commands are small, and by UDP they reach daemons of other users at once.
    if (!options.frames) network.uses_shared_memory = false;
    join(network);
    if (network.uses_shared_memory) watchdog_ = std::thread([this] { watch(); });
    if (options.frames) reporter_ = std::thread([this] { sendReports(); });
  }

  ~DdsSubscriber() override {
    {
      const std::lock_guard lock(watch_mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    if (watchdog_.joinable()) watchdog_.join();
    if (reporter_.joinable()) reporter_.join();
    participant_.reset();  // and with it the threads that call the listeners
  }

  std::optional<OtherVersion> otherVersion() const override {
    return neighbours_.otherVersion(options_.groom_id, true);
  }
  bool mayCommand() const override { return options_.keys.empty() || command_writer_ != nullptr; }

  void send(const Command& command, const std::function<bool()>& gives_up) override {
    checkCommand(command, options_.groom_id);
    if (!mayCommand()) {
      throw Error("these keys do not permit commands", options_.keys.string(),
                  "use those of a renderer: see `strandcast keys --help`");
    }
    const std::string where =
        "groom " + std::to_string(options_.groom_id) + " in DDS domain " + std::to_string(options_.domain);
    const auto answer_time = !options_.keys.empty() ? kSecureAnswerTime
                             : options_.profile == DdsProfile::kLocal
                                 ? kAnswerTime + kFindingTime + kWatchPeriod
                                 : kAnswerTime;
    const auto within = [&gives_up](std::chrono::milliseconds time) {
      return [&gives_up, deadline = std::chrono::steady_clock::now() + time] {
        return std::chrono::steady_clock::now() <= deadline && !(gives_up && gives_up());
      };
    };
    // Answers come in its status, which must therefore arrive here.
    for (const auto may_come = within(answer_time); daemons_.matched() == 0 || !status();
         std::this_thread::sleep_for(std::chrono::milliseconds(5)))
      if (!may_come()) throw Error("no daemon answers", where, noAnswerRemedy());
    const std::lock_guard lock(send_mutex_);
    Command sample = command;
    sample.groom_id = options_.groom_id;
    if (!command_writer_ || !command_writer_->write(&sample))
      throw Error("the command cannot be written", where, noAnswerRemedy());
    // Waits, so that a program may end right after the call.
    const auto may_come = within(kAnswerTime);
    while (command_writer_->wait_for_acknowledgments(kAcknowledgmentPoll) !=
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
      if (!may_come()) throw Error("the daemon does not acknowledge the command", where, noAnswerRemedy());
  }

 private:
  void warnOnce() {
    const auto other = otherVersion();
    if (other && !has_warned_.exchange(true)) spdlog::warn(warning(*other));
  }
  std::string warning(const OtherVersion& other) const {
    return warningOf(other, options_.groom_id, "DDS domain " + std::to_string(options_.domain));
  }

  void join(const DdsNetwork& network) {
    participant_.emplace(network, options_.groom_id, DdsRole{false, options_.groom_id, false}, &neighbours_);
    if (options_.frames) {
      participant_->createReader(kGroomTopic, new WireType<GroomChunk>, &groom_listener_);
      participant_->createReader(kHairsTopic, new WireType<HairChunk>, &hair_listener_);
      participant_->createReader(kBodiesTopic, new WireType<BodyChunk>, &body_listener_);
      participant_->createReader(kCollidersTopic, new WireType<ColliderChunk>, &collider_listener_);
      participant_->createReader(kGuidesTopic, new WireType<GuideChunk>, &guide_listener_,
                                 options_.profile != DdsProfile::kBestEffort);
    }
    participant_->createReader(kStatusTopic, new WireType<Status>, &status_listener_);
    if (options_.frames)
      report_writer_ =
          participant_->createWriterIfPermitted(kReadersTopic, new WireType<ReaderReport>, nullptr);
    command_writer_ = participant_->createWriterIfPermitted(kCommandTopic, new WireType<Command>, &daemons_);
  }

  std::string noAnswerRemedy() const {
    if (const auto other = otherVersion()) return warning(*other);
    if (!options_.keys.empty())
      return "start strandcastd, or check --domain, the groom id and the keys: a daemon refuses those of "
             "another CA, "
             "and those that are out of force or do not permit this groom";
    if (neighbours_.participantsWithoutRole() > 0)
      return "start strandcastd, or check --domain and the groom id; a program there says nothing to this "
             "one: a "
             "daemon with --profile secure answers only who has --keys";
    return "start strandcastd, or check --domain and the groom id";
  }

  void sendReports() {
    std::unique_lock lock(watch_mutex_);
    ReaderReport sent;
    for (int polls = 0; !wake_.wait_for(lock, kReportPoll, [&] { return stop_; }); ++polls) {
      lock.unlock();
      ReaderReport now = report();
      if (polls % kPollsPerReport == 0 || isUrgent(sent, now)) {
        sent = now;
        const std::lock_guard sending(send_mutex_);
        if (report_writer_ != nullptr) report_writer_->write(&sent);
      }
      lock.lock();
    }
  }

  /// Whether a daemon is known, but nothing from its writers arrives here.
  bool isUnreachable() {
    return !status() && neighbours_.hasSilentDaemon(options_.groom_id, kFindingTime, kStandbyTime);
  }

  /// Whether a daemon casts, as far as its status shows, but none of its chunks has come since the last
  /// check.
  bool isStarved() {
    const std::optional<Status> now = status();
    const bool may_cast = guide_listener_.matched() > 0 && (!now || now->frames > 0);
    const uint64_t chunks = chunks_;
    return may_cast && chunks == std::exchange(watched_chunks_, chunks);
  }

  /// Through shared memory, Fast DDS 2.9.1 sometimes delivers nothing to a reader whose predecessor was
  /// killed. It never delivers anything where the daemon runs as another user, whose segments cannot be
  /// opened.
  void watch() {
    std::unique_lock lock(watch_mutex_);
    int starved = 0;
    while (!wake_.wait_for(lock, kWatchPeriod, [&] { return stop_; })) {
      starved = isStarved() ? starved + 1 : 0;
      const bool is_unreachable = participant_ && isUnreachable();
      if (participant_ && !is_unreachable && starved < kMaxStarvedChecks) continue;
      const std::lock_guard sending(send_mutex_);
      command_writer_ = report_writer_ = nullptr;
      participant_.reset();
      statuses_.clear();
      DdsNetwork network(options_);
      network.uses_shared_memory = false;
      if (is_unreachable)
        spdlog::info(
            "nothing comes through shared memory from the daemon of groom {}, as where it runs as another "
            "user: going on over UDP",
            options_.groom_id);
      try {
        join(network);
        return;
      } catch (const Error&) {  // the network is down, perhaps temporarily
      }
    }
  }

  void takeGuides(GuideChunk& received) {
    ++chunks_;
    receiveGuides([&](GuideChunk& chunk) {
      std::swap(chunk, received);  // both keep their memory
      return true;
    });
  }

  const DdsOptions options_;
  std::atomic<uint64_t> chunks_{0};  // of guides, received
  std::mutex send_mutex_;
  // Listeners before the participant, which is destroyed first, with the threads that call them.
  MatchCounter daemons_;
  std::atomic<bool> has_warned_{false};
  DdsNeighbours neighbours_;
  SampleListener<GroomChunk> groom_listener_;
  SampleListener<HairChunk> hair_listener_;
  SampleListener<BodyChunk> body_listener_;
  SampleListener<ColliderChunk> collider_listener_;
  SampleListener<GuideChunk> guide_listener_;
  SampleListener<Status> status_listener_;
  std::optional<DdsParticipant> participant_;
  dds::DataWriter* command_writer_ = nullptr;
  dds::DataWriter* report_writer_ = nullptr;

  uint64_t watched_chunks_ = 0;  // chunks_ at the watchdog's last check
  std::mutex watch_mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread watchdog_;  // kLocal only
  std::thread reporter_;  // of frames only
};

}  // namespace

std::unique_ptr<Subscriber> makeDdsSubscriber(const DdsOptions& options) {
  checkGroomId(options.groom_id, "DDS options");
  return std::make_unique<DdsSubscriber>(options);
}

}  // namespace strandcast
