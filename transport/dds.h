#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/codec/codec.h"
#include "transport/publisher.h"
#include "transport/subscriber.h"

namespace strandcast {

struct DdsOptions {
  int domain = 0;  ///< 0 to 232
  uint32_t groom_id = 1;
  uint64_t session = 0;  ///< publisher only: of this start, not 0
  CodecOptions codec;    ///< publisher only
  /// Publisher only: one of several that share the groom. The strongest of those alive casts; the others take
  /// commands, simulate and stay silent, until within half a second of its end it is their turn.
  std::optional<uint32_t> claim = {};
};

/// Whether this build has DDS, and why not.
bool ddsAvailable(std::string* reason = nullptr);

/// Fast DDS over UDPv4. A groom id is a DDS partition ("groom1"), so that a machine receives the frames of
/// the grooms it asked for and no others; statuses go to everyone in the domain. Listening ports: 7400 + 250
/// * domain (UDP multicast 239.255.0.1, discovery) and those following it. Frames of 1 MB or less need
/// net.core.rmem_max >= 4194304 on the reader's machine to survive bursts without repair.
///
/// Both throw Error when an option is out of range or the participant cannot be made: domain out of range, no
/// network interface, a discovery port held by a program that does not share it.
std::unique_ptr<Publisher> makeDdsPublisher(const DdsOptions& options);
std::unique_ptr<Subscriber> makeDdsSubscriber(const DdsOptions& options);

}  // namespace strandcast
