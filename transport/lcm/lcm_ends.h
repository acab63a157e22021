#pragma once
#include <chrono>
#include <memory>
#include <string>

#include "transport/lcm.h"
#include "transport/lcm/message_link.h"

namespace strandcast {

/// Of the other end, before it counts as gone.
inline constexpr std::chrono::milliseconds kLcmSilence{3000};

/// Both ends over any link; the options' url is not looked at.
std::unique_ptr<Publisher> makeLcmPublisher(std::shared_ptr<MessageLink> link, const LcmOptions& options);
std::unique_ptr<Subscriber> makeLcmSubscriber(std::shared_ptr<MessageLink> link, const LcmOptions& options);

/// Whether it names a log file that what is sent goes into.
bool isWrittenLog(const std::string& url);

/// Throws Error on a url both of whose ends are in one LCM instance.
void checkOneEnd(const LcmOptions& options);

}  // namespace strandcast
