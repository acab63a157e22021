#include <spdlog/spdlog.h>

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/codec/guide_encoder.h"
#include "transport/commands.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/lcm/lcm_link.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/pose_inbox.h"
#include "transport/publisher.h"
#include "transport/reader_reports.h"
#include "transport/versions.h"

namespace strandcast {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kCarouselPeriod{1000}, kStatusPeriod{500}, kRepeatAtMost{100};
/// Chunks of the description per burst; a gigabit network sustains this rate.
constexpr size_t kBurst = 4;
constexpr milliseconds kBetweenBursts{2};
constexpr size_t kAnswersKept = 256;
/// The last message of a publisher is repeated, because nothing is acknowledged.
constexpr int kFinalStatusRepeats = 3;

class LcmPublisher final : public Publisher {
 public:
  LcmPublisher(std::shared_ptr<MessageLink> link, const LcmOptions& options)
      : options_(options),
        channels_(options.groom_id),
        poses_(options.groom_id),
        announced_(options.groom_id, options.session, options.codec),
        link_(std::move(link)) {
    subscriptions_ = link_->listen({{channels_.command, [this](auto message) { receiveCommand(message); }},
                                    {channels_.pose, [this](auto message) { receivePoses(message); }},
                                    {channels_.reader, [this](auto message) { receiveReport(message); }},
                                    {channels_.status, [this](auto message) { receiveStatus(message); }}});
    publishStatus({});      // so that rivals learn of this session at once
    announceColliders({});  // so that readers do not wait for colliders
    service_ = std::thread([this] { serve(); });
  }

  ~LcmPublisher() override {
    subscriptions_.clear();
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    service_.join();
    for (int i = 0; i < kFinalStatusRepeats; ++i) link_->send(channels_.status, status_message_);
  }

  void announce(const GroomDescription& groom, const BodyDescription& body) override {
    const AnnouncedGroom::Chunks chunks = announced_.chunksOf(groom, body);
    std::vector<Message> description = messagesOf(channels_.groom, chunks.groom);
    append(description, messagesOf(channels_.bodies, chunks.body));
    announced_.accept(groom);
    std::unique_lock lock(mutex_);
    description_ = std::move(description);
    hairs_.clear();
    rebuildCarousel();
    sendDescription(lock);  // before the first frame that fits it
    wake_.notify_all();
  }

  void announceHairs(const HairDescription& hairs) override {
    std::vector<Message> messages = messagesOf(channels_.hairs, announced_.chunksOf(hairs));
    std::unique_lock lock(mutex_);
    hairs_ = std::move(messages);
    rebuildCarousel();
    if (isWrittenLog(options_.url)) return sendDescription(lock);
    repeat_due_ = Clock::now();  // frames that follow do not wait for it
    wake_.notify_all();
  }

  void announceColliders(const ColliderSet& colliders) override {
    checkColliders(colliders, "groom " + std::to_string(options_.groom_id));
    ColliderSet own = colliders;
    own.groom_id = options_.groom_id;
    own.session = options_.session;
    std::unique_lock lock(mutex_);
    next_colliders_ = std::move(own);
    if (description_.empty()) return encodeColliders(lock);  // colliders are sent with the groom
    if (isWrittenLog(options_.url)) {
      encodeColliders(lock);
      return sendDescription(lock);
    }
    repeat_due_ = Clock::now();  // frames that follow do not wait for it
    wake_.notify_all();
  }

  void publish(const GuideFrame& frame) override {
    FrameGuides guides(frame);
    send(frame, guides);
  }
  void publishFrom(GuideFrame& frame, GuideSource& guides) override { send(frame, guides); }
  void send(const GuideFrame& frame, GuideSource& guides) {
    announced_.divide(frame, guides, [this](const GuideChunk& chunk) {
      toBytes(chunk, guide_message_);
      link_->send(channels_.guides, guide_message_);
    });
  }

  void publishStatus(const Status& status) override {
    Status own = status;
    own.groom_id = options_.groom_id;
    own.session = options_.session;
    const std::lock_guard lock(mutex_);
    toBytes(own, status_message_);
    status_due_ = Clock::now() + kStatusPeriod;
    if (own.last_command != 0 && !answers_.contains(own.last_command)) {
      answers_[own.last_command] = status_message_;
      answered_.push_back(own.last_command);
      if (answered_.size() > kAnswersKept) {
        answers_.erase(answered_.front());
        answered_.pop_front();
      }
    }
    link_->send(channels_.status, status_message_);
  }

