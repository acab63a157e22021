#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "transport/chunks.h"

namespace strandcast {

/// A reader's sign of life, as in strandcast.lcm.
struct ReaderSign {
  uint64_t reader = 0;
  uint32_t groom_id = 0;
  bool wants_groom = false;
};

/// Messages of strandcast.lcm, with their fingerprints, to and from bytes. Not by lcm-gen's code, whose
/// decoder makes room for whatever length it is told; the tests hold both to be the same on sound messages.
void toBytes(const GroomChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const BodyChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const ColliderChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const GuideChunk& chunk, std::vector<uint8_t>& bytes);
void toBytes(const Command& command, std::vector<uint8_t>& bytes);
void toBytes(const ReaderSign& sign, std::vector<uint8_t>& bytes);
void toBytes(const Status& status, std::vector<uint8_t>& bytes);

/// False on another type, another version, or damage; the message is arbitrary then. What the fields say is
/// unchecked.
bool fromBytes(std::span<const uint8_t> bytes, GroomChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, BodyChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, ColliderChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, GuideChunk& chunk);
bool fromBytes(std::span<const uint8_t> bytes, Command& command);
bool fromBytes(std::span<const uint8_t> bytes, ReaderSign& sign);
bool fromBytes(std::span<const uint8_t> bytes, Status& status);

}  // namespace strandcast
