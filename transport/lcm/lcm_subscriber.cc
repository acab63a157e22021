#include <condition_variable>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "transport/answers.h"
#include "transport/assembler.h"
#include "transport/frame_queue.h"
#include "transport/lcm/lcm_channels.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/lcm/lcm_link.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/status_board.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kSignPeriod{1000}, kAskPeriod{200}, kAnswerTime{2000};

/// Daemons have no writers here: their session names them.
StatusBoard::WriterId writerId(const Status& status) {
  StatusBoard::WriterId id{};
  for (size_t i = 0; i < 8; ++i) id[i] = static_cast<uint8_t>(status.session >> (8 * i));
  for (size_t i = 0; i < 4; ++i) id[8 + i] = static_cast<uint8_t>(status.groom_id >> (8 * i));
  return id;
}

class LcmSubscriber final : public Subscriber {
 public:
  LcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options)
      : options_(options),
        channels_(options.groom_id),
        grooms_(options.groom_id),
        bodies_(options.groom_id),
        link_(std::move(link)) {
    sign_.reader = std::random_device()() | static_cast<uint64_t>(std::random_device()()) << 32;
    sign_.groom_id = options.groom_id;
    ears_.push_back(link_->listen(channels_.groom, [this](auto message) { receiveGroom(message); }));
    ears_.push_back(link_->listen(channels_.bodies, [this](auto message) { receiveBody(message); }));
    ears_.push_back(link_->listen(channels_.guides, [this](auto message) { receiveGuides(message); }));
    ears_.push_back(link_->listen(channels_.status, [this](auto message) { receiveStatus(message); }));
    signs_ = std::thread([this] { giveSigns(); });
  }

  ~LcmSubscriber() override {
    ears_.clear();
    {
      const std::lock_guard lock(sign_mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    signs_.join();
  }

  std::shared_ptr<const GroomDescription> groom() const override { return queue_.groom(); }
  std::shared_ptr<const BodyDescription> body() const override { return queue_.body(); }
  std::shared_ptr<const GuideFrame> frame() const override { return queue_.frame(); }
  std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after, milliseconds timeout) override {
    return queue_.waitForFrame(after, timeout);
  }
  bool waitForGroom(milliseconds timeout) override { return queue_.waitForGroom(timeout); }

  std::optional<Status> status() const override {
    forgetSilent();
    const auto groom = queue_.groom();
    return statuses_.ofGroom(options_.groom_id, groom ? groom->session : 0);
  }
  std::vector<Status> allStatuses() const override {
    forgetSilent();
    return statuses_.all();
  }

  void send(const Command& command) override {
    checkCommand(command, options_.groom_id);
    const auto deadline = Clock::now() + kAnswerTime;
    while (!status()) {
      if (Clock::now() > deadline) {
        throw Error("no daemon answers",
                    "groom " + std::to_string(options_.groom_id) + " on LCM " + options_.url,
                    "start strandcastd --transport lcm, or check --domain, --lcm-url and the groom id");
      }
      std::this_thread::sleep_for(milliseconds(5));
    }
    Command own = command;
    own.groom_id = options_.groom_id;
    std::vector<uint8_t> message;
    toBytes(own, message);
    link_->send(channels_.command, message);
  }

  std::optional<std::string> waitForAnswer(uint64_t command, milliseconds timeout) override {
    return answers_.wait(command, timeout);
  }

  ReceiveStatistics statistics() const override {
    ReceiveStatistics statistics;
    {
      const std::lock_guard lock(assembly_mutex_);
      statistics = frames_.statistics();
      statistics.chunks_rejected += grooms_.chunksRejected() + bodies_.chunksRejected() + messages_damaged_;
    }
    queue_.addLatencies(statistics);
    return statistics;
  }

 private:
  bool isInForce(uint64_t session, uint32_t revision) const {
    const auto groom = queue_.groom();
    return groom && groom->session == session && revision <= groom->revision;
  }

  void receiveGroom(std::span<const uint8_t> message) {
    GroomChunk chunk;
    const bool is_sound = fromBytes(message, chunk);
    const std::lock_guard lock(assembly_mutex_);
    if (!is_sound) ++messages_damaged_;
    // The carousel brings every groom again and again.
    if (!is_sound || isInForce(chunk.session, chunk.revision)) return;
    const auto groom = grooms_.add(std::move(chunk));
    if (groom && queue_.setGroom(groom)) frames_.setGroom(groom);
  }

  void receiveBody(std::span<const uint8_t> message) {
    BodyChunk chunk;
    const bool is_sound = fromBytes(message, chunk);
    const std::lock_guard lock(assembly_mutex_);
    if (!is_sound) ++messages_damaged_;
    if (!is_sound || (queue_.body() && isInForce(chunk.session, chunk.revision))) return;
    if (auto body = bodies_.add(std::move(chunk))) queue_.setBody(std::move(body));
  }

  void receiveGuides(std::span<const uint8_t> message) {
    const std::lock_guard lock(assembly_mutex_);
    if (!fromBytes(message, guide_chunk_)) {
      ++messages_damaged_;
      return;
    }
    const auto groom = queue_.groom();
    const bool is_new = guide_chunk_.groom_id == options_.groom_id && groom &&
                        (groom->session != guide_chunk_.session || groom->revision < guide_chunk_.revision);
    if (is_new) askForGroom();
    push(frames_.add(guide_chunk_));
    push(frames_.concealOverdue());
  }

  void push(std::shared_ptr<const GuideFrame> frame) {
    if (!frame) return;
    const uint64_t publish_time = frame->publish_time;
    queue_.push(std::move(frame), latencyMs(publish_time));
  }

  void receiveStatus(std::span<const uint8_t> message) {
    Status status;
    if (!fromBytes(message, status)) return;
    if (status.groom_id == options_.groom_id) answers_.post(status);
    const StatusBoard::WriterId id = writerId(status);
    statuses_.post(id, std::move(status));
    const std::lock_guard lock(heard_mutex_);
    heard_[id] = Clock::now();
  }

  void forgetSilent() const {
    const std::lock_guard lock(heard_mutex_);
    std::erase_if(heard_, [&, now = Clock::now()](const auto& heard) {
      const bool is_silent = now - heard.second > kLcmSilence;
      if (is_silent) statuses_.remove(heard.first);
      return is_silent;
    });
  }

  /// A daemon has started anew, or changed its groom.
  void askForGroom() {
    const std::lock_guard lock(sign_mutex_);
    lacks_groom_ = true;
    wake_.notify_all();
  }

  void giveSigns() {
    std::vector<uint8_t> message;
    std::unique_lock lock(sign_mutex_);
    while (!stop_) {
      sign_.wants_groom = std::exchange(lacks_groom_, false) || !queue_.groom() || !queue_.body();
      toBytes(sign_, message);
      link_->send(channels_.reader, message);
      // One who asks is not heard again at once; one who has all asks as soon as something new is cast.
      wake_.wait_for(lock, sign_.wants_groom ? kAskPeriod : kSignPeriod,
                     [&] { return stop_ || (lacks_groom_ && !sign_.wants_groom); });
    }
  }

  const LcmOptions options_;
  const LcmChannels channels_;
  FrameQueue queue_;
  mutable StatusBoard statuses_;
  Answers answers_;
  mutable std::mutex heard_mutex_;
  mutable std::map<StatusBoard::WriterId, Clock::time_point> heard_;

  mutable std::mutex assembly_mutex_;  // of what follows
  GroomAssembler grooms_;
  BodyAssembler bodies_;
  GuideAssembler frames_{true};
  GuideChunk guide_chunk_;
  uint64_t messages_damaged_ = 0;

  std::mutex sign_mutex_;  // of what follows
  std::condition_variable wake_;
  ReaderSign sign_;
  bool lacks_groom_ = false, stop_ = false;

  std::shared_ptr<MessageLink> link_;
  std::vector<MessageLink::Listening> ears_;
  std::thread signs_;
};

}  // namespace

std::unique_ptr<Subscriber> makeLcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options) {
  return std::make_unique<LcmSubscriber>(std::move(link), options);
}

std::unique_ptr<Subscriber> makeLcmSubscriber(const LcmOptions& options) {
  return makeLcmSubscriber(std::make_shared<LcmLink>(options.url), options);
}

}  // namespace strandcast
