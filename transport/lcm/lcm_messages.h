#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "transport/chunks.h"

namespace strandcast {

/// reader_t of strandcast.lcm: a reader announces itself.
struct ReaderHeartbeat {
  uint64_t reader = 0;
  uint32_t groom_id = 0;
  bool wants_groom = false;
};

/// Encode and decode the messages of strandcast.lcm with their fingerprints. lcm-gen's decoder is not used,
/// because it allocates whatever length a message states. Tests verify that both agree on valid messages.
void toBytes(const GroomChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const BodyChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const ColliderChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const GuideChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const Command& command, std::vector<uint8_t>& bytes);
void toBytes(const ReaderHeartbeat& heartbeat, std::vector<uint8_t>& bytes);
void toBytes(const Status& status, std::vector<uint8_t>& bytes);

/// False on another type, another version, or damage; the content of the message is unspecified then. Field
/// values are not checked.
bool fromBytes(std::span<const uint8_t> bytes, GroomChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, BodyChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, ColliderChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, GuideChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, Command& command);
bool fromBytes(std::span<const uint8_t> bytes, ReaderHeartbeat& heartbeat);
bool fromBytes(std::span<const uint8_t> bytes, Status& status);

}  // namespace strandcast
