#include "message_fuzz.h"

#include <cstdlib>

#include "moving_hair.h"
#include "transport/assembler.h"
#include "transport/chunks.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/parameter_table.h"
#include "transport/show.h"

namespace strandcast {

size_t fuzzMessages(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> bytes(data, size);
  static const auto kGroom =
      std::make_shared<const GroomDescription>(hairGroom(40, [](size_t s) { return 1 + s % 20; }));
  size_t read = 0;
  GroomChunk groom;
  if (fromBytes(bytes, groom)) ++read, GroomAssembler(1).add(std::move(groom));
  BodyChunk body;
  if (fromBytes(bytes, body)) ++read, BodyAssembler(1).add(std::move(body));
  ColliderChunk colliders;
  if (fromBytes(bytes, colliders)) ++read, ColliderAssembler(1).add(std::move(colliders));
  GuideChunk guides;
  if (fromBytes(bytes, guides)) {
    ++read;
    GuideAssembler assembler(true);
    assembler.setGroom(kGroom);
    if (const auto frame = assembler.add(guides)) {
      for (const Vec3& position : frame->positions) {
        if (!position.allFinite()) std::abort();
      }
    }
  }
  Command command;
  if (fromBytes(bytes, command)) ++read, isSound(command);
  ReaderHeartbeat sign;
  if (fromBytes(bytes, sign)) ++read;
  Status status;
  if (fromBytes(bytes, status)) {
    ++read;
    if (isSound(status.parameters) &&
        namedValues(status.parameters).size() != status.parameters.components.size())
      std::abort();
  }
  if (const auto show = showOf(bytes)) {
    ++read;
    for (const Vec3& position : show->hair.positions)
      if (!position.allFinite()) std::abort();
  }
  return read;
}

std::vector<FuzzSeeds> messageSeeds() {
  const GroomDescription groom = hairGroom(40, [](size_t s) { return 1 + s % 20; });
  std::vector<FuzzSeeds> seeds;
  const auto add = [&](const char* of, const auto& message) {
    if (seeds.empty() || seeds.back().of != of) seeds.push_back({of, {}});
    toBytes(message, seeds.back().inputs.emplace_back());
  };
  add("groom", splitGroom(groom)[0]);
  add("groom", splitGroom(sampleGroom(6, [](size_t s) { return 1 + s; }))[0]);  // every array
  add("body", splitBody(sampleBody(10))[0]);
  ColliderSet few = sampleColliders();
  few.colliders[1].shapes.resize(5);  // so that one chunk holds all
  add("colliders", splitColliders(few)[0]);
  add("colliders", splitColliders(sampleColliders())[1]);
  add("guides", splitFrame(groom, [&] {
        GuideFrame frame = hairFrame(groom, 1);
        frame.colliders = {{3, Pose{}, {}}, {4, Pose{}, sampleBend(1)}};
        return frame;
      }())[0]);
  for (const CodecInfo& info : codecList())
    add("guides", splitFrame(groom, hairFrame(groom, 1), {info.codec})[0]);
  add("command", Command{1, 7, CommandKind::kSetParameter, "wind", {1, 2, 3}});
  add("command", Command{1, 8, CommandKind::kMoveWindSource, "spot", {33, 2, 0, 0.2, 0.6, 8}});
  add("command", Command{1,
                         9,
                         CommandKind::kAddColliderFile,
                         "chair arm%20chair.obj",
                         {7, 0, 0, -1, 0.5, 0, 0, 0, 1, 0.3, 0, 0.004}});
  add("status", Status());
  Status telling;
  telling.session = 5;
  telling.groom_name = "bob";
  telling.parameters = parameterTable(Parameters());
  add("status", telling);
  add("reader", ReaderHeartbeat{1, 1, true});
  Show show;
  show.entries = {{ShowKind::kParameter, "wind", {7, 0, 1}}, {ShowKind::kAnswered, "5 refused", {}}};
  seeds.push_back({"show", {showBytes(show)}});
  show.hair.positions = show.hair.velocities = {{1, 2, 3}, {4, 5, 6}};
  seeds.back().inputs.push_back(showBytes(show));
  return seeds;
}

}  // namespace strandcast
