#include "validation/suite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"

namespace strandcast {
namespace {

Laboratory reference(SolverKind solver) { return {makeReferenceBackend, solver}; }

TEST(Case, IsPassedWithinItsLimitOnly) {
  EXPECT_TRUE(relativeCase({"a", "", ""}, 1.009, 1, 1).passed);
  EXPECT_FALSE(relativeCase({"a", "", ""}, 0.98, 1, 1).passed);
  EXPECT_TRUE(absoluteCase({"a", "", "m"}, 0, 0, 0).passed);
  EXPECT_FALSE(absoluteCase({"a", "", "m"}, -0.2, 0, 0.1).passed);
  EXPECT_TRUE(atLeastCase({"a", "", ""}, 3, 2, 0).passed);
  EXPECT_FALSE(atLeastCase({"a", "", ""}, 1.7, 2, 0.2).passed);
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(relativeCase({"a", "", ""}, none, 1, 1).passed);
  EXPECT_FALSE(absoluteCase({"a", "", ""}, none, 0, 1).passed);
  EXPECT_FALSE(atLeastCase({"a", "", ""}, none, 2, 1).passed);
  EXPECT_TRUE(std::isnan(worse(none, 1)) && std::isnan(worse(1, none)));
  EXPECT_EQ(worse(1, 2), 2);
  EXPECT_EQ(worse(2, 1), 2);
}

TEST(Suites, CasesAreNamedOnceAndAsListed) {
  for (const Suite& suite : validationSuites()) {
    std::set<std::string> names;
    for (const Experiment& experiment : suite.experiments)
      for (const std::string& name : experiment.cases) EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_GE(names.size(), suite.name == "volume" ? 7u : suite.name == "tunnel" ? 6u : 15u) << suite.name;
  }
  const Suite& physics = validationSuite("physics");
  const Experiment& first = physics.experiments.front();
  const std::vector<Case> cases = first.run(reference(SolverKind::kRod));
  ASSERT_EQ(cases.size(), first.cases.size());
  for (size_t i = 0; i < cases.size(); ++i) EXPECT_EQ(cases[i].name, first.cases[i]);
}

TEST(Suites, TheRodPassesTheCantileverAtEveryWeight) {
  const std::vector<Case> cases =
      runSuite(validationSuite("cantilever"), reference(SolverKind::kRod), "gamma=");
  for (const Case& c : cases)
    if (c.name.find("agree") == std::string::npos) {
      EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
    }
}

// The suite must reject a wrong result: the sag of gauss_seidel depends on its iterations.
TEST(Suites, GaussSeidelFailsTheCantilever) {
  const std::vector<Case> cases =
      runSuite(validationSuite("cantilever"), reference(SolverKind::kGaussSeidel), "vertices=32");
  ASSERT_EQ(cases.size(), 20u);
  EXPECT_GE(std::count_if(cases.begin(), cases.end(), [](const Case& c) { return !c.passed; }), 8);
}

// A backend whose hair never moves, or becomes NaN after a step.
class Broken final : public Backend {
 public:
  explicit Broken(bool stays) : stays_(stays) {}
  std::string name() const override { return "reference"; }
  std::string device() const override { return "none"; }
  void load(const StrandModel& model, const StrandState& state) override {
    upload(state);
    state_.contacts.resize(model.vertices(), Vec3::Zero());
  }
  void upload(const StrandState& state) override { state_ = state; }
  void download(StrandState& state) override { state = state_; }
  void step(const StepInput&) override {
    if (!stays_) std::fill(state_.positions.begin(), state_.positions.end(), Vec3::Constant(std::nanf("")));
  }
  std::span<const Vec3> guides() override { return state_.positions; }
  std::span<const Vec3> velocities() override { return state_.velocities; }
  bool takesAccelerations() const override { return true; }

 private:
  bool stays_;
  StrandState state_;
};

void expectFailures(bool stays, const std::string& suite, const std::string& only) {
  const Laboratory laboratory([=] { return std::make_unique<Broken>(stays); }, SolverKind::kRod);
  for (const Case& c : runSuite(validationSuite(suite), laboratory, only))
    EXPECT_FALSE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
}

TEST(Suites, HairThatIsNoNumberFails) {
  expectFailures(false, "tunnel", "tilt=0");
  expectFailures(false, "physics", "1 km from the origin: stretch");
  expectFailures(false, "contact", "mesh tilted");
}

TEST(Suites, HairThatStaysWhereItIsFails) {
  expectFailures(true, "contact", "dropped on a sphere: vertices");
  expectFailures(true, "volume", "into each other");
}

TEST(Suites, OnlyCasesThatAreNamedAreGiven) {
  const Suite& cantilever = validationSuite("cantilever");
  const std::vector<Case> cases = runSuite(cantilever, reference(SolverKind::kRod), "gamma=10 convergence");
  ASSERT_EQ(cases.size(), 1u);
  EXPECT_GT(cases[0].measured, 1.8);
  EXPECT_THROW(runSuite(cantilever, reference(SolverKind::kRod), "gamma=7"), Error);
  EXPECT_THROW(validationSuite("chemistry"), Error);
}

TEST(Suites, StopWhereTheyAreTold) {
  int asked = 0;
  const Laboratory stopped(makeReferenceBackend, SolverKind::kRod, [&] { return ++asked > 10; });
  EXPECT_TRUE(runSuite(validationSuite("cantilever"), stopped).empty());
  EXPECT_EQ(asked, 11);
}

}  // namespace
}  // namespace strandcast
