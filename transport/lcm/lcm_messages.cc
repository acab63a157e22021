#include "transport/lcm/lcm_messages.h"

#include "strandcast_v6/body_chunk_t.hpp"
#include "strandcast_v6/collider_chunk_t.hpp"
#include "strandcast_v6/command_t.hpp"
#include "strandcast_v6/groom_chunk_t.hpp"
#include "strandcast_v6/guide_chunk_t.hpp"
#include "strandcast_v6/reader_t.hpp"
#include "strandcast_v6/status_t.hpp"
#include "transport/message_bytes.h"

namespace strandcast {
namespace {

template <class Stream>
void messageFields(Stream& s, auto& m, std::type_identity<ReaderHeartbeat>) {
  s.number(m.reader);
  s.number(m.groom_id);
  s.flag(m.wants_groom);
}

/// The fingerprint that lcm-gen computes from the schema.
template <class Generated>
int64_t fingerprint() {
  return Generated::getHash();
}

template <class Generated, class Message>
void write(const Message& message, std::vector<uint8_t>& bytes) {
  MessageWriter writer(bytes);
  writer.number(fingerprint<Generated>());
  messageFields(writer, message, std::type_identity<Message>());
}

template <class Generated, class Message>
bool read(std::span<const uint8_t> bytes, Message& message) {
  MessageReader reader(bytes);
  int64_t type = 0;
  reader.number(type);
  if (!reader.ok() || type != fingerprint<Generated>()) return false;
  messageFields(reader, message, std::type_identity<Message>());
  return reader.atEnd();
}

/// Cuts the texts of a message to the wire's limit.
void shortenTexts(Status& s) {
  for (std::string* text : {&s.groom_name, &s.backend, &s.device, &s.encoding.codec, &s.last_command_error})
    *text = shortened(*text);
}

}  // namespace

void toBytes(const GroomChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v6::groom_chunk_t>(chunk, bytes);
}
void toBytes(const BodyChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v6::body_chunk_t>(chunk, bytes);
}
void toBytes(const ColliderChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v6::collider_chunk_t>(chunk, bytes);
}
void toBytes(const GuideChunk& chunk, std::vector<uint8_t>& bytes) {
  write<strandcast_v6::guide_chunk_t>(chunk, bytes);
}
void toBytes(const Command& command, std::vector<uint8_t>& bytes) {
  write<strandcast_v6::command_t>(command, bytes);
}
void toBytes(const ReaderHeartbeat& heartbeat, std::vector<uint8_t>& bytes) {
  write<strandcast_v6::reader_t>(heartbeat, bytes);
}
void toBytes(const Status& status, std::vector<uint8_t>& bytes) {
  Status own = status;
  shortenTexts(own);
  write<strandcast_v6::status_t>(own, bytes);
}

bool fromBytes(std::span<const uint8_t> bytes, GroomChunk& chunk) {
  return read<strandcast_v6::groom_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, BodyChunk& chunk) {
  return read<strandcast_v6::body_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, ColliderChunk& chunk) {
  return read<strandcast_v6::collider_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, GuideChunk& chunk) {
  return read<strandcast_v6::guide_chunk_t>(bytes, chunk);
}
bool fromBytes(std::span<const uint8_t> bytes, Command& command) {
  return read<strandcast_v6::command_t>(bytes, command);
}
bool fromBytes(std::span<const uint8_t> bytes, ReaderHeartbeat& heartbeat) {
  return read<strandcast_v6::reader_t>(bytes, heartbeat);
}
bool fromBytes(std::span<const uint8_t> bytes, Status& status) {
  if (!read<strandcast_v6::status_t>(bytes, status)) return false;
  shortenTexts(status);
  return true;
}

}  // namespace strandcast
