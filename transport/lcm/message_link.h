#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace strandcast {

/// Carries messages on named channels: each arrives whole or not at all, perhaps late, perhaps twice. What
/// the LCM ends stand on; the tests put one that loses messages in its place.
class MessageLink {
 public:
  using Handler = std::function<void(std::span<const uint8_t> message)>;
  /// A handler that is called no more once all Listenings to it are gone.
  class Ear {
   public:
    explicit Ear(Handler handler) : handler_(std::move(handler)) {}
    void hear(std::span<const uint8_t> message) {
      const std::lock_guard lock(mutex_);
      if (handler_) handler_(message);
    }
    /// Waits for a call under way.
    void close() {
      const std::lock_guard lock(mutex_);
      handler_ = nullptr;
    }

   private:
    std::mutex mutex_;
    Handler handler_;
  };
  /// Not to be let go of within the handler.
  using Listening = std::shared_ptr<Ear>;
  static Listening listening(std::shared_ptr<Ear> ear) {
    Ear* const open = ear.get();
    return {open, [ear = std::move(ear)](Ear*) { ear->close(); }};
  }

  struct Channel {
    std::string name;
    Handler handler;
  };

  virtual ~MessageLink() = default;
  /// The handlers run in a thread of the link's, one message at a time of all channels, until their
  /// Listenings are gone. None runs before all can: a log file is read from then on, and only once. Throws
  /// Error.
  [[nodiscard]] virtual std::vector<Listening> listen(std::vector<Channel> channels) = 0;
  /// Thread-safe, also within a handler; neither waits for readers nor throws.
  virtual void send(const std::string& channel, std::span<const uint8_t> message) = 0;
  /// Why messages are lost that were to be kept; empty where all are, or none was to be.
  virtual std::string failure() const { return {}; }
};

}  // namespace strandcast
