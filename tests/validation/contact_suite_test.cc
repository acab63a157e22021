#include <gtest/gtest.h>

#include "core/backend.h"
#include "simd/simd_backend.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

const Laboratory kLaboratory(makeReferenceBackend, SolverKind::kRod);

// Friction, rest and energy; what takes longer is left to `strandcast validate contact`.
TEST(ContactSuite, TheRodPasses) {
  for (const char* only : {"slope", "capstan", "energy", "dropped on a sphere"})
    for (const Case& c : runSuite(validationSuite("contact"), kLaboratory, only)) {
      EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
    }
}

// All of it where that takes seconds.
TEST(ContactSuite, TheRodPassesWholeInLanes) {
  const Laboratory lanes([] { return makeSimdBackend(0); }, SolverKind::kRod);
  for (const Case& c : runSuite(validationSuite("contact"), lanes))
    EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
}

TEST(ContactSuite, NoStrandPassesThroughAFastPlate) {
  for (const Case& c : runSuite(validationSuite("tunnel"), kLaboratory, "tilt=0")) {
    EXPECT_EQ(c.measured, 0) << c.name;
  }
}

}  // namespace
}  // namespace strandcast
