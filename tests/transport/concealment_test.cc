// Strands of lost chunks move with their carrier: the head, or a part of a skinned body.
#include "transport/concealment.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <random>

#include "limb.h"
#include "tests/thorough.h"
#include "transport/assembler.h"

namespace strandcast {
namespace {

/// Frames of several chunks, of hair on a limb or on a head with the same motion, and a reader of them.
class LimbReader {
 public:
  explicit LimbReader(bool is_head = false) : is_head_(is_head) {
    assembler.setGroom(groom);
    chunks = splitFrame(*groom, limbFrame(*groom, 1)).size();
  }
  /// Sends frame `number` without the lost chunks. Returns the frames that were completed or concealed.
  std::vector<std::shared_ptr<const GuideFrame>> cast(uint64_t number,
                                                      const std::function<bool(uint32_t)>& lost) {
    std::vector<std::shared_ptr<const GuideFrame>> shown;
    for (const GuideChunk& chunk : splitFrame(*groom, limbFrame(*groom, number, is_head_))) {
      if (lost(chunk.chunk_index)) continue;
      for (auto frame : {assembler.add(chunk), assembler.concealOverdue()})
        if (frame) shown.push_back(std::move(frame));
    }
    return shown;
  }
  /// Largest error of the frame's vertices and of its limb, m.
  float off(const GuideFrame& frame) const {
    const GuideFrame sent = limbFrame(*groom, frame.frame, is_head_);
    float most = limbOff(frame, sent);
    for (size_t v = 0; v < sent.positions.size(); ++v)
      most = std::max(most, (frame.positions[v] - sent.positions[v]).norm());
    return most;
  }

  const std::shared_ptr<const GroomDescription> groom =
      std::make_shared<GroomDescription>(limbGroom(1500, 16));
  GuideAssembler assembler{true};
  size_t chunks = 0;

 private:
  const bool is_head_;
};

std::shared_ptr<const ColliderSet> shared(ColliderSet set) {
  return std::make_shared<ColliderSet>(std::move(set));
}

TEST(Concealment, HairOnALimbGoesWithItHoweverLongItIsLost) {
  for (const uint32_t lost : {0u, 1u}) {
    LimbReader reader;
    ASSERT_GE(reader.chunks, 4u);
    reader.assembler.setColliders(shared(limbs({limb()})));
    float most = 0;
    uint64_t seen = 0;
    for (uint64_t number = 1; number <= 60; ++number) {
      for (const auto& frame : reader.cast(number, [&](uint32_t i) { return number > 10 && i == lost; })) {
        most = std::max(most, reader.off(*frame));
        EXPECT_EQ(frame->strands_concealed > 0, frame->frame > 10);
        ++seen;
      }
    }
    EXPECT_EQ(seen, 59u) << "the last one waits for the next";
    EXPECT_LT(most, lost == 0 ? 3e-4f : 1e-5f) << "m; chunk " << lost;
  }
}

TEST(Concealment, HairOfAHeadIsPutAsIfItsBodyHadNoParts) {
  LimbReader with(true), without(true);
  with.assembler.setColliders(shared(limbs({limb()})));
  std::mt19937 random(4);
  uint64_t concealed = 0;
  for (uint64_t number = 1; number <= 60; ++number) {
    const uint32_t losses = number > 3 ? static_cast<uint32_t>(random()) : 0;
    const auto lost = [&](uint32_t i) { return (losses >> (2 * i) & 3) == 3; };
    const auto a = with.cast(number, lost), b = without.cast(number, lost);
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i]->positions, b[i]->positions) << "bit for bit";
      concealed += a[i]->strands_concealed;
    }
  }
  EXPECT_GT(concealed, 1000u);
}

TEST(Concealment, CollidersThatAreAnnouncedAnewCarryHairOn) {
  LimbReader reader;
  reader.assembler.setColliders(shared(limbs({limb()})));
  const auto announced = [&](uint64_t number) {
    if (number == 20) reader.assembler.setColliders(shared(limbs({limb(3, 1), limb()}, 2)));
    if (number == 40) reader.assembler.setColliders(shared(limbs({}, 3)));
  };
  for (uint64_t number = 1; number <= 50; ++number) {
    announced(number);
    for (const auto& frame : reader.cast(number, [&](uint32_t i) { return number > 10 && i == 1; })) {
      if (number < 40) {
        EXPECT_LT(reader.off(*frame), 1e-5f) << number;
      } else {
        EXPECT_LT(reader.off(*frame), 0.4f) << "left where they were: " << number;
      }
    }
  }
}

