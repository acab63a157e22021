#include <gtest/gtest.h>

#include "core/backend.h"
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

TEST(ContactSuite, NoStrandPassesThroughAFastPlate) {
  for (const Case& c : runSuite(validationSuite("tunnel"), kLaboratory, "tilt=0")) {
    EXPECT_EQ(c.measured, 0) << c.name;
  }
}

}  // namespace
}  // namespace strandcast
