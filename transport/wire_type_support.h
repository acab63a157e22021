#pragma once
#include <exception>

#include "idl/strandcastPubSubTypes.h"

namespace strandcast {

/// A generated type whose deserialize() fails where the generated one throws. fastddsgen's code catches only
/// running out of bytes; Fast CDR throws others, e.g. on an unknown encapsulation, and in Fast DDS's
/// receiving thread they would end the process: one bad datagram from anyone on the network.
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
