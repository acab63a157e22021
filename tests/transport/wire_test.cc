#include <fastdds/rtps/common/SerializedPayload.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>

#include "golden_messages.h"
#include "sample_messages.h"
#include "transport/assembler.h"
#include "transport/chunks.h"
#include "transport/dds_type.h"
#include "transport/parameter_table.h"
#include "transport/wire_types.h"

namespace strandcast {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

template <class PubSubType, class Wire>
std::vector<uint8_t> serialized(Wire& sample) {
  PubSubType type;
  SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  EXPECT_TRUE(type.serialize(&sample, &payload));
  return {payload.data, payload.data + payload.length};
}

template <class PubSubType, class Wire>
bool deserialize(const std::vector<uint8_t>& bytes, Wire& sample) {
  PubSubType type;
  SerializedPayload_t payload(static_cast<uint32_t>(bytes.size() + 1));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<uint32_t>(bytes.size());
  return type.deserialize(&payload, &sample);
}

/// Serialises every chunk, damages it in `runs` seeded ways, and feeds what still deserialises to the
/// assembler.
template <class PubSubType, class Wire, class Chunk, class Assembler>
void damageBytes(std::vector<Chunk> chunks, Assembler make, int runs) {
  std::mt19937 random(5);
  size_t readable = 0;
  for (Chunk& chunk : chunks) {
    Wire wire;
    toWire(chunk, wire);
    const std::vector<uint8_t> sound = serialized<PubSubType>(wire);
    EXPECT_LT(sound.size(), 64u * 1024) << "does not fit a datagram";
    for (int run = 0; run < runs; ++run) {
      auto assembler = make();
      std::vector<uint8_t> bytes = sound;
      if (run % 4 == 0) bytes.resize(random() % bytes.size());
      const size_t head = std::min<size_t>(bytes.size(), run % 2 != 0 ? 160 : bytes.size());
      for (uint32_t i = 0; head > 0 && i < 1 + random() % 4; ++i)
        bytes[random() % head] = static_cast<uint8_t>(random());
      Wire damaged;
      if (!deserialize<PubSubType>(bytes, damaged)) continue;
      ++readable;
      Chunk received;
      fromWire(damaged, received);
      assembler.add(std::move(received));
    }
  }
  EXPECT_GT(readable, 0u);
}

/// The bytes of the key of a sample's instance, in hexadecimal.
template <class Type, class Sample>
std::string keyOf(Sample& sample, bool force_md5) {
  eprosima::fastrtps::rtps::InstanceHandle_t handle;
  EXPECT_TRUE(Type().getKey(&sample, &handle, force_md5));
  std::array<uint8_t, 16> bytes;
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = handle.value[i];
  return hexadecimal(bytes);
}

/// Expects the golden bytes and keys of the generated type and of WireType, and that each reads the other.
template <class PubSubType, class Wire, class Message>
void expectGolden(const std::string& suffix, Message message, Wire wire) {
  using Type = WireType<Message>;
  const std::string name = kWireName<Message>;
  EXPECT_STREQ(Type().getName(), PubSubType().getName());
  const std::vector<uint8_t> bytes = serialized<PubSubType>(wire);
  EXPECT_EQ(hexadecimal(bytes), goldenBytes(name, "cdr" + suffix)) << name << suffix;
  EXPECT_EQ(serialized<Type>(message), bytes) << name << suffix;
  for (const bool force_md5 : {false, true})
    EXPECT_EQ(keyOf<Type>(message, force_md5), keyOf<PubSubType>(wire, force_md5)) << name << suffix;
  EXPECT_EQ(keyOf<Type>(message, false), goldenBytes(name, "key" + suffix)) << name << suffix;
  Message back;
  Wire wire_back;
  ASSERT_TRUE(deserialize<Type>(bytes, back));
  ASSERT_TRUE(deserialize<PubSubType>(bytes, wire_back));
  EXPECT_EQ(serialized<Type>(back), bytes);
  EXPECT_EQ(serialized<PubSubType>(wire_back), bytes);
}

template <class PubSubType, class Wire, class Message>
void expectGolden() {
  for (const bool is_empty : {false, true}) {
    Message message = is_empty ? Message() : fullMessage<Message>(), swapped = message;
    Wire wire;
    toWire(swapped, wire);
    expectGolden<PubSubType>(is_empty ? " empty" : "", std::move(message), std::move(wire));
  }
}

TEST(Wire, BytesAndKeysAreTheGoldenOnes) {
  expectGolden<GroomChunkType, v6::GroomChunk, GroomChunk>();
  expectGolden<BodyChunkType, v6::BodyChunk, BodyChunk>();
  expectGolden<ColliderChunkType, v6::ColliderChunk, ColliderChunk>();
  expectGolden<GuideChunkType, v6::GuideChunk, GuideChunk>();
  expectGolden<CommandType, v6::Command, Command>();
  expectGolden<StatusType, v6::Status, Status>();
  expectGolden<ShowChunkType, v6::ShowChunk, ShowChunk>();
  v6::Claim claim;
  expectGolden<ClaimType>(" empty", Claim(), claim);
  const Claim full = fullMessage<Claim>();
  claim.session(full.session);
  claim.groom_id(full.groom_id);
  expectGolden<ClaimType>("", full, claim);
}

TEST(Wire, ASampleThatDoesNotFitItsPayloadIsNotWritten) {
  Status status = fullMessage<Status>();
  WireType<Status> type;
  SerializedPayload_t payload(type.getSerializedSizeProvider(&status)() - 1);
  EXPECT_FALSE(type.serialize(&status, &payload));
}

TEST(Wire, ChunksSurviveTheWireFormat) {
  const GroomDescription groom = sampleGroom(1500, [](size_t s) { return 2 + s % 20; });
  GroomAssembler assembler(1);
  std::shared_ptr<const GroomDescription> result;
  for (GroomChunk& chunk : splitGroom(groom)) {
    v6::GroomChunk sent, received;
    toWire(chunk, sent);
    const std::vector<uint8_t> bytes = serialized<GroomChunkType>(sent);
    EXPECT_LT(bytes.size(), 64u * 1024) << "does not fit a datagram";
    ASSERT_TRUE(deserialize<GroomChunkType>(bytes, received));
    GroomChunk back;
    fromWire(received, back);
    result = assembler.add(std::move(back));
  }
  ASSERT_TRUE(result);
  EXPECT_EQ(result->guides.positions, groom.guides.positions);
  EXPECT_EQ(result->guides.uvs, groom.guides.uvs);
}

TEST(Wire, DamagedBytesAreRefusedOrCaught) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(500, 16));
  damageBytes<GroomChunkType, v6::GroomChunk>(
      splitGroom(*groom), [] { return GroomAssembler(1); }, 300);
  damageBytes<BodyChunkType, v6::BodyChunk>(
      splitBody(sampleBody(60)), [] { return BodyAssembler(1); }, 300);
  const GuideFrame frame = sampleFrame(*groom, 1);
  const auto make = [&] {
    GuideAssembler assembler;
    assembler.setGroom(groom);
    return assembler;
  };
  for (const CodecInfo& info : codecList())
    damageBytes<GuideChunkType, v6::GuideChunk>(splitFrame(*groom, frame, {info.codec}), make, 300);
}

