#include "transport/cdr.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "golden_messages.h"
#include "message_fuzz.h"

namespace strandcast {
namespace {

template <class Message>
std::vector<uint8_t> cdrOf(const Message& message) {
  std::vector<uint8_t> bytes(writeCdr(message, {}), 0xaa);  // padding must be written
  EXPECT_EQ(writeCdr(message, bytes), bytes.size());
  return bytes;
}

/// Calls check(message, " empty" or "") with a full and an empty message of each type.
template <class Check>
void forEachMessage(const Check& check) {
  const auto both = [&]<class Message>(std::type_identity<Message>) {
    check(fullMessage<Message>(), std::string());
    check(Message(), std::string(" empty"));
  };
  both(std::type_identity<GroomChunk>());
  both(std::type_identity<HairChunk>());
  both(std::type_identity<BodyChunk>());
  both(std::type_identity<ColliderChunk>());
  both(std::type_identity<GuideChunk>());
  both(std::type_identity<Command>());
  both(std::type_identity<Status>());
  both(std::type_identity<ReaderReport>());
  both(std::type_identity<Claim>());
  both(std::type_identity<ShowChunk>());
}

TEST(Cdr, BytesAndKeysAreTheGoldenOnes) {
  forEachMessage([]<class Message>(const Message& message, const std::string& suffix) {
    const std::string name = kWireName<Message>;
    const std::vector<uint8_t> bytes = cdrOf(message);
    EXPECT_EQ(hexadecimal(bytes), goldenBytes(name, "cdr" + suffix)) << name << suffix;
    EXPECT_EQ(hexadecimal(cdrKey(message).bytes()), goldenBytes(name, "key" + suffix)) << name << suffix;
    Message back;
    ASSERT_TRUE(readCdr(std::span<const uint8_t>(bytes), back)) << name << suffix;
    EXPECT_EQ(cdrOf(back), bytes) << name << suffix;
  });
}

TEST(Cdr, OneThatWasCutIsRefused) {
  forEachMessage([]<class Message>(const Message& message, const std::string&) {
    const std::vector<uint8_t> bytes = cdrOf(message);
    for (size_t size = 0; size < bytes.size(); ++size) {
      Message back;
      EXPECT_FALSE(readCdr(std::span(bytes.data(), size), back)) << kWireName<Message> << ' ' << size;
    }
  });
}

TEST(Cdr, BytesBehindTheLastFieldDoNotCount) {
  std::vector<uint8_t> bytes = cdrOf(fullMessage<GroomChunk>());
  bytes.resize(bytes.size() + 3);
  GroomChunk back;
  EXPECT_TRUE(readCdr(std::span<const uint8_t>(bytes), back));
}

/// Counts the items of all texts and arrays. A visitor of fields().
struct ItemCounter {
  void key(const char*, const auto&) {}
  void number(const char*, const auto&) {}
  void text(const char*, const std::string& value, size_t) { items_read += value.capacity(); }
  void items(const char*, const auto&) {}
  void array(const char*, const auto& values, size_t) { items_read += values.capacity(); }
  size_t items_read = 0;
};

TEST(Cdr, HugeLengthsAreRefusedBeforeAnythingIsAllocated) {
  forEachMessage([]<class Message>(const Message& message, const std::string&) {
    const std::vector<uint8_t> sound = cdrOf(message);
    for (const uint32_t length : {std::numeric_limits<uint32_t>::max(), 0x7fffffffu, 100'000u}) {
      for (size_t at = kCdrHead; at + sizeof length <= sound.size(); at += 4) {
        std::vector<uint8_t> bytes = sound;
        std::memcpy(bytes.data() + at, &length, sizeof length);
        Message back;
        readCdr(std::span<const uint8_t>(bytes), back);
        ItemCounter counter;
        fields(counter, std::as_const(back), std::type_identity<Message>());
        EXPECT_LE(counter.items_read, bytes.size() + 200) << kWireName<Message>;  // 200: short texts
      }
    }
  });
}

TEST(Cdr, LongTextsAreCutAndLongArraysRefused) {
  Command command = fullMessage<Command>(), back;
  command.name = std::string(kMaxTextBytes + 2, 'n');
  command.values.resize(kMaxCommandValues);
  ASSERT_TRUE(readCdr(std::span<const uint8_t>(cdrOf(command)), back));
  EXPECT_EQ(back.name, std::string(kMaxTextBytes + 1, 'n'));
  EXPECT_FALSE(isSound(back)) << "it is refused, not obeyed under another name";
  EXPECT_EQ(back.values.size(), kMaxCommandValues);
  command.values.resize(kMaxCommandValues + 1);
  EXPECT_FALSE(readCdr(std::span<const uint8_t>(cdrOf(command)), back));
}

TEST(Cdr, BothByteOrdersAreReadAndNoOtherEncodings) {
  // Each line is 8 bytes behind the encapsulation.
  // clang-format off
  std::vector<uint8_t> big{0, 0, 0, 0,
                           1, 2, 3, 4, 5, 6, 7, 8,          // id
                           0, 0, 0, 9, 0, 0, 0, 7,          // groom_id, kind
                           0, 0, 0, 4, 'n', 'o', 'd', 0,    // name
                           0, 0, 0, 1, 0, 0, 0, 0,          // number of values, padding
                           0x3f, 0xf8, 0, 0, 0, 0, 0, 0};   // 1.5
  // clang-format on
  Command command;
  ASSERT_TRUE(readCdr(std::span<const uint8_t>(big), command));
  EXPECT_EQ(command.id, 0x0102030405060708u);
  EXPECT_EQ(command.groom_id, 9u);
  EXPECT_EQ(command.kind, CommandKind::kPull);
  EXPECT_EQ(command.name, "nod");
  EXPECT_EQ(command.values, std::vector<double>{1.5});
  for (const uint8_t encoding : {2, 3, 6, 7, 8, 9, 10, 11, 255}) {
    big[1] = encoding;
    EXPECT_FALSE(readCdr(std::span<const uint8_t>(big), command)) << int{encoding};
  }
  big[0] = 1;
  big[1] = 0;
  EXPECT_FALSE(readCdr(std::span<const uint8_t>(big), command));
}

TEST(Cdr, WhatDoesNotFitIsCountedAndNotWritten) {
  const Status status = fullMessage<Status>();
  std::vector<uint8_t> bytes(20, 0xaa), guard = bytes;
  EXPECT_EQ(writeCdr(status, std::span(bytes.data(), 8)), cdrOf(status).size());
  EXPECT_TRUE(std::equal(bytes.begin() + 8, bytes.end(), guard.begin() + 8));
}

TEST(Cdr, DamagedOnesAreRefusedOrHarmless) {
  std::mt19937 random(9);
  size_t read = 0;
  for (const FuzzSeeds& seeds : cdrSeeds()) {
    for (const std::vector<uint8_t>& sound : seeds.inputs) {
      ASSERT_EQ(fuzzCdr(sound.data(), sound.size()), 1u) << seeds.of;
      for (int run = 0; run < 1000; ++run) {
        std::vector<uint8_t> bytes = sound;
        if (run % 4 == 0) bytes.resize(1 + random() % (bytes.size() - 1));
        for (uint32_t i = 0; i < 1 + random() % 3; ++i)
          bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
        read += fuzzCdr(bytes.data(), bytes.size());
      }
    }
  }
  EXPECT_GT(read, 1000u) << "damage no longer reaches past the first check";
}

}  // namespace
}  // namespace strandcast
