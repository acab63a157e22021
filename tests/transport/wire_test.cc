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

namespace strandcast {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

template <class Message>
std::vector<uint8_t> serialized(Message& message) {
  WireType<Message> type;
  SerializedPayload_t payload(type.getSerializedSizeProvider(&message)());
  EXPECT_TRUE(type.serialize(&message, &payload));
  return {payload.data, payload.data + payload.length};
}

template <class Message>
bool deserialize(const std::vector<uint8_t>& bytes, Message& message) {
  WireType<Message> type;
  SerializedPayload_t payload(static_cast<uint32_t>(bytes.size() + 1));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<uint32_t>(bytes.size());
  return type.deserialize(&payload, &message);
}

/// Serialises every chunk, damages it in `runs` seeded ways, and feeds what still deserialises to the
/// assembler.
template <class Chunk, class Assembler>
void damageBytes(std::vector<Chunk> chunks, Assembler make, int runs) {
  std::mt19937 random(5);
  size_t readable = 0;
  for (Chunk& chunk : chunks) {
    const std::vector<uint8_t> sound = serialized(chunk);
    EXPECT_LT(sound.size(), 64u * 1024) << "does not fit a datagram";
    for (int run = 0; run < runs; ++run) {
      auto assembler = make();
      std::vector<uint8_t> bytes = sound;
      if (run % 4 == 0) bytes.resize(random() % bytes.size());
      const size_t head = std::min<size_t>(bytes.size(), run % 2 != 0 ? 160 : bytes.size());
      for (uint32_t i = 0; head > 0 && i < 1 + random() % 4; ++i)
        bytes[random() % head] = static_cast<uint8_t>(random());
      Chunk damaged;
      if (!deserialize(bytes, damaged)) continue;
      ++readable;
      assembler.add(std::move(damaged));
    }
  }
  EXPECT_GT(readable, 0u);
}

/// The bytes of the key of a sample's instance, in hexadecimal.
template <class Message>
std::string keyOf(Message& message, bool force_md5) {
  eprosima::fastrtps::rtps::InstanceHandle_t handle;
  EXPECT_TRUE(WireType<Message>().getKey(&message, &handle, force_md5));
  std::array<uint8_t, 16> bytes;
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = handle.value[i];
  return hexadecimal(bytes);
}

template <class Message>
void expectGolden() {
  for (const bool is_empty : {false, true}) {
    const std::string name = kWireName<Message>, suffix = is_empty ? " empty" : "";
    Message message = is_empty ? Message() : fullMessage<Message>(), back;
    const std::vector<uint8_t> bytes = serialized(message);
    EXPECT_EQ(hexadecimal(bytes), goldenBytes(name, "cdr" + suffix)) << name << suffix;
    EXPECT_EQ(keyOf(message, false), goldenBytes(name, "key" + suffix)) << name << suffix;
    ASSERT_TRUE(deserialize(bytes, back));
    EXPECT_EQ(serialized(back), bytes);
  }
}

TEST(Wire, BytesAndKeysAreTheGoldenOnes) {
  expectGolden<GroomChunk>();
  expectGolden<HairChunk>();
  expectGolden<BodyChunk>();
  expectGolden<ColliderChunk>();
  expectGolden<GuideChunk>();
  expectGolden<Command>();
  expectGolden<Status>();
  expectGolden<ShowChunk>();
  expectGolden<ReaderReport>();
  expectGolden<Claim>();
}

TEST(Wire, WithSecurityAKeyIsTheMd5OfItsBytes) {
  GroomChunk chunk;
  chunk.groom_id = 0x01020304;
  chunk.chunk_index = 5;
  EXPECT_EQ(keyOf(chunk, false), "01020304000000050000000000000000");
  EXPECT_EQ(keyOf(chunk, true), "65df6db9d9b7e97c6b8eadda894e14a0") << "of the first 8 bytes";
  Command command;
  command.groom_id = 7;
  EXPECT_EQ(keyOf(command, true), "679e19234b295ee432a3920c30fda6ac") << "of 4 bytes";
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
    const std::vector<uint8_t> bytes = serialized(chunk);
    EXPECT_LT(bytes.size(), 64u * 1024) << "does not fit a datagram";
    GroomChunk received;
    ASSERT_TRUE(deserialize(bytes, received));
    result = assembler.add(std::move(received));
  }
  ASSERT_TRUE(result);
  EXPECT_EQ(result->guides.positions, groom.guides.positions);
  EXPECT_EQ(result->guides.uvs, groom.guides.uvs);
}

TEST(Wire, DamagedBytesAreRefusedOrCaught) {
  const auto groom = std::make_shared<GroomDescription>(uniformGroom(500, 16));
  damageBytes(
      splitGroom(*groom), [] { return GroomAssembler(1); }, 300);
  damageBytes(
      splitBody(sampleBody(60)), [] { return BodyAssembler(1); }, 300);
  const GuideFrame frame = sampleFrame(*groom, 1);
  const auto make = [&] {
    GuideAssembler assembler;
    assembler.setGroom(groom);
    return assembler;
  };
  for (const CodecInfo& info : codecList()) damageBytes(splitFrame(*groom, frame, {info.codec}), make, 300);
}

TEST(Wire, ADamagedStatusIsRefusedOrItsParametersAreCounted) {
  Status status;
  status.groom_name = "bob";
  status.parameters = parameterTable(Parameters());
  const std::vector<uint8_t> sound = serialized(status);
  Status back;
  ASSERT_TRUE(deserialize(sound, back));
  EXPECT_TRUE(isSound(back.parameters));
  EXPECT_EQ(namedValues(back.parameters), namedValues(status.parameters));

  std::mt19937 random(6);
  int readable = 0, fit = 0;
  for (int run = 0; run < 4000; ++run) {
    std::vector<uint8_t> bytes = sound;
    if (run % 4 == 0) bytes.resize(random() % bytes.size());
    for (uint32_t i = 0; !bytes.empty() && i < 1 + random() % 3; ++i)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    if (!deserialize(bytes, back)) continue;
    ++readable;
    if (!isSound(back.parameters)) continue;
    ++fit;
    EXPECT_EQ(namedValues(back.parameters).size(), back.parameters.components.size());
  }
  EXPECT_GT(fit, 0);
  EXPECT_LT(fit, readable) << "damage is found";
}

}  // namespace
}  // namespace strandcast
