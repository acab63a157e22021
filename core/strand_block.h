#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Allocator with the alignment of the widest vector loads, 64 bytes.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), std::align_val_t(64))); }
  void deallocate(T* p, size_t) { ::operator delete(p, std::align_val_t(64)); }
  bool operator==(const CacheLineAllocator&) const { return true; }
};

constexpr int kBlockPlanes = 17;  ///< planes per vertex that every step of the rod needs

/// 3-vectors in a table of their own: [vertex][3][lane]. Equals null if the table does not exist.
template <class Scalar>
struct VectorRows {
  Scalar* first;
  bool operator==(std::nullptr_t) const { return first == nullptr; }
};

/// View of one block. A lane is a strand; sweeps run along it. Memory layout:
///   per vertex:  [vertex][plane][lane], so that a sweep along the strands is one stream through memory
///   roots:       [plane][lane]
/// Lanes past the last strand hold copies of it and are not read back. Optional quantities have tables of
/// their own, whose pointers are null if no strand uses them (BlockStore::prepare).
template <class Scalar>
struct BlockView {
  int vertices;
  bool pinned;       ///< some vertex besides the roots is pinned
  bool uniform;      ///< in each strand all edges are equally long and all inner vertices equally heavy
  Scalar* position;  ///< 3 planes, m
  Scalar* velocity;  ///< 3 planes, m/s
  const Scalar* rest_length;  ///< 1 plane, m, of edge (i, i + 1)
  // Rod: edge (i, i + 1) and the joint before it are in row i. Units: see StrandModel.
  Scalar* frame;              ///< 4 planes, x y z w, world
  Scalar* tension;            ///< 1 plane
  const Scalar* rest_strain;  ///< 3 planes
  const Scalar* bend;         ///< 1 plane
  const Scalar* twist;        ///< 1 plane
  const Scalar* mass_data;    ///< [row][kMassPlanes][lane]; row: see massRow()
  const Scalar* root;  ///< 14 planes: position and rotation x y z w at the start of the step, then at its end
  bool factors;        ///< some grooming factor of the strands differs from 1
  const Scalar* grooming;   ///< [vertex][kGroomingPlanes][lane]; null if there are no factors and tethers
  const Scalar* bone_pins;  ///< [vertex][kBonePinPlanes][lane]; null if no vertex is pinned to another bone
  const Scalar* rest_distance;            ///< [vertex][lane], m, see StrandModel; null if the model has none
  VectorRows<const Scalar> rest_local;    ///< m, in the root frame
  const Scalar* pbd;                      ///< [vertex][kPbdPlanes][lane]; gauss_seidel only
  VectorRows<Scalar> contact;             ///< rod among bodies, see StrandState::contacts
  VectorRows<const Scalar> acceleration;  ///< m/s^2; null if StepInput has none
  uint32_t neighbourhood;                 ///< of StrandOrder; the same for all strands of the block
};

constexpr int kRootPlanes = 14;

/// Planes of BlockView::mass_data: of edge (i, i + 1) and of vertex i.
enum MassPlane : int {
  kInverseLength,  ///< 1/m, bounded if the edge is much shorter than its strand's mean (kShortestEdge)
  kMass,           ///< StrandModel::mass; kPinnedMass if pinned
  kWeight,         ///< 1 / mass, 0 if pinned
  kMassPlanes
};
/// Row of vertex i in BlockView::mass_data. A uniform block has three rows for all its vertices: root, inner
/// vertices, tip.
constexpr int massRow(int i, int vertices, bool uniform) {
  if (!uniform) return i;
  return i + 1 == vertices ? 2 : i > 0 ? 1 : 0;
}
constexpr int massRows(int vertices, bool uniform) { return uniform ? 3 : vertices; }

/// Planes of BlockView::pbd.
enum PbdPlane : int {
  kRestEdge,         ///< 3, m: the rest edge in the Bishop frame of the edge before it
  kInverseMass = 3,  ///< 0 (pinned) or 1
  kPbdPlanes = 4
};

/// Planes of BlockView::bone_pins, for vertices that are pinned to another bone than that of their root
/// frame.
enum BonePinPlane : int {
  kBonePinned,   ///< 1 = pinned so, otherwise 0
  kHeldBegin,    ///< 3, m: position on the bone at the start of the step
  kHeldEnd = 4,  ///< 3, m: position at its end
  kBonePinPlanes = 7
};

