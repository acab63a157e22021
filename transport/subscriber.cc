#include "transport/subscriber.h"

#include <thread>

#include "core/error.h"
#include "transport/chunks.h"

namespace strandcast {
namespace {
constexpr std::chrono::milliseconds kSendAgain{500}, kLook{20};
}

std::optional<std::string> ask(Subscriber& subscriber, const Command& command,
                               const std::function<bool()>& gives_up) {
  checkCommand(command, command.groom_id);  // an invalid command is not repeated
  for (;;) {
    try {
      subscriber.send(command, gives_up);
      const auto end = std::chrono::steady_clock::now() + kSendAgain;
      do {
        const std::optional<std::string> answer = subscriber.waitForAnswer(command.id, kLook);
        if (answer || gives_up()) return answer;
      } while (std::chrono::steady_clock::now() < end);
    } catch (const Error&) {
      if (!subscriber.mayCommand() || gives_up()) throw;
    }
    std::this_thread::sleep_for(kLook);  // send() may throw at once
  }
}

}  // namespace strandcast
