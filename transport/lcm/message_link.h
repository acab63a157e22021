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

/// Carries messages on named channels: each arrives whole or not at all, possibly late or twice. The LCM ends
/// use it; tests substitute a link that loses messages.
class MessageLink {
 public:
  using Handler = std::function<void(std::span<const uint8_t> message)>;
  /// A handler that can be closed: it is not called after the last Listening to it is destroyed.
  class Ear {
   public:
    explicit Ear(Handler handler) : handler_(std::move(handler)) {}
    void hear(std::span<const uint8_t> message) {
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
  /// The handlers run in a thread of the link, one message of any channel at a time, until their Listenings
  /// are destroyed. No handler runs before all are registered: a log file is read from then on, once. Throws
  /// Error.
  [[nodiscard]] virtual std::vector<Listening> listen(std::vector<Channel> channels) = 0;
  /// Thread-safe, also within a handler. Neither waits for readers nor throws.
  virtual void send(const std::string& channel, std::span<const uint8_t> message) = 0;
  /// Why messages could not be stored; empty where nothing failed.
  virtual std::string failure() const { return {}; }
};

}  // namespace strandcast
