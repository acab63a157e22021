// The types that fastddsgen generates from idl/strandcast.idl: conversion, and guarded deserialisation.
#pragma once
#include <exception>

#include "idl/strandcast.h"
#include "idl/strandcastPubSubTypes.h"
#include "transport/chunks.h"
#include "transport/show.h"

namespace strandcast {

/// Convert between the project's structs and the generated types. Large arrays are swapped, not copied, so
/// that both sides reuse their memory. `fromWire` does not check what was received; it cuts strings to
/// kMaxTextBytes.
void toWire(GroomChunk& chunk, v6::GroomChunk& wire);
void fromWire(v6::GroomChunk& wire, GroomChunk& chunk);
void toWire(BodyChunk& chunk, v6::BodyChunk& wire);
void fromWire(v6::BodyChunk& wire, BodyChunk& chunk);
void toWire(ColliderChunk& chunk, v6::ColliderChunk& wire);
void fromWire(v6::ColliderChunk& wire, ColliderChunk& chunk);
void toWire(GuideChunk& chunk, v6::GuideChunk& wire);
void fromWire(v6::GuideChunk& wire, GuideChunk& chunk);
void toWire(const Command& command, v6::Command& wire);
void fromWire(const v6::Command& wire, Command& command);
void toWire(ShowChunk& chunk, v6::ShowChunk& wire);
void fromWire(v6::ShowChunk& wire, ShowChunk& chunk);
void toWire(const Status& status, v6::Status& wire);
void fromWire(const v6::Status& wire, Status& status);

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
