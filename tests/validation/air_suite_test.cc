#include <gtest/gtest.h>

#include "core/simulation.h"
#include "simd/simd_backend.h"
#include "validation/specimen.h"
#include "validation/suite.h"

namespace strandcast {
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
