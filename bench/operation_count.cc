#include "bench/operation_count.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/backend.h"
#include "core/strand_block.h"

namespace strandcast {
namespace kernels::counting {
// Each header depends on those before it.
// clang-format off
#include "bench/lanes_counting.inl"
#include "kernels/rotation.h"
#include "kernels/strand.h"
#include "kernels/contact.h"
#include "kernels/distance_field.h"
#include "kernels/rod.h"
#include "kernels/stiff_tensions.h"
#include "kernels/end_lanes.inl"
#include "core/block_step.inl"
// clang-format on
}  // namespace kernels::counting

OperationCount countOperations(const StrandModel& model, const StrandState& state, const StepInput& input) {
  BlockStore<float> store;
  store.load(model, 1);
  store.prepare(*input.parameters, !input.primitives.empty());
  store.upload(state);
  std::vector<float> scratch(blockScratch(store.maxVertices(), 1));
  const size_t apart = 1 + store.blocks() / 1024;
  kernels::counting::operations = 0;
  std::ranges::fill(kernels::counting::operations_of, 0);
  size_t vertices = 0;
  for (size_t b = 0; b < store.blocks(); b += apart) {
    const BlockView<float> block = store.block(b, input, scratch.data());
    kernels::counting::stepBlock(block, input, scratch.data());
    vertices += static_cast<size_t>(block.vertices);
  }
  const double times = static_cast<double>(vertices) * input.parameters->substeps;
  OperationCount out;
  out.all = static_cast<double>(kernels::counting::operations) / times;
  for (size_t part = 0; part < kStepParts; ++part)
    out.parts[part] = static_cast<double>(kernels::counting::operations_of[part]) / times;
  return out;
}

const char* nameOf(StepPart part) {
  switch (part) {
    case StepPart::kOther:
      return "other";
    case StepPart::kPredict:
      return "predict";
    case StepPart::kTwist:
      return "twist";
    case StepPart::kBend:
      return "bend";
    case StepPart::kMove:
      return "move";
    case StepPart::kTensions:
      return "tensions";
    case StepPart::kSecondLengthPass:
      return "second_length_pass";
    case StepPart::kVelocities:
      return "velocities";
    case StepPart::kContact:
      return "contact";
  }
  return "";
}

}  // namespace strandcast