TEST(Wire, ADamagedStatusIsRefusedOrItsParametersAreCounted) {
  Status status;
  status.groom_name = "bob";
  status.parameters = parameterTable(Parameters());
  v6::Status wire;
  toWire(status, wire);
  const std::vector<uint8_t> sound = serialized<StatusType>(wire);
  v6::Status received;
  ASSERT_TRUE(deserialize<StatusType>(sound, received));
  Status back;
  fromWire(received, back);
  EXPECT_TRUE(isSound(back.parameters));
  EXPECT_EQ(namedValues(back.parameters), namedValues(status.parameters));

  std::mt19937 random(6);
  int readable = 0, fit = 0;
  for (int run = 0; run < 4000; ++run) {
    std::vector<uint8_t> bytes = sound;
    if (run % 4 == 0) bytes.resize(random() % bytes.size());
    for (uint32_t i = 0; !bytes.empty() && i < 1 + random() % 3; ++i)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    v6::Status damaged;
    if (!deserialize<StatusType>(bytes, damaged)) continue;
    ++readable;
    fromWire(damaged, back);
    if (!isSound(back.parameters)) continue;
    ++fit;
    EXPECT_EQ(namedValues(back.parameters).size(), back.parameters.components.size());
  }
  EXPECT_GT(fit, 0);
  EXPECT_LT(fit, readable) << "damage is found";
}

}  // namespace
}  // namespace strandcast
