#pragma once
#include <array>
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// What the rod needs of a model, and its dispatches: four edges per invocation (shaders/rod.comp).
class RodStrands {
 public:
  explicit RodStrands(const StrandModel& model);
  /// What the programs of a step are chosen by.
  struct Needs {
    bool bodies;       ///< there are some
    bool turning;      ///< some of them of kinds with a rotation
    bool goal;         ///< all strands are pulled towards their goals
    bool accelerated;  ///< StepInput::accelerations
    bool damping;      ///< there is internal damping
  };
  /// Gives the commands of a step; the buffers of GpuStrands are bound. The first one with new needs
  /// compiles.
  void step(const Needs& needs, ProgramCache& programs);

 private:
  using GroupPrograms = std::vector<const gl::Program*>;
  GroupPrograms compile(const Needs& needs, bool violent, ProgramCache& programs) const;
  size_t dispatchAt(size_t group) const;  ///< in work_, in 4 bytes: of its violent strands
  /// Tells the program where in work_ the group's violent strands go.
  void placeWork(const gl::Program& program, size_t group) const;

  StrandGroups groups_;             ///< key: see rod_strands.cc
  std::vector<uint32_t> edges_of_;  ///< per group: edges of each of its strands, 0 where they differ
  gl::Buffer work_, joints_, edges_, strands_;
  const bool shuffled_;
  struct Programs {
    GroupPrograms calm, violent;
  };
  std::array<Programs, 32> programs_;  ///< by needs; empty until first needed
};

}  // namespace strandcast::gpu
