#include "core/broad_phase.h"

#include <gtest/gtest.h>

#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

constexpr float kMargin = 0.003f;  // m

std::vector<Pose> halfway(const std::vector<Pose>& begin, const std::vector<Pose>& end) {
  std::vector<Pose> out;
  for (size_t bone = 0; bone < begin.size(); ++bone) out.push_back(interpolate(begin[bone], end[bone], 0.5f));
  return out;
}

// Whether the box contains, along the six axis directions, all points that a strand of this length can touch
// from its root.
bool holds(const Box& box, const Vec3& root, float length) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      if (!box.contains(Eigen::Vector3f(root) +
                        side * (length + 0.99f * kMargin) * Eigen::Vector3f::Unit(axis)))
        return false;
  return true;
}

TEST(StrandReach, HoldsStrandsWhereverTheirBonesTakeThem) {
  StrandModel model = awkwardModel(150, 7);
  tieToBones(model);
  const StrandOrder order = strandOrder(model);
  const StrandReach reach(model, order, strandLengths(model));
  ASSERT_EQ(reach.neighbourhoods(), order.neighbourhoods());
  const std::vector<Pose> begin(3);
  std::vector<Pose> end = movedBones();
  end[0].position += Vec3(0.3f, 0, 0);
  std::vector<Box> boxes(reach.neighbourhoods());
  reach.place(begin, end, kMargin, boxes);
  const std::vector<float> lengths = strandLengths(model);
  for (const std::vector<Pose>& bones : {begin, halfway(begin, end), end}) {
    for (size_t s = 0; s < model.strands(); ++s) {
      const Vec3 root = bones[model.rootBone(s)].apply(model.rest_roots[s].position);
      EXPECT_TRUE(holds(boxes[order.neighbourhood_of[s]], root, lengths[s])) << "strand " << s;
    }
  }
}

TEST(StrandReach, HasNoEndForStrandsThatAnotherBoneHolds) {
  StrandModel model = awkwardModel(150, 7);
  const StrandOrder order = strandOrder(model);
  const std::vector<Pose> bones(3);
  std::vector<Box> free(order.neighbourhoods()), tied(order.neighbourhoods());
  StrandReach(model, order, strandLengths(model)).place(bones, bones, kMargin, free);
  tieToBones(model);
  StrandReach(model, order, strandLengths(model)).place(bones, bones, kMargin, tied);
  size_t endless = 0;
  for (size_t n = 0; n < order.neighbourhoods(); ++n) {
    bool elsewhere = false;
    for (const uint32_t s : order.strandsOf(n))
      for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
        elsewhere = elsewhere || model.isBonePinned(s, v);
    endless += elsewhere;
    EXPECT_LT(free[n].sizes().maxCoeff(), 2) << "they are 40 cm long at most, on a disc of 10 cm";
    EXPECT_EQ(tied[n].sizes().minCoeff() >= kEndless, elsewhere);
  }
  EXPECT_GT(endless, 0u);
}

}  // namespace
}  // namespace strandcast
