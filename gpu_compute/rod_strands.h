#pragma once
#include <array>
#include <vector>

#include "core/strand_model.h"
#include "gpu_compute/strand_groups.h"

namespace strandcast::gpu {

/// The rod solver on the GPU: its copy of a model's rest data, and the dispatches of a step
/// (shaders/rod.comp), with two or four edges per invocation. Precondition of every call: the context in
/// which it was constructed is current.
class RodStrands {
 public:
  /// `model` must outlive this. `small_model`: a model of up to this many vertices, among bodies two thirds
  /// of it, is solved in one dispatch per group, by the variant with the dense metric. `compiles_slowly`:
  /// strands of rare kinds share one variant, though it does more than some of them need.
  RodStrands(const StrandModel& model, size_t small_model, bool compiles_slowly);
  /// Allocates the rest data that steps with a goal or bodies need. Call it before the first of them.
  void prepare(bool goal, bool bodies);
  /// Whether shaders read the rest shape even without a goal: for pinned vertices or grooming factors.
  bool needsRestShape() const;
  /// What decides on the shader variants and passes of a step.
  struct Needs {
    bool bodies;       ///< there are bodies
    int shape_kinds;   ///< SHAPE_KINDS of shaders/bodies.glsl, 0 to 2
    bool fields;       ///< some bodies are fields
    bool goal;         ///< goals are on for all strands
    bool accelerated;  ///< vertices have external accelerations
    bool damping;      ///< internal damping is on
    float time2;       ///< s^2, DragStep::time2
    bool same_bodies;  ///< the contact cache of the last step is still valid
  };
  /// Records the dispatches of a step. Precondition: the buffers of GpuStrands are bound. The first step with
  /// new needs compiles and may throw Error. Without bodies: one dispatch per group of a small model, two per
  /// group of a large one. Among bodies: several per substep; in large models contact-free strands are
  /// excluded from them and solved by one dispatch per group.
  void step(const Needs& needs, int substeps, ProgramCache& programs);
  /// Computes the material frames that steps without bodies have not stored: of strands that are straight at
  /// rest, all but the first. Precondition: the buffers of GpuStrands are bound.
  void computeFrames(ProgramCache& programs);
  /// Tells that all frames have been uploaded.
  void markFramesStored() { frames_stale_ = false; }

 private:
  using GroupPrograms = std::vector<const gl::Program*>;
  /// Variants per group: without the dense metric, with it, and with it and contact queries. A strand that
  /// one cannot solve is left to the next. Null if another variant includes it: `tridiagonal` in small
  /// models, `stale_cache` in groups that are not large.
  struct Programs {
    GroupPrograms tridiagonal, dense_metric, stale_cache;
  };
  /// Whether the model is small: one variant solves all strands.
  bool isSmallModel(bool bodies) const;
  /// Whether strands of the group with a stale contact cache are solved by a dispatch of their own.
  bool separatesStaleCache(const StrandGroup& group) const;
  /// Whether any strand is stiff, isStiff() of kernels/rod.h, at this time2.
  bool isStiff(const Needs& needs) const;
  /// Whether the key of any group has one of these bits.
  bool anyGroup(uint32_t bits) const;
  enum class Motion { kContactFree, kTridiagonal, kDenseMetric };
  const gl::Program& compile(size_t group, Motion motion, bool stale_cache, const Needs& needs,
                             ProgramCache& programs) const;
  Programs compile(const Needs& needs, ProgramCache& programs) const;
  /// Whether contact-free strands are solved apart: in large models among bodies, unless there are fields.
  bool separatesContactFree(const Needs& needs) const {
    return needs.bodies && !isSmallModel(true) && !needs.fields;
  }
  /// After the first contact queries of a step: classifies strands, and solves the contact-free ones.
  void stepContactFree(const Needs& needs, int substeps, ProgramCache& programs);
  /// Solves the substeps from `first` to `end` - 1; if contact-free strands are solved apart, of near
  /// strands.
  void solve(const Programs& programs, const Needs& needs, int first, int end) const;
  // Indices in work_, of 4-byte words: see shaders/rod_work.glsl.
  size_t contactFreeAt(size_t group) const { return (groups_.order().size() + 3) / 4 * 4 + 4 * group; }
  size_t nearAt(size_t group) const { return contactFreeAt(groups_.groups().size() + group); }
  size_t denseMetricAt(size_t group, int substep) const;
  size_t staleCacheAt(size_t group, int substep) const {
    return denseMetricAt(groups_.groups().size() + group, substep);
  }
  size_t penetratingCount(int substep) const { return denseMetricAt(2 * groups_.groups().size(), substep); }
  enum class List { kContactFree, kNear, kDenseMetric, kStaleCache, kPenetrating };
  size_t listAt(List list, size_t group = 0) const;
  /// A list of strands: indices in work_ of its count (or kWholeGroup) and of its first strand.
  struct StrandList {
    GLuint count, list;
  };
  StrandList listed(List list, size_t group, int substep = 0) const;
  StrandList wholeGroup(size_t group) const;
  /// Sets the program's uniforms: the strands of a group to solve, the list for those that it cannot solve,
  /// and the substeps. `bodies`: the BODIES variant.
  void setUniforms(const gl::Program& program, const Needs& needs, bool bodies, size_t group, StrandList own,
                   StrandList left, int first, int end) const;

  const StrandModel& model_;
  StrandGroups groups_;             ///< key: see rod_strands.cc
  std::vector<uint32_t> edges_of_;  ///< per group: edges of each of its strands, 0 if they differ
  float stiffest_ = 0;              ///< greatest StrandRest::stiffest, 1/s^2
  bool between_pins_ = false;       ///< some strand hangs between two pins and may be taut
  gl::Buffer work_, joints_, strands_;
  gl::Buffer edges_;       ///< empty until a step needs it: variants for uniform strands do not
  uint32_t edge_row_ = 0;  ///< floats per row of edges_: 0, 1, 2 or 4
  const size_t small_model_vertices_;
  const bool compiles_slowly_;
  const bool shuffled_;
  std::array<Programs, 96> programs_;                       ///< by needs; empty until first needed
  std::array<GroupPrograms, 8> contact_free_;               ///< the same, CONTACT_FREE variants
  std::array<LazyProgram, 3> roots_, resolve_penetration_;  ///< by Needs::shape_kinds
  std::array<LazyProgram, 9> query_contacts_;  ///< by shape_kinds and SORTING of query_contacts.comp
  LazyProgram contact_free_strands_, straight_frames_;
  bool frames_stale_ = false;  ///< some frames are not stored: see computeFrames()
};

}  // namespace strandcast::gpu
