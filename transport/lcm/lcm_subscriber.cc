#include <spdlog/spdlog.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/lcm/lcm_link.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/receiving_subscriber.h"
#include "transport/versions.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kReportPeriod{1000}, kRequestPeriod{200};

/// LCM has no writers: session and groom id identify a daemon.
StatusBoard::WriterId writerId(const Status& status) {
  StatusBoard::WriterId id{};
  for (size_t i = 0; i < 8; ++i) id[i] = static_cast<uint8_t>(status.session >> (8 * i));
  for (size_t i = 0; i < 4; ++i) id[8 + i] = static_cast<uint8_t>(status.groom_id >> (8 * i));
  return id;
}

class LcmSubscriber final : public ReceivingSubscriber {
 public:
  LcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options)
      : ReceivingSubscriber(options.groom_id, true),
        options_(options),
        channels_(options.groom_id),
        link_(std::move(link)) {
    const MessageLink::Channel status{channels_.status, [this](auto message) { receiveStatus(message); }};
    if (!options.frames) {
      subscriptions_ = link_->listen({status});
      return;
    }
    subscriptions_ =
        link_->listen({{channels_.groom, [this](auto message) { receiveGroom(message); }},
                       {channels_.bodies, [this](auto message) { receiveBody(message); }},
                       {channels_.hairs, [this](auto message) { receiveHairs(message); }},
                       {channels_.colliders, [this](auto message) { receiveColliders(message); }},
                       {channels_.guides, [this](auto message) { receiveGuides(message); }},
                       status});
    report_thread_ = std::thread([this] { sendReports(); });
  }

  ~LcmSubscriber() override {
    subscriptions_.clear();
    {
      const std::lock_guard lock(report_mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    if (report_thread_.joinable()) report_thread_.join();
  }

  std::optional<Status> status() const override {
    expireSilentDaemons();
    return ReceivingSubscriber::status();
  }
  std::vector<Status> allStatuses() const override {
    expireSilentDaemons();
    return ReceivingSubscriber::allStatuses();
  }

  std::optional<OtherVersion> otherVersion() const override {
    const std::lock_guard lock(heard_mutex_);
    return Clock::now() - other_heard_ > kLcmSilence ? std::nullopt : other_;
  }

  bool mayCommand() const override { return !isLcmLog(options_.url); }
  void send(const Command& command, const std::function<bool()>& gives_up) override {
    checkCommand(command, options_.groom_id);
    if (!mayCommand())
      throw Error("a log file takes no commands", options_.url, "steer a daemon that casts on a network");
    const auto deadline = Clock::now() + kAnswerTime;
    while (!status()) {
      if (Clock::now() > deadline || (gives_up && gives_up())) {
        const auto other = otherVersion();
        throw Error(
            "no daemon answers", "groom " + std::to_string(options_.groom_id) + " on LCM " + options_.url,
            other ? warning(*other)
                  : "start strandcastd --transport lcm, or check --domain, --lcm-url and the groom id");
      }
      std::this_thread::sleep_for(milliseconds(5));
    }
    Command own = command;
    own.groom_id = options_.groom_id;
    std::vector<uint8_t> message;
    toBytes(own, message);
    link_->send(channels_.command, message);
  }

 private:
  bool isCurrent(uint64_t session, uint32_t revision) const {
    const auto own = groom();
    return own && own->session == session && revision <= own->revision;
  }

  // Grooms arrive repeatedly.

  void receiveGroom(std::span<const uint8_t> message) {
    GroomChunk chunk;
    if (!fromBytes(message, chunk)) return countDamagedMessage();
    if (!isCurrent(chunk.session, chunk.revision)) receive(std::move(chunk));
  }

  void receiveBody(std::span<const uint8_t> message) {
    BodyChunk chunk;
    if (!fromBytes(message, chunk)) return countDamagedMessage();
    if (!body() || !isCurrent(chunk.session, chunk.revision)) receive(std::move(chunk));
  }

  void receiveHairs(std::span<const uint8_t> message) {
    HairChunk chunk;
    if (!fromBytes(message, chunk)) return countDamagedMessage();
    const auto own = hairs();
    if (!own || own->session != chunk.session || own->revision < chunk.revision) receive(std::move(chunk));
  }

  void receiveColliders(std::span<const uint8_t> message) {
    ColliderChunk chunk;
    if (!fromBytes(message, chunk)) return countDamagedMessage();
    const auto own = colliders();
    if (!own || own->session != chunk.session || own->revision < chunk.revision) receive(std::move(chunk));
  }

  void receiveGuides(std::span<const uint8_t> message) {
    ReceivingSubscriber::receiveGuides([&](GuideChunk& chunk) {
      if (!fromBytes(message, chunk)) {
        if (const auto other = versionOfMessage(message, true)) note(*other);
        return false;
      }
      const auto own = groom();
      const bool is_new = chunk.groom_id == options_.groom_id && own &&
                          (own->session != chunk.session || own->revision < chunk.revision);
      if (is_new) requestGroom();
      return true;
    });
  }

  void receiveStatus(std::span<const uint8_t> message) {
    Status status;
    if (isOldStatusOf(options_.groom_id, message)) note(*versionOfMessage(message, true));
    if (!fromBytes(message, status)) return;
    expireSilentDaemons();  // also while nobody calls status()
    const StatusBoard::WriterId id = writerId(status);
    if (!receive(std::move(status), id)) return;
    const std::lock_guard lock(heard_mutex_);
    heard_[id] = Clock::now();
  }

  void note(const OtherVersion& other) {
    const std::lock_guard lock(heard_mutex_);
    if (!other_) spdlog::warn(warning(other));
    other_ = other;
    other_heard_ = Clock::now();
  }

  std::string warning(const OtherVersion& other) const {
    return warningOf(other, options_.groom_id, "LCM " + options_.url);
  }

  void expireSilentDaemons() const {
    const std::lock_guard lock(heard_mutex_);
    std::erase_if(heard_, [&, now = Clock::now()](const auto& heard) {
      const bool is_silent = now - heard.second > kLcmSilence;
      if (is_silent) statuses_.remove(heard.first);
      return is_silent;
    });
  }

  /// After a new session or a changed groom.
  void requestGroom() {
    const std::lock_guard lock(report_mutex_);
    lacks_groom_ = true;
    wake_.notify_all();
  }

  void sendReports() {
    std::vector<uint8_t> message;
    std::unique_lock lock(report_mutex_);
    for (ReaderReport sent; !stop_;) {
      const bool lacks_groom = std::exchange(lacks_groom_, false);
      lock.unlock();  // receiveGuides() has the lock that report() takes, and takes this one
      sent = report();
      if (lacks_groom) sent.wants |= ReaderReport::kGroomAndBody;
      toBytes(sent, message);
      link_->send(channels_.reader, message);
      lock.lock();
      if (sent.wants != 0) {
        wake_.wait_for(lock, kRequestPeriod, [&] { return stop_; });
        continue;
      }
      // A complete reader asks as soon as it lacks something.
      const Clock::time_point due = Clock::now() + kReportPeriod;
      while (!stop_ && !lacks_groom_ && Clock::now() < due) {
        wake_.wait_for(lock, kRequestPeriod);
        lock.unlock();
        const bool is_urgent = isUrgent(sent, report());
        lock.lock();
        if (is_urgent) break;
      }
    }
  }

  const LcmOptions options_;
  const LcmChannels channels_;
  mutable std::mutex heard_mutex_;
  mutable std::map<StatusBoard::WriterId, Clock::time_point> heard_;
  std::optional<OtherVersion> other_;  // a daemon's, the last one heard
  Clock::time_point other_heard_{};

  std::mutex report_mutex_;  // guards all below
  std::condition_variable wake_;
  bool lacks_groom_ = false, stop_ = false;

  std::shared_ptr<MessageLink> link_;
  std::vector<MessageLink::Subscription> subscriptions_;
  std::thread report_thread_;
};

}  // namespace

std::unique_ptr<Subscriber> makeLcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options) {
  checkGroomId(options.groom_id, "LCM options");
  return std::make_unique<LcmSubscriber>(std::move(link), options);
}

std::unique_ptr<Subscriber> makeLcmSubscriber(const LcmOptions& options) {
  checkOneEnd(options);
  if (isWrittenLog(options.url)) throw Error("a reader would replace the log", options.url, "give mode=r");
  return makeLcmSubscriber(std::make_shared<LcmLink>(options.url), options);
}

}  // namespace strandcast