TEST(Concealment, CollidersOfAnotherSessionWaitForTheirGroom) {
  LimbReader reader;
  ColliderSet other = limbs({limb()});
  other.session = 12;
  reader.assembler.setColliders(shared(other));
  auto next = std::make_shared<GroomDescription>(*reader.groom);
  next->session = 12;
  reader.assembler.setGroom(next);
  float most = 0;
  for (uint64_t number = 1; number <= 30; ++number) {
    for (GuideChunk& chunk : splitFrame(*next, limbFrame(*next, number))) {
      if (number > 10 && chunk.chunk_index == 1) continue;
      reader.assembler.add(chunk);
      if (const auto frame = reader.assembler.concealOverdue()) most = std::max(most, reader.off(*frame));
    }
  }
  EXPECT_GT(most, 0.0f);
  EXPECT_LT(most, 1e-5f);
}

/// Numbers that pass the checks of chunks, but are far out of range.
void damage(std::minstd_rand& random, GuideFrame& frame) {
  const auto any = [&](size_t count) { return random() % count; };
  const float far = std::array{3e38f, -3e38f, 1e25f}[any(3)];
  const auto axis = static_cast<int>(any(3));
  switch (random() % 6) {
    case 0:
      frame.positions[any(frame.positions.size())][axis] = far;
      break;
    case 1:
      for (Vec3& position : frame.positions) position[axis] = far;
      break;
    case 2:
      frame.head.position[axis] = far;
      break;
    case 3:
      if (!frame.colliders.empty()) frame.colliders[0].pose.position[axis] = far;
      break;
    case 4:
      frame.colliders.resize(any(4), {static_cast<uint32_t>(any(10)), frame.head, {}});
      break;
    default:
      frame.simulation_time += std::array{1e300, -1e300, 1e-300, 0.0, 1.0}[any(5)];
  }
}

TEST(Concealment, DamagedFramesNeverBreakIt) {
  std::minstd_rand random(8);
  const size_t runs = kSanitized ? 15 : 40;
  size_t shown = 0, concealed = 0;
  for (size_t run = 0; run < runs; ++run) {
    LimbReader reader;
    for (uint64_t number = 1; number <= 16; ++number) {
      if (random() % 4 == 0)
        reader.assembler.setColliders(shared(
            limbs(random() % 2 == 0 ? std::vector<Collider>{limb()} : std::vector{limb(3), limb(5, 0.03f)})));
      GuideFrame frame = limbFrame(*reader.groom, number);
      for (size_t times = random() % 6; times > 3; --times) damage(random, frame);
      for (const GuideChunk& chunk : splitFrame(*reader.groom, frame)) {
        if (number > 1 && random() % 4 == 0) continue;
        for (const auto& out : {reader.assembler.add(chunk), reader.assembler.concealOverdue()}) {
          if (!out) continue;
          ASSERT_TRUE(isSound(*out, reader.groom->guides.vertices())) << run << ", " << number;
          ++shown;
          concealed += out->strands_concealed > 0 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(shown, 10 * runs);
  EXPECT_GT(concealed, 5 * runs);
}

TEST(Concealment, ACollidersTurnAndWayGoOn) {
  // A screw motion in uneven steps.
  const Eigen::Vector3f axis = Eigen::Vector3f(1, 2, 3).normalized();
  const auto at = [&](double time) {
    const auto t = static_cast<float>(time);
    const Quat turn(Eigen::AngleAxisf(5 * t, axis));
    const Vec3 middle(0.3f, -0.2f, 0.1f);
    return Pose{middle - turn * middle + 2 * t * Vec3(axis), turn};
  };
  ColliderMotion motion;
  std::vector<PlacedCollider> out;
  motion.extrapolate(0.1, out);
  EXPECT_TRUE(out.empty());
  motion.record(std::vector<PlacedCollider>{{1, at(0), {}}, {2, at(1), {}}}, 0);
  motion.extrapolate(0.01, out);
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].pose.position, at(0).position) << "it cannot be said whither";
  motion.record(std::vector<PlacedCollider>{{2, at(1), sampleBend(3)}, {1, at(0.02), {}}, {3, at(2), {}}},
                0.02);
  const auto expectAt = [&](double now, double place) {
    motion.extrapolate(now, out);
    ASSERT_EQ(out.size(), 3u);
    EXPECT_EQ(out[0].pose.position, at(1).position) << "stands";
    EXPECT_EQ(out[0].pose.rotation.coeffs(), at(1).rotation.coeffs());
    EXPECT_TRUE(areAlike(out[0].bend, sampleBend(3)));
    EXPECT_EQ(out[2].pose.position, at(2).position) << "new";
    for (const Vec3& point : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)})
      EXPECT_LT((out[1].pose.apply(point) - at(place).apply(point)).norm(), 5e-6f) << now;
  };
  expectAt(0.01, 0.02);
  expectAt(0.05, 0.05);
  expectAt(5, 0.12);
}

}  // namespace
}  // namespace strandcast
