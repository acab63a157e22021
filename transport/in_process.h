#pragma once
#include <memory>
#include <utility>

#include "transport/pose_sender.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"

namespace strandcast {

/// A channel within one process: the same interfaces without a network. Either end may be destroyed first.
/// Throws Error on groom id 0.
std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeInProcessChannel(uint32_t groom_id);

/// To the publisher of the channel whose other end `subscriber` is. Throws Error on an end of another kind.
std::unique_ptr<PoseSender> makeInProcessPoseSender(const Subscriber& subscriber);

}  // namespace strandcast
