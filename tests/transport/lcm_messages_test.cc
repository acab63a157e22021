#include "transport/lcm/lcm_messages.h"

#include <gtest/gtest.h>

#include <random>

#include "bound_hairs.h"
#include "message_fuzz.h"
#include "moving_hair.h"
#include "strandcast_v7/body_chunk_t.hpp"
#include "strandcast_v7/collider_chunk_t.hpp"
#include "strandcast_v7/command_t.hpp"
#include "strandcast_v7/groom_chunk_t.hpp"
#include "strandcast_v7/guide_chunk_t.hpp"
#include "strandcast_v7/hair_chunk_t.hpp"
#include "strandcast_v7/pose_samples_t.hpp"
#include "strandcast_v7/reader_t.hpp"
#include "strandcast_v7/status_t.hpp"
#include "transport/chunks.h"
#include "transport/codec/hair_codec.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

/// Encodes with toBytes(), decodes and encodes with lcm-gen's code, and decodes that with fromBytes().
template <class Generated, class Message>
Generated throughGenerated(const Message& message, Message& back) {
  std::vector<uint8_t> bytes;
  toBytes(message, bytes);
  EXPECT_LT(bytes.size(), 65499u) << "does not fit LCM's largest datagram";
  Generated generated;
  EXPECT_EQ(generated.decode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  std::vector<uint8_t> again(static_cast<size_t>(generated.getEncodedSize()));
  EXPECT_EQ(generated.encode(again.data(), 0, static_cast<int>(again.size())),
            static_cast<int>(again.size()));
  EXPECT_EQ(bytes, again);
  EXPECT_EQ(lcmFingerprint<Message>(), static_cast<uint64_t>(Generated::getHash()));
  EXPECT_TRUE(fromBytes(again, back));
  return generated;
}

TEST(LcmMessages, AreThoseOfTheSchema) {
  const GroomDescription groom = sampleGroom(1500, [](size_t s) { return 2 + s % 20; });
  for (const GroomChunk& chunk : splitGroom(groom)) {
    GroomChunk back;
    const auto wire = throughGenerated<strandcast_v7::groom_chunk_t>(chunk, back);
    EXPECT_EQ(wire.name, "sample");
    EXPECT_EQ(wire.first_vertex, static_cast<int32_t>(chunk.first_vertex));
    EXPECT_EQ(wire.positions, chunk.positions);
    EXPECT_EQ(back.positions, chunk.positions);
    EXPECT_EQ(back.parts, chunk.parts);
    EXPECT_EQ(back.uvs, chunk.uvs);
    EXPECT_EQ(back.arrays, chunk.arrays);
  }
  const StrandSet guides = hairGroom(300, [](size_t s) { return 2 + s % 20; }).guides;
  for (const HairChunk& chunk : encodeHairs(boundHairs(guides, 2000), guides, kDefaultHairError)) {
    HairChunk back;
    const auto wire = throughGenerated<strandcast_v7::hair_chunk_t>(chunk, back);
    EXPECT_EQ(wire.vertex_count, static_cast<int32_t>(chunk.vertex_count));
    EXPECT_EQ(back.uv_box, chunk.uv_box);
    EXPECT_EQ(back.radius_step, chunk.radius_step);
    EXPECT_EQ(back.payload, chunk.payload);
  }
  for (const BodyChunk& chunk : splitBody(sampleBody(60))) {
    BodyChunk back;
    const auto wire = throughGenerated<strandcast_v7::body_chunk_t>(chunk, back);
    EXPECT_EQ(wire.total_triangles, static_cast<int32_t>(chunk.total_triangles));
    EXPECT_EQ(back.triangles, chunk.triangles);
    EXPECT_EQ(back.head_weights, chunk.head_weights);
  }
  for (const ColliderChunk& chunk : splitColliders(sampleColliders())) {
    ColliderChunk back;
    const auto wire = throughGenerated<strandcast_v7::collider_chunk_t>(chunk, back);
    EXPECT_EQ(wire.total_words, static_cast<int32_t>(chunk.total_words));
    EXPECT_EQ(back.numbers, chunk.numbers);
    EXPECT_EQ(back.kinds, chunk.kinds);
    EXPECT_EQ(back.words, chunk.words);
  }
  GuideFrame frame = sampleFrame(groom, 5);
  frame.publish_time = 0xfedcba9876543210;
  for (const GuideChunk& chunk : splitFrame(groom, frame)) {
    GuideChunk back;
    const auto wire = throughGenerated<strandcast_v7::guide_chunk_t>(chunk, back);
    EXPECT_EQ(static_cast<uint64_t>(wire.publish_time), chunk.publish_time);
    EXPECT_EQ(wire.head_rotation[1], 0.8f);
    EXPECT_EQ(back.head_rotation, chunk.head_rotation);
    EXPECT_EQ(back.simulation_time, chunk.simulation_time);
    EXPECT_EQ(back.payload, chunk.payload);
    EXPECT_EQ(back.collider_poses, chunk.collider_poses);
    EXPECT_EQ(wire.writers, 1);
  }
  Command command{3, 77, CommandKind::kHeadMotion, "nod", {1.5, -2}}, command_back;
  EXPECT_EQ(throughGenerated<strandcast_v7::command_t>(command, command_back).values, command.values);
  EXPECT_EQ(command_back.name, "nod");
  EXPECT_EQ(command_back.kind, CommandKind::kHeadMotion);
  PoseSamples poses = samplePoses(), poses_back;
  poses.scales = {1, 2, 3};
  const auto pose_wire = throughGenerated<strandcast_v7::pose_samples_t>(poses, poses_back);
  EXPECT_EQ(pose_wire.names, poses.names);
  EXPECT_EQ(static_cast<uint64_t>(pose_wire.time), poses.time);
  EXPECT_EQ(poses_back.ages, poses.ages);
  EXPECT_EQ(poses_back.poses, poses.poses);
  EXPECT_EQ(poses_back.scales, poses.scales);
  EXPECT_EQ(poses_back.weights, poses.weights);
  ReaderReport report, report_back;
  report.reader = 99;
  report.wants = ReaderReport::kColliders;
  report.pixels = 640;
  EXPECT_EQ(throughGenerated<strandcast_v7::reader_t>(report, report_back).pixels, 640);
  EXPECT_EQ(report_back.wants, ReaderReport::kColliders);
  Status status, status_back;
  status.session = 5;
  status.encoding = {"delta16", 1e-5, 9e-6, 1234, 7};
  status.groom_name = "bob";
  status.last_command_error = std::string(400, 'x');
  status.parameters = parameterTable(Parameters());
  status.metrics = {"rate budget_ms", {60, 16}};
  const auto wire = throughGenerated<strandcast_v7::status_t>(status, status_back);
  EXPECT_EQ(wire.frame_bytes, 1234);
  EXPECT_EQ(wire.last_command_error.size(), kMaxTextBytes);
  EXPECT_EQ(status_back.encoding.codec, "delta16");
  EXPECT_EQ(status_back.groom_name, "bob");
  EXPECT_EQ(wire.parameter_names, status.parameters.names);
  EXPECT_EQ(wire.parameter_components, status.parameters.components);
  EXPECT_EQ(wire.parameter_values, status.parameters.values);
  EXPECT_EQ(namedValues(status_back.parameters), namedValues(status.parameters));
  EXPECT_EQ(wire.metric_values, status.metrics.values);
  EXPECT_EQ(status_back.metrics.names, status.metrics.names);
}

TEST(LcmMessages, ChannelsOfEveryGroomHaveNamesThatLcmTakes) {
  constexpr size_t kLongest = 63;  // LCM_MAX_CHANNEL_NAME_LENGTH; longer ones are not sent
  for (const uint32_t groom : {0u, 1u, 1000000u, 0xFFFFFFFFu}) {
    const LcmChannels channels(groom);
    for (const std::string& name :
         {channels.groom, channels.bodies, channels.hairs, channels.colliders, channels.guides, channels.pose,
          channels.command, channels.reader, channels.status})
      EXPECT_LE(name.size(), kLongest) << name;
  }
}

TEST(LcmMessages, DamagedOnesAreRefusedOrHarmless) {
  std::vector<std::vector<uint8_t>> sound;
  for (const FuzzSeeds& seeds : messageSeeds())
    sound.insert(sound.end(), seeds.inputs.begin(), seeds.inputs.end());
  std::mt19937 random(4);
  size_t read = 0;
  for (const auto& message : sound) {
    ASSERT_EQ(fuzzMessages(message.data(), message.size()), 1u);
    for (int run = 0; run < 3000; ++run) {
      std::vector<uint8_t> bytes = message;
      if (run % 4 == 0) bytes.resize(random() % bytes.size());
      for (uint32_t i = 0; !bytes.empty() && i < 1 + random() % 3; ++i) {
        // The fingerprint mostly stays intact, so that damage reaches the fields.
        const size_t first = run % 16 == 0 ? 0 : std::min<size_t>(8, bytes.size() - 1);
        bytes[first + random() % (bytes.size() - first)] = static_cast<uint8_t>(random());
      }
      read += fuzzMessages(bytes.data(), bytes.size());
    }
    std::vector<uint8_t> longer = message;
    longer.push_back(0);
    EXPECT_EQ(fuzzMessages(longer.data(), longer.size()), 0u) << "a byte too many";
  }
  EXPECT_GT(read, 1000u) << "damage no longer reaches past the first check";
}

}  // namespace
}  // namespace strandcast
