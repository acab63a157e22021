// Suites of `strandcast validate` on the rod.
#include <gtest/gtest.h>

#include "core/backend.h"
#include "core/simulation.h"
#include "simd/simd_backend.h"
#include "tests/thorough.h"
#include "validation/specimen.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

TEST(PhysicsSuite, TheRodPassesAllButOneCase) {
  const Laboratory laboratory(makeReferenceBackend, SolverKind::kRod);
  for (const Case& c : runSuite(validationSuite("physics"), laboratory)) {
    if (c.name == "time step of 1/30 s: returns") continue;  // docs/validation.md
    EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
  }
}

}  // namespace
namespace {

const Laboratory kLaboratory(makeReferenceBackend, SolverKind::kRod);

void expectPasses(const Laboratory& laboratory, std::initializer_list<const char*> experiments) {
  for (const char* only : experiments)
    for (const Case& c : runSuite(validationSuite("contact"), laboratory, only))
      EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
}

TEST(ContactSuite, TheRodPassesInLanes) {
  expectPasses(Laboratory([] { return makeSimdBackend(0); }, SolverKind::kRod),
               {"slope", "capstan", "energy", "dropped on a sphere", "stick-slip", "dropped on a mesh",
                "mesh tilted", "head shaken", "hand through"});
}

TEST(ContactSuite, TheRodPasses) {
  if (!thorough()) GTEST_SKIP() << kSkippedUnlessThorough;
  expectPasses(kLaboratory, {"slope", "capstan", "energy", "dropped on a sphere"});
}

TEST(ContactSuite, NoStrandPassesThroughAFastPlate) {
  for (const Case& c : runSuite(validationSuite("tunnel"), kLaboratory, "tilt=0")) {
    EXPECT_EQ(c.measured, 0) << c.name;
  }
}

}  // namespace
namespace {

TEST(AirSuite, AStrandInTheWindLeansAsTheExactOne) {
  const Laboratory laboratory([] { return makeSimdBackend(1); }, SolverKind::kRod);
  for (const Case& c : runSuite(validationSuite("air"), laboratory, "load="))
    EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
}

// A groom at rest moves by the rounding of float positions, not by forces: in double it stays at rest.
TEST(AirSuite, AGroomAtRestStaysWhereItIsInDouble) {
  const Laboratory laboratory(makeOracleBackend, SolverKind::kRod);
  Parameters parameters = laboratory.parameters(60, 1);
  parameters.substeps = 4;
  parameters.damping_time = 5e-4f;
  parameters.volume_stiffness = 40;
  parameters.gravity.setZero();
  Simulation simulation = laboratory.simulation(headOfHair(60, 0.2, 23, 2), parameters);
  const std::vector<Vec3> before(simulation.guides().begin(), simulation.guides().end());
  laboratory.advance(simulation, 0.5);
  double squares = 0;
  for (size_t v = 0; v < before.size(); ++v)
    squares += double{(simulation.guides()[v] - before[v]).squaredNorm()};
  EXPECT_LT(std::sqrt(squares / static_cast<double>(before.size())), 1e-7);
}

TEST(AirSuite, WispsComeApartAndRest) {
  const Laboratory laboratory([] { return makeSimdBackend(1); }, SolverKind::kRod);
  for (const char* name : {"wisps", "momentum"})
    for (const Case& c : runSuite(validationSuite("volume"), laboratory, name))
      EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
}

}  // namespace
}  // namespace strandcast
