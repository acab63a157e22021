#include "transport/subscriber.h"

#include "core/error.h"

namespace strandcast {
namespace {
constexpr std::chrono::milliseconds kSendAgain{500};
}

std::optional<std::string> ask(Subscriber& subscriber, const Command& command,
                               const std::function<bool()>& gives_up) {
  for (;;) {
    try {
      subscriber.send(command);
      const std::optional<std::string> answer = subscriber.waitForAnswer(command.id, kSendAgain);
      if (answer || gives_up()) return answer;
    } catch (const Error&) {
      if (!subscriber.mayCommand() || gives_up()) throw;
    }
  }
}

}  // namespace strandcast