/// Planes of BlockView::grooming, see StrandModel. The damping factor is per joint, all others are per
/// vertex.
enum GroomingPlane : int {
  kAirDragScale,
  kGoalScale,
  kDampingScale,   ///< product of damping_scale and damping_along
  kFrictionScale,  ///< product of friction_scale and friction_along
  kTether,         ///< m
  kGroomingPlanes
};

constexpr float kPinnedMass = 1e6f;    ///< mass of a vertex that the rod's bending solve must not move
constexpr float kShortestEdge = 0.1f;  ///< of the strand's mean: shorter edges bend as if this long

constexpr int kMaxLanes = 64;  ///< greatest number of strands of a block

constexpr int kSolverPlanes = 22;   ///< scratch numbers per vertex and lane: of a solver,
constexpr int kTensionPlanes = 29;  ///< of the tension increments of stiff strands,
constexpr int kGroomingRows = 6;    ///< of core/strand_sweep.inl,
constexpr int kContactPlanes = 21;  ///< and of core/near_bodies.inl,
constexpr int kPlacedBodies = 16;   ///< which also has one per vertex and placed body, for all lanes together

/// Numbers of scratch memory for a step of a block: solver, grooming, contact and the strands' accelerations.
constexpr size_t rodScratch(int vertices, int lanes) {
  return static_cast<size_t>(kSolverPlanes) * (vertices + 2) * lanes;
}
constexpr size_t solverScratch(int vertices, int lanes) {
  return rodScratch(vertices, lanes) + static_cast<size_t>(kTensionPlanes) * vertices * lanes;
}
constexpr size_t groomingScratch(int vertices, int lanes) {
  return static_cast<size_t>(kGroomingRows) * vertices * lanes;
}
constexpr size_t contactScratch(int vertices, int lanes) {
  return static_cast<size_t>(kContactPlanes * lanes + kPlacedBodies) * vertices;
}
constexpr size_t accelerationScratch(int vertices, int lanes) {
  return static_cast<size_t>(3) * vertices * lanes;
}
constexpr size_t blockScratch(int vertices, int lanes) {
  return solverScratch(vertices, lanes) + groomingScratch(vertices, lanes) + contactScratch(vertices, lanes) +
         accelerationScratch(vertices, lanes);
}

/// Working store of the CPU backends: strands in the order of StrandOrder, cut into blocks of `lanes` strands
/// with equal vertex counts. A block is contiguous and small enough to stay in the near caches through all
/// substeps of a step.
template <class Scalar>
class BlockStore {
 public:
  /// `model` must outlive its use here; `lanes`: 1 to kMaxLanes.
  void load(const StrandModel& model, int lanes);
  /// Allocates the tables that steps with these parameters need, and those for contact if `bodies`. Call it
  /// before the first such step; further calls cost nothing.
  void prepare(const Parameters& parameters, bool bodies);
  /// Copies a state into the blocks.
  void upload(const StrandState& state);
  /// Copies the state of all blocks out, natural order.
  void download(StrandState& state) const;

  size_t blocks() const { return blocks_.size(); }
  int lanes() const { return lanes_; }
  /// Vertices of the longest strand.
  int maxVertices() const { return max_vertices_; }
  /// Prepares block b for a step: copies root poses and positions of bone pins into the block's planes, and
  /// accelerations into the end of `scratch`, which must have blockScratch() numbers. Clears contact forces
  /// if the step has no bodies.
  BlockView<Scalar> block(size_t b, const StepInput& input, Scalar* scratch);
  /// Copies the positions of block b's strands into `positions`, natural order.
  void readPositions(size_t b, std::span<Vec3> positions) const { read(b, 0, positions); }
  /// Copies the velocities of block b's strands into `velocities`, natural order.
  void readVelocities(size_t b, std::span<Vec3> velocities) const { read(b, 3, velocities); }

