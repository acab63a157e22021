#pragma once
#include <exception>

#include "idl/strandcastPubSubTypes.h"

namespace strandcast {

/// A generated type whose deserialize() returns false where the generated one throws. fastddsgen's code
/// catches only the end of the buffer. Fast CDR throws other exceptions, e.g. on an unknown encapsulation; in
/// Fast DDS's receiving thread they would end the process, so that one bad datagram from the network would
/// do.
template <class Generated>
class GuardedType final : public Generated {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    try {
      return Generated::deserialize(payload, data);
    } catch (const std::exception&) {
      return false;
    }
  }
};

using GroomChunkType = GuardedType<v6::GroomChunkPubSubType>;
using BodyChunkType = GuardedType<v6::BodyChunkPubSubType>;
using ColliderChunkType = GuardedType<v6::ColliderChunkPubSubType>;
using GuideChunkType = GuardedType<v6::GuideChunkPubSubType>;
using CommandType = GuardedType<v6::CommandPubSubType>;
using ClaimType = GuardedType<v6::ClaimPubSubType>;
using ShowChunkType = GuardedType<v6::ShowChunkPubSubType>;
using StatusType = GuardedType<v6::StatusPubSubType>;

}  // namespace strandcast
