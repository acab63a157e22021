#pragma once
#include <array>
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// What the rod needs of a model, and its dispatches: four edges per invocation (shaders/rod.comp).
class RodStrands {
 public:
  /// `model` outlives this. `few`: strands of up to so many vertices in all, and of two thirds of it among
  /// bodies, go in one turn, as if all were violent. `compiles_slowly`: strands of kinds that are rare in the
  /// model share one program, though it does more than some of them need.
  RodStrands(const StrandModel& model, size_t few, bool compiles_slowly);
  /// Before the first step with a goal pull or bodies.
  void expect(bool goal, bool bodies);
  /// Whether a program may ask where vertices are in the rest shape, goal pull aside.
  bool holdsVertices() const;
  /// What the programs of a step are chosen by.
  struct Needs {
    bool bodies;       ///< there are some
    int turning;       ///< 1: some of them are of kinds with a rotation; 2: fields that bend
    bool fields;       ///< some of them are fields
    bool goal;         ///< all strands are pulled towards their goals
    bool accelerated;  ///< StepInput::accelerations
    bool damping;      ///< there is internal damping
    float time2;       ///< s^2, see DragStep
    bool same_bodies;  ///< what vertices have seen of bodies in the step before holds on
  };
  /// Gives the commands of a step; the buffers of GpuStrands are bound. The first one with new needs
  /// compiles. Without bodies it is one dispatch of each group of few strands, two of many; with them some
  /// for each substep, of many strands without those that no body comes near in the step.
  void step(const Needs& needs, int substeps, ProgramCache& programs);
  /// Steps without bodies leave strands that are straight at rest without frames but their first: finds the
  /// others where that is so. The buffers of GpuStrands are bound.
  void findFrames(ProgramCache& programs);
  /// All frames are new.
  void takeFrames() { frames_lag_ = false; }

 private:
  using GroupPrograms = std::vector<const gl::Program*>;
  /// Of each group; a strand that the first cannot do is left to the second, and so on. Null where the other
  /// does these too: calm of few strands, astray of not very many.
  struct Programs {
    GroupPrograms calm, violent, astray;
  };
  bool areFew(bool bodies) const;
  bool doesAstrayApart(const StrandGroup& group) const;
  /// Whether any strand is, in these substeps.
  bool isStiff(const Needs& needs) const;
  /// Whether the keys of some groups have one of these.
  bool anyGroup(uint32_t bits) const;
  enum class Motion { kClear, kCalm, kViolent };
  const gl::Program& compile(size_t group, Motion motion, bool astray, const Needs& needs,
                             ProgramCache& programs) const;
  Programs compile(const Needs& needs, ProgramCache& programs) const;
  /// Whether it pays to find those that no body comes near in the step.
  bool sortsOutClear(const Needs& needs) const { return needs.bodies && !areFew(true) && !needs.fields; }
  /// After the first look of a step: sorts strands into clear and near ones, and does the clear ones.
  void doClear(const Needs& needs, int substeps, ProgramCache& programs);
  /// The substeps from `first` until before `end`; among bodies, of near strands.
  void solve(const Programs& programs, const Needs& needs, int first, int end) const;
  // Places in work_, in 4 bytes: see shaders/rod_work.glsl.
  size_t clearAt(size_t group) const { return (groups_.order().size() + 3) / 4 * 4 + 4 * group; }
  size_t nearAt(size_t group) const { return clearAt(groups_.groups().size() + group); }
  size_t violentAt(size_t group, int substep) const;
  size_t astrayAt(size_t group, int substep) const {
    return violentAt(groups_.groups().size() + group, substep);
  }
  size_t lostCount(int substep) const { return violentAt(2 * groups_.groups().size(), substep); }
  enum class List { kClear, kNear, kViolent, kAstray, kLost };
  size_t listAt(List list, size_t group = 0) const;
  /// Some strands, as the programs are told where they are in work_.
  struct Strands {
    GLuint count, list;
  };
  Strands listed(List list, size_t group, int substep = 0) const;
  Strands wholeGroup(size_t group) const;
  /// Tells the program which strands of a group to do, where to leave those that it cannot, and in which
  /// substeps. `bodies`: it heeds them.
  void placeWork(const gl::Program& program, const Needs& needs, bool bodies, size_t group, Strands own,
                 Strands left, int first, int end) const;

  const StrandModel& model_;
  StrandGroups groups_;             ///< key: see rod_strands.cc
  std::vector<uint32_t> edges_of_;  ///< per group: edges of each of its strands, 0 where they differ
  float stiffest_ = 0;              ///< the greatest StrandRest::stiffest
  bool between_pins_ = false;       ///< some strand hangs between two pins, and may be taut there
  gl::Buffer work_, joints_, strands_;
  gl::Buffer edges_;       ///< empty until a step needs it: programs of uniform strands do without
  uint32_t edge_row_ = 0;  ///< numbers of one of its rows
  const size_t few_;
  const bool compiles_slowly_;
  const bool shuffled_;
  std::array<Programs, 96> programs_;            ///< by needs; empty until first needed
  std::array<GroupPrograms, 8> clear_;           ///< the same, of clear strands
  std::array<LazyProgram, 3> roots_, keep_out_;  ///< by Needs::turning
  std::array<LazyProgram, 9> look_;              ///< by this and SORTING of shaders/look.comp
  LazyProgram clear_strands_, straight_frames_;
  bool frames_lag_ = false;  ///< see findFrames()
};

}  // namespace strandcast::gpu