 private:
  using Memory = std::vector<Scalar, CacheLineAllocator<Scalar>>;
  /// Optional quantity of all blocks: [vertex][planes][lane]; empty until a step needs it.
  struct Table {
    int planes;
    mutable Memory numbers{};
  };
  struct Block {
    int vertices;
    bool pinned, uniform, factors, tethers;
    uint32_t first;                    ///< index in order_
    uint32_t count;                    ///< strands, at most lanes_
    size_t memory;                     ///< index of its first scalar in memory_
    size_t row;                        ///< its first row in the tables
    uint32_t neighbourhood;            ///< of StrandOrder
    uint32_t first_pin = 0, pins = 0;  ///< range in pins_
    bool pressed = false;              ///< contact forces may differ from 0
  };
  static bool groomed(const Block& block) { return block.factors || block.tethers; }
  /// A vertex that is pinned to another bone than that of its root frame.
  struct BonePin {
    int vertex, lane;
    uint16_t bone;
    Vec3 rest;  ///< m, in the groom's frame
  };
  /// Strand of a lane. Lanes past the last strand repeat it.
  uint32_t strandOf(const Block& block, int lane) const {
    return order_[block.first + std::min(static_cast<uint32_t>(lane), block.count - 1)];
  }
  void makeRoom(Table& table) { table.numbers.resize(rows_ * table.planes * lanes_); }
  /// Calls put(strand, entry) for each lane of an allocated table; entry(plane, vertex) is a reference to the
  /// lane's number.
  template <class Put>
  void forStrands(const Table& table, const Put& put);
  /// The block's rows of a table; null if the table is empty.
  Scalar* rows(const Table& table, const Block& block) const {
    return table.numbers.empty() ? nullptr : table.numbers.data() + block.row * table.planes * lanes_;
  }
  /// Cuts the strands into blocks and allocates their memory.
  void layOut();
  /// Whether the edges of a strand are equally long and its inner vertices equally heavy: see
  /// BlockView::uniform.
  bool isEven(uint32_t strand) const;
  /// Writes the constant quantities of the strand in a lane.
  void setStrand(const Block& block, int lane);
  Scalar* planes(const Block& block, int plane) const;
  Scalar& number(const Block& block, int plane, int vertex, int lane) const;
  Scalar* roots(const Block& block) const;
  Scalar* massData(const Block& block) const;
  Scalar* grooming(const Block& block) const;
  Scalar* bonePins(const Block& block) const;
  void read(size_t b, int plane, std::span<Vec3> out) const;
  void setInput(Block& block, const StepInput& input);
  void setAccelerations(const Block& block, const StepInput& input, Scalar* out) const;
  void clearContacts(Block& block);
  Scalar* restDistance(const Block& block) const;

  int lanes_ = 1;
  int max_vertices_ = 0;
  const StrandModel* model_ = nullptr;
  bool held_ = false;  ///< goals are needed whatever the parameters: vertices are pinned or drawn to their
                       ///< rest positions
  std::vector<Block> blocks_;
  std::vector<BonePin> pins_;
  std::vector<uint32_t> order_;  ///< strands in the order of StrandOrder
  mutable Memory memory_;
  size_t rows_ = 0;  ///< number of rows of each table
  Table rest_local_{3}, pbd_{kPbdPlanes}, contacts_{3};
};

extern template class BlockStore<float>;
extern template class BlockStore<double>;

/// Rest edges of one strand as in kRestEdge: edge i in the Bishop frame of edge i - 1, whose z axis is that
/// edge; edge 0 in the root frame. `rest_local` and `edges` have one entry per vertex of the strand; the last
/// of `edges` is zero.
void restEdges(std::span<const Vec3> rest_local, std::span<Vec3> edges);

/// Parts of a step of a block of strands, in the order of its sweeps (core/rod_sweep.inl,
/// core/gauss_seidel_sweep.inl), for operation counts.
enum class StepPart : uint8_t {
  kOther,    ///< once per step: properties of strands, grooming rows; roots; control flow
  kPredict,  ///< inertial points; rod: tangents and parallel transport of frames
  kTwist,    ///< rod: joint strains, elimination of twist
  kBend,  ///< rod: substitution of twist, forces, elimination of bending; gauss_seidel: angular constraints
  kMove,  ///< rod: substitution of bending, elimination of lengths; gauss_seidel: distances, tethers
  kTensions,  ///< rod: substitution of lengths; tension increments with the dense metric or by elimination
  kSecondLengthPass,  ///< rod: second elimination of lengths, with the dense metric or near a body
  kVelocities,        ///< exact lengths, velocities
  kContact,           ///< contact queries, contact solves, penetration resolution
};
constexpr int kStepParts = 9;

/// Marks the code from here to the end of the scope as a part of the step; the innermost scope counts. This
/// one does nothing; bench/step_bench.cc shadows it with one that counts operations.
struct [[maybe_unused]] StepScope {
  StepPart part;
};

}  // namespace strandcast