  std::optional<Command> takeCommand() override { return commands_.take(); }
  std::optional<PoseSamples> takePoses() override { return poses_.take(); }

  uint32_t matchedReaders() const override { return static_cast<uint32_t>(reports_.count()); }
  ReaderSummary readers() const override { return reports_.summary(); }

  EncodingReport encoding() const override { return announced_.encoding(); }

  std::optional<ConflictingDaemon> conflict() const override {
    const std::lock_guard lock(mutex_);
    return Clock::now() - conflict_heard_ > kLcmSilence ? std::nullopt : conflicting_;
  }

  std::optional<OtherVersion> otherVersion() const override {
    const std::lock_guard lock(mutex_);
    return Clock::now() - other_heard_ > kLcmSilence ? std::nullopt : other_;
  }

  std::chrono::milliseconds listenTime() const override { return kLcmListenTime; }

  std::string failure() const override { return link_->failure(); }

 private:
  struct Message {
    std::string channel;
    std::vector<uint8_t> bytes;
  };

  struct Carousel {
    std::vector<Message> messages;
    /// The first so many are repeated. The others, colliders or hairs of more than kBurst chunks, are sent at
    /// once and on request only.
    size_t repeated = 0;
  };

  void receiveCommand(std::span<const uint8_t> message) {
    Command command;
    if (!fromBytes(message, command) || command.groom_id != options_.groom_id || !isSound(command)) return;
    {
      // The answer was lost: repeat it, and do not execute the command again.
      const std::lock_guard lock(mutex_);
      if (const auto answer = answers_.find(command.id); answer != answers_.end())
        return link_->send(channels_.status, answer->second);
    }
    commands_.push(std::move(command));
  }

  void receivePoses(std::span<const uint8_t> message) {
    PoseSamples samples;
    if (fromBytes(message, samples)) poses_.push(std::move(samples));
  }

  void receiveReport(std::span<const uint8_t> message) {
    ReaderReport report;
    if (const auto other = versionOfMessage(message, false)) return note(*other);
    if (!fromBytes(message, report) || report.groom_id != options_.groom_id || !isSound(report)) return;
    reports_.add(report);
    if (report.wants == 0) return;
    const std::lock_guard lock(mutex_);
    is_asked_ = true;
    repeat_due_ = std::min(repeat_due_, repeated_ + kRepeatAtMost);
    wake_.notify_all();
  }

  void note(const OtherVersion& other) {
    const std::lock_guard lock(mutex_);
    if (!other_) spdlog::warn(warningOf(other, options_.groom_id, "LCM " + options_.url));
    other_ = other;
    other_heard_ = Clock::now();
  }

  void receiveStatus(std::span<const uint8_t> message) {
    Status status;
    if (!fromBytes(message, status) || status.groom_id != options_.groom_id ||
        status.session == options_.session)
      return;
    const std::lock_guard lock(mutex_);
    conflicting_ = ConflictingDaemon::of(status);
    conflict_heard_ = Clock::now();
    // A starting daemon listens for this one: answer it once with a status.
    if (conflicting_->casts || std::exchange(answered_session_, status.session) == status.session) return;
    status_due_ = conflict_heard_;
    wake_.notify_all();
  }

  void serve() {
    std::unique_lock lock(mutex_);
    while (!stop_) {
      const Clock::time_point now = Clock::now();
      if (now >= status_due_) {
        link_->send(channels_.status, status_message_);
        status_due_ = now + kStatusPeriod;
      }
      if (carousel_ && now >= repeat_due_) {
        if (next_colliders_) encodeColliders(lock);
        sendDescription(lock);
      } else {
        wake_.wait_until(lock, carousel_ ? std::min(status_due_, repeat_due_) : status_due_);
      }
    }
  }

  void encodeColliders(std::unique_lock<std::mutex>& lock) {
    const ColliderSet colliders = *std::exchange(next_colliders_, std::nullopt);
    lock.unlock();
    std::vector<Message> messages = messagesOf(channels_.colliders, splitColliders(colliders));
    lock.lock();
    colliders_ = std::move(messages);
    if (!description_.empty()) rebuildCarousel();
  }

  template <class Chunk>
  static std::vector<Message> messagesOf(const std::string& channel, const std::vector<Chunk>& chunks) {
    std::vector<Message> messages;
    for (const Chunk& chunk : chunks) {
      messages.push_back({channel, {}});
      toBytes(chunk, messages.back().bytes);
    }
    return messages;
  }

  static void append(std::vector<Message>& to, const std::vector<Message>& from) {
    to.insert(to.end(), from.begin(), from.end());
  }

