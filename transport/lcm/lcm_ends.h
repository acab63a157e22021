// Both ends of a channel over LCM, and the link and the channels that they use.
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "transport/lcm.h"

namespace strandcast {

/// Carries messages on named channels: each arrives whole or not at all, possibly late or twice. The LCM ends
/// use it; tests substitute a link that loses messages.
class MessageLink {
 public:
  using Handler = std::function<void(std::span<const uint8_t> message)>;
  /// A handler that can be closed: it is not called after the last Subscription to it is destroyed.
  class HandlerSlot {
   public:
    explicit HandlerSlot(Handler handler) : handler_(std::move(handler)) {}
    void deliver(std::span<const uint8_t> message) {
      const std::lock_guard lock(mutex_);
      if (handler_) handler_(message);
    }
    /// Waits for a call in progress.
    void close() {
      const std::lock_guard lock(mutex_);
      handler_ = nullptr;
    }

   private:
    std::mutex mutex_;
    Handler handler_;
  };
  /// Must not be destroyed within the handler.
  using Subscription = std::shared_ptr<HandlerSlot>;
  static Subscription makeSubscription(std::shared_ptr<HandlerSlot> slot) {
    HandlerSlot* const open = slot.get();
    return {open, [slot = std::move(slot)](HandlerSlot*) { slot->close(); }};
  }

  struct Channel {
    std::string name;
    Handler handler;
  };

  virtual ~MessageLink() = default;
  /// The handlers run in a thread of the link, one message of any channel at a time, until their
  /// Subscriptions are destroyed. No handler runs before all are registered: a log file is read from then on,
  /// once. Throws Error.
  [[nodiscard]] virtual std::vector<Subscription> listen(std::vector<Channel> channels) = 0;
  /// Thread-safe, also within a handler. Neither waits for readers nor throws.
  virtual void send(const std::string& channel, std::span<const uint8_t> message) = 0;
  /// Why messages could not be stored; empty where nothing failed.
  virtual std::string failure() const { return {}; }
};

/// The channels of strandcast.lcm.
struct LcmChannels {
  explicit LcmChannels(uint32_t groom_id)
      : groom("STRANDCAST_GROOM_" + std::to_string(groom_id)),
        bodies("STRANDCAST_BODIES_" + std::to_string(groom_id)),
        hairs("STRANDCAST_HAIRS_" + std::to_string(groom_id)),
        colliders("STRANDCAST_COLLIDERS_" + std::to_string(groom_id)),
        guides("STRANDCAST_GUIDES_" + std::to_string(groom_id)),
        pose(poseOf(groom_id)),
        command("STRANDCAST_COMMAND_" + std::to_string(groom_id)),
        reader("STRANDCAST_READER_" + std::to_string(groom_id)) {}
  static std::string poseOf(uint32_t groom_id) { return "STRANDCAST_POSE_" + std::to_string(groom_id); }
  const std::string groom, bodies, hairs, colliders, guides, pose, command, reader;
  const std::string status = "STRANDCAST_STATUS";
};

/// Silence after which the other end counts as gone.
inline constexpr std::chrono::milliseconds kLcmSilence{3000};

/// Both ends over any link; options.url is ignored.
std::unique_ptr<Publisher> makeLcmPublisher(std::shared_ptr<MessageLink> link, const LcmOptions& options);
std::unique_ptr<Subscriber> makeLcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options);
std::unique_ptr<PoseSender> makeLcmPoseSender(std::shared_ptr<MessageLink> link, const LcmOptions& options,
                                              const std::vector<uint32_t>& further_grooms = {});

/// Whether the url names a log file that is written.
bool isWrittenLog(const std::string& url);

/// Throws Error on a url that requires both ends in one LCM instance.
void checkOneEnd(const LcmOptions& options);

}  // namespace strandcast
