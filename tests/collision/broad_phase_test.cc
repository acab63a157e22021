#include "core/broad_phase.h"

#include <gtest/gtest.h>

#include <random>

#include "collision/tree_broad_phase.h"
#include "core/simulation.h"
#include "tests/conformance/conformance_model.h"

namespace strandcast {
namespace {

class Boxes {
 public:
  Box box(float reach, float size) {
    std::uniform_real_distribution<float> place(-reach, reach), edge(0, size);
    const Eigen::Vector3f low(place(random_), place(random_), place(random_));
    return {low, low + Eigen::Vector3f(edge(random_), edge(random_), edge(random_))};
  }
  std::vector<Box> boxes(size_t count, float reach, float size) {
    std::vector<Box> out;
    for (size_t i = 0; i < count; ++i) out.push_back(box(reach, size));
    return out;
  }

 private:
  std::mt19937 random_{3};
};

const Box kEverywhere(Eigen::Vector3f::Constant(-kEndless), Eigen::Vector3f::Constant(kEndless));

TEST(BroadPhase, TheTreeFindsWhatAllPairsFind) {
  Boxes random;
  const auto tree = makeTreeBroadPhase(), pairs = makeAllPairs();
  size_t found = 0, possible = 0;
  for (const size_t bodies : {0, 1, 2, 300, 300, 299, 40, 41, 0, 5}) {
    for (int step = 0; step < 3; ++step) {  // the same bodies, in other positions
      std::vector<Box> body_boxes = random.boxes(bodies, 1, 0.2f);
      if (bodies > 30) body_boxes[17] = kEverywhere;
      std::vector<Box> strands = random.boxes(100, 1, 0.3f);
      strands[50] = kEverywhere;
      NearBodyLists mine, truth;
      tree->findPairs(body_boxes, strands, mine);
      pairs->findPairs(body_boxes, strands, truth);
      EXPECT_EQ(mine.offsets, truth.offsets);
      EXPECT_EQ(mine.bodies, truth.bodies);
      EXPECT_EQ(mine.of(50).size(), bodies);
      found += mine.bodies.size();
      possible += bodies * strands.size();
    }
  }
  EXPECT_GT(found, 1000u);
  EXPECT_LT(found, possible / 5);
}

TEST(BroadPhase, NoNeighbourhoodNoList) {
  NearBodyLists lists;
  makeTreeBroadPhase()->findPairs(Boxes().boxes(3, 1, 1), {}, lists);
  EXPECT_EQ(lists.offsets, std::vector<uint32_t>{0});
  EXPECT_TRUE(lists.bodies.empty());
}

// Three hundred balls around a moving head.
TEST(BroadPhase, ASimulationGivesShortListsAndTheTreeTheSame) {
  Boxes random;
  std::vector<RigidBody> bodies;
  for (const Box& box : random.boxes(300, 1.5f, 0.1f)) {
    ContactPrimitive ball;
    ball.a = box.center();
    ball.radius = 0.03f;
    bodies.push_back({{ball}});
  }
  const StrandModel model = awkwardModel(257, 5);
  Parameters parameters;
  parameters.solver = SolverKind::kRod;
  const auto make = [&](std::unique_ptr<BroadPhase> broad_phase) {
    return Simulation(model, bodies, parameters, makeReferenceBackend(), nullptr, std::move(broad_phase));
  };
  Simulation tree = make(makeTreeBroadPhase()), pairs = make(makeAllPairs());
  for (int i = 1; i <= 30; ++i) {
    const Pose head{Vec3(0.005f * i, 0, 0), Quat(Eigen::AngleAxisf(0.02f * i, Eigen::Vector3f::UnitY()))};
    for (Simulation* s : {&tree, &pairs}) s->setHeadPose(head);
    const StepInput input = pairs.nextInput();
    ASSERT_NE(input.near, nullptr);
    EXPECT_GT(input.near->bodies.size(), 0u);
    EXPECT_LT(input.near->bodies.size(), (input.near->offsets.size() - 1) * input.primitives.size() / 5);
    tree.step();
    pairs.step();
  }
  EXPECT_EQ(stateHash(tree.state()), stateHash(pairs.state()));
}

}  // namespace
}  // namespace strandcast
