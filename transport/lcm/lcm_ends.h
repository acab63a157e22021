#pragma once
#include <chrono>
#include <memory>
#include <string>

#include "transport/lcm.h"
#include "transport/lcm/message_link.h"

namespace strandcast {

/// Silence after which the other end counts as gone.
inline constexpr std::chrono::milliseconds kLcmSilence{3000};

/// Both ends over any link; options.url is ignored.
std::unique_ptr<Publisher> makeLcmPublisher(std::shared_ptr<MessageLink> link, const LcmOptions& options);
std::unique_ptr<Subscriber> makeLcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options);

/// Whether the url names a log file that is written.
bool isWrittenLog(const std::string& url);

/// Throws Error on a url that requires both ends in one LCM instance.
void checkOneEnd(const LcmOptions& options);

}  // namespace strandcast
