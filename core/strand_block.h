#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

#include "core/backend.h"

namespace strandcast {

/// Memory aligned for the widest vector loads.
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

constexpr int kBlockPlanes = 17;  ///< numbers per vertex that every step of the rod needs

/// Vectors in a table of their own: [vertex][3][lane]. Equals null where there is none.
template <class Scalar>
struct VectorRows {
  Scalar* first;
  bool operator==(std::nullptr_t) const { return first == nullptr; }
};

/// One block: [vertex][plane][lane] for what is per vertex, so that a sweep along the strands is one stream
/// through memory; [plane][lane] for the roots. A lane is a strand; the loop runs along it. Lanes past the
/// last strand hold copies of it and are not read back. What not every step needs is in tables of its own,
/// which are null where nobody does (BlockStore::expect).
template <class Scalar>
struct BlockView {
  int vertices;
  bool pinned;       ///< some vertex but the roots is
  bool uniform;      ///< the edges of each strand have one length, its vertices but root and tip one mass
  Scalar* position;  ///< 3 planes, m
  Scalar* velocity;  ///< 3 planes, m/s
  const Scalar* rest_length;  ///< 1 plane, m, of edge (i, i + 1)
  // Of the rod: edge (i, i + 1) and the joint before it at row i. See StrandModel for units.
  Scalar* frame;              ///< 4 planes, x y z w, world
  Scalar* tension;            ///< 1 plane
  const Scalar* rest_strain;  ///< 3 planes
  const Scalar* bend;         ///< 1 plane
  const Scalar* twist;        ///< 1 plane
  const Scalar* sizes;        ///< [row][kSizePlanes][lane]: see sizeRow()
  const Scalar* root;  ///< 14 planes: position and rotation x y z w at the start of the step, then at its end
  bool factors;        ///< some factor of the strands is not 1
  const Scalar* grooming;                 ///< [vertex][kGroomingPlanes][lane]; null where there is none
  const Scalar* bone_pins;                ///< [vertex][kBonePinPlanes][lane]; null where there is none
  const Scalar* rest_distance;            ///< [vertex][lane], m, see StrandModel; null where there is none
  VectorRows<const Scalar> rest_local;    ///< m, in the root frame
  const Scalar* course;                   ///< [vertex][kCoursePlanes][lane]: of gauss_seidel
  VectorRows<Scalar> contact;             ///< of the rod among bodies, see StrandState::contacts
  VectorRows<const Scalar> acceleration;  ///< m/s^2; null where StepInput has none
  uint32_t neighbourhood;                 ///< of StrandOrder, of all its strands
};

constexpr int kRootPlanes = 14;

/// Planes of BlockView::sizes: of the edge behind vertex i, and of vertex i.
enum SizePlane : int {
  kInverseLength,  ///< 1/m, bounded where an edge is much shorter than its strand's mean
  kMass,           ///< of StrandModel; large where pinned
  kWeight,         ///< 1 / mass, 0 where pinned
  kSizePlanes
};
/// Their row for vertex i. A uniform block has three rows for all its vertices: the root's, that of those
/// between, and the tip's.
constexpr int sizeRow(int i, int vertices, bool uniform) {
  if (!uniform) return i;
  return i + 1 == vertices ? 2 : i > 0 ? 1 : 0;
}
constexpr int sizeRows(int vertices, bool uniform) { return uniform ? 3 : vertices; }

/// Planes of BlockView::course.
enum CoursePlane : int {
  kRestEdge,         ///< 3, m: the edge at rest, in the Bishop frame of the edge before it
  kInverseMass = 3,  ///< 0 or 1
  kCoursePlanes = 4
};

/// Planes of BlockView::bone_pins, of vertices that are pinned to another bone than their root frame.
enum BonePinPlane : int {
  kBonePinned,   ///< 1, or 0 of all others
  kHeldBegin,    ///< 3, m, where the bone holds it at the start of the step
  kHeldEnd = 4,  ///< 3, at its end
  kBonePinPlanes = 7
};

/// Planes of BlockView::grooming: see StrandModel.
enum GroomingPlane : int {
  kAirDragScale,
  kGoalScale,
  kDampingScale,   ///< of the joint
  kFrictionScale,  ///< of the vertex
  kTether,         ///< m
  kGroomingPlanes
};

constexpr float kPinnedMass = 1e6f;    ///< of a vertex that the rod's bending solve must not move
constexpr float kShortestEdge = 0.1f;  ///< of the strand's mean: shorter edges bend as if they were this long

constexpr int kMostLanes = 64;  ///< strands of a block, at most

constexpr int kSolverPlanes = 22;   ///< scratch numbers per vertex of a solver,
constexpr int kPullPlanes = 29;     ///< of the pulls of stiff strands,
constexpr int kGroomingRows = 6;    ///< of core/grooming.inl
constexpr int kContactPlanes = 21;  ///< and of core/near_bodies.inl,
constexpr int kPlacedBodies = 16;   ///< which has one for each of so many bodies too, whatever the lanes

/// Scalars of scratch memory that a step of a block needs: those of its solver, of grooming, of contact, and
/// its strands' accelerations.
constexpr size_t rodScratch(int vertices, int lanes) {
  return static_cast<size_t>(kSolverPlanes) * (vertices + 2) * lanes;
}
constexpr size_t solverScratch(int vertices, int lanes) {
  return rodScratch(vertices, lanes) + static_cast<size_t>(kPullPlanes) * vertices * lanes;
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

/// The working store of the CPU backends: strands in the order of StrandOrder, cut into blocks of `lanes`
/// strands of equal count. A block is contiguous, small enough to stay in the near
/// caches through all substeps of a step.
template <class Scalar>
class BlockStore {
 public:
  /// `model` is to outlive its use here; `lanes`: 1 to kMostLanes.
  void load(const StrandModel& model, int lanes);
  /// Makes room for what steps with such settings need, and with bodies where there are some. To be called
  /// before the first of them; where there is room, it costs nothing.
  void expect(const Parameters& parameters, bool bodies);
  void upload(const StrandState& state);
  void download(StrandState& state) const;

  size_t blocks() const { return blocks_.size(); }
  int lanes() const { return lanes_; }
  int maxVertices() const { return max_vertices_; }
  /// Block b for a step: what the step gives its strands is copied into its planes, roots and where bones
  /// hold vertices, and accelerations into the end of `scratch`, which has room for blockScratch() numbers.
  /// Contact forces of bodies that are gone are forgotten.
  BlockView<Scalar> block(size_t b, const StepInput& input, Scalar* scratch);
  /// Copies the positions of block b's strands out, natural order.
  void readPositions(size_t b, std::span<Vec3> positions) const { read(b, 0, positions); }
  /// The same of velocities.
  void readVelocities(size_t b, std::span<Vec3> velocities) const { read(b, 3, velocities); }

 private:
  using Memory = std::vector<Scalar, CacheLineAllocator<Scalar>>;
  /// What not every step needs, of all blocks: [vertex][planes][lane], empty until then.
  struct Table {
    int planes;
    mutable Memory numbers{};
  };
  struct Block {
    int vertices;
    bool pinned, uniform, factors, tethers;
    uint32_t first;                    ///< in order_
    uint32_t count;                    ///< strands, at most lanes_
    size_t memory;                     ///< index of its first scalar in memory_
    size_t row;                        ///< its first in tables
    uint32_t neighbourhood;            ///< of StrandOrder
    uint32_t first_pin = 0, pins = 0;  ///< in pins_
    bool pressed = false;              ///< bodies may have left contact forces on it
  };
  static bool groomed(const Block& block) { return block.factors || block.tethers; }
  /// A vertex that is pinned to another bone than its root frame.
  struct BonePin {
    int vertex, lane;
    uint16_t bone;
    Vec3 rest;  ///< m, in the groom's frame
  };
  /// Lanes past the last strand repeat it.
  uint32_t strandOf(const Block& block, int lane) const {
    return order_[block.first + std::min(static_cast<uint32_t>(lane), block.count - 1)];
  }
  void makeRoom(Table& table) { table.numbers.resize(rows_ * table.planes * lanes_); }
  /// Calls put(strand, entry) for each lane of a table that is there; entry(plane, vertex) is the lane's.
  template <class Put>
  void forStrands(const Table& table, const Put& put);
  /// The block's in a table, null where it is empty.
  Scalar* rows(const Table& table, const Block& block) const {
    return table.numbers.empty() ? nullptr : table.numbers.data() + block.row * table.planes * lanes_;
  }
  /// Cuts blocks and makes their memory.
  void layOut();
  /// Whether lengths of its edges, and masses of its vertices, are alike: see BlockView::uniform.
  bool isEven(uint32_t strand) const;
  /// Writes what does not change of the strand in a lane.
  void setStrand(const Block& block, int lane);
  Scalar* planes(const Block& block, int plane) const;
  Scalar& number(const Block& block, int plane, int vertex, int lane) const;
  Scalar* roots(const Block& block) const;
  Scalar* sizes(const Block& block) const;
  Scalar* grooming(const Block& block) const;
  Scalar* bonePins(const Block& block) const;
  void read(size_t b, int plane, std::span<Vec3> out) const;
  void setInput(Block& block, const StepInput& input);
  void setAccelerations(const Block& block, const StepInput& input, Scalar* out) const;
  void forgetContacts(Block& block);
  Scalar* restDistance(const Block& block) const;

  int lanes_ = 1;
  int max_vertices_ = 0;
  const StrandModel* model_ = nullptr;
  bool held_ = false;  ///< vertices may be drawn to their places in the rest shape, whatever the settings
  std::vector<Block> blocks_;
  std::vector<BonePin> pins_;
  std::vector<uint32_t> order_;  ///< strands, as StrandOrder has them
  mutable Memory memory_;
  size_t rows_ = 0;  ///< of each table
  Table rest_local_{3}, course_{kCoursePlanes}, contacts_{3};
};

extern template class BlockStore<float>;
extern template class BlockStore<double>;

/// Rest edges of one strand as kRestEdge wants them: edge i in the Bishop frame of edge i - 1,
/// whose z axis is that edge; edge 0 in the root frame. `rest_local` and `edges` have as many entries as the
/// strand has vertices; the last of `edges` is zero.
void restEdges(std::span<const Vec3> rest_local, std::span<Vec3> edges);

}  // namespace strandcast