  /// Schedules the changed description to be sent next.
  void rebuildCarousel() {
    auto carousel = std::make_shared<Carousel>();
    carousel->messages = description_;
    for (const bool is_repeated : {true, false}) {
      for (const std::vector<Message>* const part : {&colliders_, &hairs_})
        if ((part->size() <= kBurst) == is_repeated) append(carousel->messages, *part);
      if (is_repeated) carousel->repeated = carousel->messages.size();
    }
    carousel_ = std::move(carousel);
    is_asked_ = true;
  }

  /// Sends the description once; a newer one interrupts it.
  void sendDescription(std::unique_lock<std::mutex>& lock) {
    const auto carousel = carousel_;
    const size_t count = std::exchange(is_asked_, false) ? carousel->messages.size() : carousel->repeated;
    for (size_t i = 0; i < count && carousel == carousel_ && !stop_; ++i) {
      const Message& message = carousel->messages[i];
      lock.unlock();
      link_->send(message.channel, message.bytes);
      if (i % kBurst == kBurst - 1) std::this_thread::sleep_for(kBetweenBursts);
      lock.lock();
    }
    repeated_ = Clock::now();
    const bool has_changed = carousel != carousel_ || next_colliders_;
    repeat_due_ = has_changed ? repeated_ : repeated_ + (is_asked_ ? kRepeatAtMost : kCarouselPeriod);
  }

  const LcmOptions options_;
  const LcmChannels channels_;
  CommandQueue commands_;
  PoseInbox poses_;
  AnnouncedGroom announced_;
  std::vector<uint8_t> guide_message_;
  ReaderReports reports_;

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  std::vector<Message> description_, colliders_, hairs_;
  std::optional<ColliderSet> next_colliders_;  // replaces colliders_ soon
  std::shared_ptr<const Carousel> carousel_;   // of all three
  Clock::time_point repeat_due_ = Clock::time_point::max(), repeated_{}, status_due_{};
  std::vector<uint8_t> status_message_;
  std::map<uint64_t, std::vector<uint8_t>> answers_;  // by command: the status that answered it
  std::deque<uint64_t> answered_;                     // keys of answers_, oldest first
  std::optional<ConflictingDaemon> conflicting_;      // the last one heard
  Clock::time_point conflict_heard_{};
  std::optional<OtherVersion> other_;  // a reader's, the last one heard
  Clock::time_point other_heard_{};
  uint64_t answered_session_ = 0;  // session of a starting daemon that was answered
  bool is_asked_ = false, stop_ = false;

  std::shared_ptr<MessageLink> link_;
  std::vector<MessageLink::Subscription> subscriptions_;
  std::thread service_;
};

void checkPublisher(const LcmOptions& options) {
  checkGroomId(options.groom_id, "LCM options");
  if (options.session == 0)
    throw Error("a publisher needs a session", "LCM options", "choose one at random, not 0");
  checkCodecOptions(options.codec, "LCM options");
  if (options.codec.codec == Codec::kTemporal && options.url.starts_with("udpm://")) {
    throw Error("the temporal codec needs a link that loses nothing", options.url,
                "choose another --codec, or --transport dds");
  }
}

}  // namespace

void checkOneEnd(const LcmOptions& options) {
  if (options.url.starts_with("memq://"))
    throw Error("memq:// has both its ends in one LCM instance", "LCM options",
                "make them with makeLcmChannel()");
}

bool isWrittenLog(const std::string& url) {
  return isLcmLog(url) &&
         (url.find("mode=w") != std::string::npos || url.find("mode=a") != std::string::npos);
}

bool lcmAvailable(std::string* reason) {
  if (reason) reason->clear();
  return true;
}

std::unique_ptr<Publisher> makeLcmPublisher(std::shared_ptr<MessageLink> link, const LcmOptions& options) {
  checkPublisher(options);
  return std::make_unique<LcmPublisher>(std::move(link), options);
}

std::unique_ptr<Publisher> makeLcmPublisher(const LcmOptions& options) {
  checkPublisher(options);
  checkOneEnd(options);
  if (isLcmLog(options.url) && !isWrittenLog(options.url))
    throw Error("a publisher writes its log", options.url, "give mode=w");
  return makeLcmPublisher(std::make_shared<LcmLink>(options.url), options);
}

std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeLcmChannel(const LcmOptions& options) {
  checkPublisher(options);
  const auto link = std::make_shared<LcmLink>(options.url);
  return {makeLcmPublisher(link, options), makeLcmSubscriber(link, options)};
}

}  // namespace strandcast
