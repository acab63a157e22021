#include "core/strand_block.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/strand_order.h"

namespace strandcast {
namespace {

// Planes of a block, in this order.
enum Plane {
  kPosition = 0,
  kVelocity = 3,
  kRestLocal = 6,
  kRestEdge = 9,
  kRestLength = 12,
  kInverseMass = 13,
  kFrame = 14,
  kTension = 18,
  kRestStrain = 19,
  kInverseLength = 22,
  kBend = 23,
  kTwist = 24,
  kMass = 25,
  kWeight = 26,
  kContact = 27,
};
static_assert(kContact + 3 == kBlockPlanes);

constexpr float kAlike = 2e-6f;  // relative, of lengths and of masses that count as equal

}  // namespace

void restEdges(std::span<const Vec3> rest_local, std::span<Vec3> edges) {
  Eigen::Quaterniond frame = Eigen::Quaterniond::Identity();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitZ();
  for (size_t i = 0; i + 1 < rest_local.size(); ++i) {
    const Eigen::Vector3d edge = (rest_local[i + 1] - rest_local[i]).cast<double>();
    edges[i] = (frame.conjugate() * edge).cast<float>();
    const Eigen::Vector3d next = edge.norm() > 0 ? Eigen::Vector3d(edge.normalized()) : tangent;
    frame = (shortestRotation<double>(tangent, next) * frame).normalized();
    tangent = next;
  }
  edges[rest_local.size() - 1].setZero();
}

template <class Scalar>
Scalar* BlockStore<Scalar>::planes(const Block& block, int plane) const {
  return memory_.data() + block.memory + static_cast<size_t>(plane) * lanes_;
}
template <class Scalar>
Scalar& BlockStore<Scalar>::number(const Block& block, int plane, int vertex, int lane) const {
  return planes(block, plane)[static_cast<size_t>(vertex) * kBlockPlanes * lanes_ + lane];
}
template <class Scalar>
Scalar* BlockStore<Scalar>::roots(const Block& block) const {
  return planes(block, 0) + static_cast<size_t>(block.vertices) * kBlockPlanes * lanes_;
}
template <class Scalar>
Scalar* BlockStore<Scalar>::grooming(const Block& block) const {
  return roots(block) + static_cast<size_t>(kRootPlanes) * lanes_;
}

template <class Scalar>
Scalar* BlockStore<Scalar>::bonePins(const Block& block) const {
  const int planes_before = groomed(block) ? kGroomingPlanes : 0;
  return grooming(block) + static_cast<size_t>(planes_before) * block.vertices * lanes_;
}

template <class Scalar>
Scalar* BlockStore<Scalar>::restDistance(const Block& block) const {
  const int planes_before = block.pins > 0 ? kBonePinPlanes : 0;
  return bonePins(block) + static_cast<size_t>(planes_before) * block.vertices * lanes_;
}

template <class Scalar>
void BlockStore<Scalar>::load(const StrandModel& model, int lanes) {
  lanes_ = lanes;
  offsets_ = model.offsets;
  blocks_.clear();
  pins_.clear();
  max_vertices_ = 0;
  rest_distance_ = !model.rest_distance.empty();
  StrandOrder order = strandOrder(model);
  order_ = std::move(order.strands);
  size_t memory = 0, accelerations = 0;
  for (size_t first = 0; first < order_.size();) {
    const int vertices = static_cast<int>(model.verticesOf(order_[first]));
    size_t count = 0;
    while (count < static_cast<size_t>(lanes) && first + count < order_.size() &&
           model.verticesOf(order_[first + count]) == static_cast<size_t>(vertices))
      ++count;
    bool factors = false, tethers = false;
    for (size_t i = 0; i < count; ++i) {
      factors = factors || model.hasFactors(order_[first + i]);
      tethers = tethers || model.hasTethers(order_[first + i]);
    }
    blocks_.push_back({vertices, false, true, factors, tethers, first, count, memory,
                       order.neighbourhood_of[order_[first]], pins_.size()});
    Block& block = blocks_.back();
    for (int lane = 0; lane < lanes; ++lane) {
      const uint32_t strand = order_[first + std::min<size_t>(lane, count - 1)];
      for (int i = 1; i < vertices; ++i) {
        const uint32_t v = offsets_[strand] + i;
        if (model.isBonePinned(strand, v))
          pins_.push_back({i, lane, model.pin_bones[v], model.restPosition(strand, v)});
      }
    }
    block.pins = pins_.size() - block.first_pin;
    const int planes_of_vertex = kBlockPlanes + (groomed(block) ? kGroomingPlanes : 0) +
                                 (block.pins > 0 ? kBonePinPlanes : 0) + (rest_distance_ ? 1 : 0);
    memory += static_cast<size_t>(planes_of_vertex * vertices + kRootPlanes) * lanes;
    memory = (memory + 15) / 16 * 16;
    block.acceleration = accelerations;
    accelerations += (static_cast<size_t>(3 * vertices) * lanes + 15) / 16 * 16;
    max_vertices_ = std::max(max_vertices_, vertices);
    first += count;
  }
  memory_.assign(memory, Scalar(0));
  acceleration_numbers_ = accelerations;
  accelerations_ = {};

  std::array<Vec3, kMaxVerticesPerStrand> edges;
  for (Block& block : blocks_) {
    for (int lane = 0; lane < lanes_; ++lane) {
      const uint32_t strand = order_[block.first + std::min<size_t>(lane, block.count - 1)];
      const std::span<const Vec3> rest(model.rest_local.data() + offsets_[strand], block.vertices);
      restEdges(rest, edges);
      const float mean_length = arcLength(rest) / static_cast<float>(block.vertices - 1);
      for (int i = 0; i < block.vertices; ++i) {
        auto put = [&](int plane, float value) {
          number(block, plane, i, lane) = static_cast<Scalar>(value);
        };
        for (int c = 0; c < 3; ++c) put(kRestLocal + c, rest[i][c]);
        for (int c = 0; c < 3; ++c) put(kRestEdge + c, edges[i][c]);
        const uint32_t v = offsets_[strand] + i;
        const float length = i + 1 < block.vertices ? (rest[i + 1] - rest[i]).norm() : 0.0f;
        const bool pinned = model.inverse_mass[v] == 0;
        put(kRestLength, length);
        put(kInverseMass, model.inverse_mass[v]);
        for (int c = 0; c < 3; ++c) put(kRestStrain + c, model.rest_strain[v][c]);
        put(kInverseLength, 1 / std::max(length, kShortestEdge * mean_length));
        put(kBend, model.bend[v]);
        put(kTwist, model.twist[v]);
        put(kMass, pinned ? kPinnedMass : model.mass[v]);
        put(kWeight, pinned ? 0.0f : 1 / model.mass[v]);
        if (i > 0) block.pinned = block.pinned || pinned;
        if (rest_distance_)
          restDistance(block)[static_cast<size_t>(i) * lanes_ + lane] =
              static_cast<Scalar>(model.rest_distance[v]);
        if (groomed(block)) {
          Scalar* factors = grooming(block) + static_cast<size_t>(i) * kGroomingPlanes * lanes_ + lane;
          factors[kAirDragScale * lanes_] = static_cast<Scalar>(model.air_drag_scale[v]);
          factors[kGoalScale * lanes_] = static_cast<Scalar>(model.goal_scale[v]);
          factors[kDampingScale * lanes_] = static_cast<Scalar>(model.damping_scale[strand]);
          factors[kFrictionScale * lanes_] = static_cast<Scalar>(model.friction_scale[strand]);
          factors[kTether * lanes_] = static_cast<Scalar>(model.tether[v]);
        }
      }
      // Lengths and masses of a strand that was resampled evenly differ by rounding only: then they are made
      // equal, so that one row of them may stand for all.
      auto alike = [&](int plane, int row, int first_row) {
        const Scalar one = number(block, plane, first_row, lane);
        return std::abs(number(block, plane, row, lane) - one) <= Scalar(kAlike) * one;
      };
      bool even = true;
      for (int i = 1; i + 1 < block.vertices; ++i)
        even = even && alike(kRestLength, i, 0) && alike(kMass, i, 1);
      for (int i = 1; even && i + 1 < block.vertices; ++i) {
        for (const int plane : {kRestLength, kInverseLength})
          number(block, plane, i, lane) = number(block, plane, 0, lane);
        for (const int plane : {kMass, kWeight})
          number(block, plane, i, lane) = number(block, plane, 1, lane);
      }
      block.uniform = block.uniform && even;
    }
  }
}

template <class Scalar>
void BlockStore<Scalar>::upload(const StrandState& state) {
  for (Block& block : blocks_) {
    block.pressed = !state.contacts.empty();
    for (int lane = 0; lane < lanes_; ++lane) {
      const uint32_t strand = order_[block.first + std::min<size_t>(lane, block.count - 1)];
      for (int i = 0; i < block.vertices; ++i) {
        for (int c = 0; c < 3; ++c) {
          number(block, kPosition + c, i, lane) =
              static_cast<Scalar>(state.positions[offsets_[strand] + i][c]);
          number(block, kVelocity + c, i, lane) =
              static_cast<Scalar>(state.velocities[offsets_[strand] + i][c]);
        }
        const uint32_t v = offsets_[strand] + i;
        const Quat frame = state.frames.empty() ? Quat(Quat::Identity()) : state.frames[v];
        for (int c = 0; c < 4; ++c)
          number(block, kFrame + c, i, lane) = static_cast<Scalar>(frame.coeffs()[c]);
        number(block, kTension, i, lane) =
            state.tensions.empty() ? Scalar(0) : static_cast<Scalar>(state.tensions[v]);
        for (int c = 0; c < 3; ++c)
          number(block, kContact + c, i, lane) =
              state.contacts.empty() ? Scalar(0) : static_cast<Scalar>(state.contacts[v][c]);
      }
    }
  }
}

template <class Scalar>
void BlockStore<Scalar>::download(StrandState& state) const {
  state.positions.resize(offsets_.back());
  state.velocities.resize(offsets_.back());
  state.frames.resize(offsets_.back());
  state.tensions.resize(offsets_.back());
  state.contacts.resize(offsets_.back());
  for (size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    readPositions(b, state.positions);
    for (size_t lane = 0; lane < block.count; ++lane) {
      const uint32_t first = offsets_[order_[block.first + lane]];
      for (int i = 0; i < block.vertices; ++i) {
        auto get = [&](int plane) {
          return static_cast<float>(number(block, plane, i, static_cast<int>(lane)));
        };
        for (int c = 0; c < 3; ++c) state.velocities[first + i][c] = get(kVelocity + c);
        for (int c = 0; c < 4; ++c) state.frames[first + i].coeffs()[c] = get(kFrame + c);
        state.tensions[first + i] = get(kTension);
        for (int c = 0; c < 3; ++c) state.contacts[first + i][c] = get(kContact + c);
      }
    }
  }
}

template <class Scalar>
void BlockStore<Scalar>::read(size_t b, int plane, std::span<Vec3> vectors) const {
  static_assert(kPosition == 0 && kVelocity == 3);
  const Block& block = blocks_[b];
  for (size_t lane = 0; lane < block.count; ++lane) {
    Vec3* out = vectors.data() + offsets_[order_[block.first + lane]];
    for (int i = 0; i < block.vertices; ++i)
      for (int c = 0; c < 3; ++c)
        out[i][c] = static_cast<float>(number(block, plane + c, i, static_cast<int>(lane)));
  }
}

template <class Scalar>
void BlockStore<Scalar>::forgetContacts(Block& block) {
  for (int i = 0; i < block.vertices; ++i)
    std::fill_n(&number(block, kContact, i, 0), static_cast<size_t>(3) * lanes_, Scalar(0));
  block.pressed = false;
}

template <class Scalar>
void BlockStore<Scalar>::setInput(size_t b, const StepInput& input) {
  Block& block = blocks_[b];
  const bool pressing = input.parameters->solver == SolverKind::kRod && !input.primitives.empty();
  if (!pressing && block.pressed) forgetContacts(block);
  block.pressed = pressing;
  Scalar* root = roots(block);
  for (int lane = 0; lane < lanes_; ++lane) {
    const uint32_t strand = order_[block.first + std::min<size_t>(lane, block.count - 1)];
    Scalar* plane = root + lane;
    for (const Pose* pose : {&input.roots_begin[strand], &input.roots_end[strand]}) {
      for (int c = 0; c < 3; ++c, plane += lanes_) *plane = static_cast<Scalar>(pose->position[c]);
      for (int c = 0; c < 4; ++c, plane += lanes_) *plane = static_cast<Scalar>(pose->rotation.coeffs()[c]);
    }
  }
  for (size_t i = block.first_pin; i < block.first_pin + block.pins; ++i) {
    const BonePin& pin = pins_[i];
    Scalar* row = bonePins(block) + static_cast<size_t>(pin.vertex) * kBonePinPlanes * lanes_ + pin.lane;
    const Vec3 begin = input.bones_begin[pin.bone].apply(pin.rest),
               end = input.bones_end[pin.bone].apply(pin.rest);
    row[static_cast<size_t>(kBonePinned) * lanes_] = Scalar(1);
    for (int c = 0; c < 3; ++c) {
      row[static_cast<size_t>(kHeldBegin + c) * lanes_] = static_cast<Scalar>(begin[c]);
      row[static_cast<size_t>(kHeldEnd + c) * lanes_] = static_cast<Scalar>(end[c]);
    }
  }
  block.accelerated = !input.accelerations.empty() && !accelerations_.empty();
  if (!block.accelerated) return;
  for (int lane = 0; lane < lanes_; ++lane) {
    const uint32_t strand = order_[block.first + std::min<size_t>(lane, block.count - 1)];
    const Vec3* in = input.accelerations.data() + offsets_[strand];
    Scalar* out = accelerations_.data() + block.acceleration + lane;
    for (int i = 0; i < block.vertices; ++i)
      for (int c = 0; c < 3; ++c, out += lanes_) *out = static_cast<Scalar>(in[i][c]);
  }
}

template <class Scalar>
BlockView<Scalar> BlockStore<Scalar>::block(size_t b) {
  const Block& block = blocks_[b];
  return {block.vertices,
          block.pinned,
          block.uniform,
          planes(block, kPosition),
          planes(block, kVelocity),
          planes(block, kRestLocal),
          planes(block, kRestEdge),
          planes(block, kRestLength),
          planes(block, kInverseMass),
          planes(block, kFrame),
          planes(block, kTension),
          planes(block, kContact),
          planes(block, kRestStrain),
          planes(block, kInverseLength),
          planes(block, kBend),
          planes(block, kTwist),
          planes(block, kMass),
          planes(block, kWeight),
          roots(block),
          block.pins > 0 ? bonePins(block) : nullptr,
          block.factors,
          groomed(block) ? grooming(block) : nullptr,
          block.accelerated ? accelerations_.data() + block.acceleration : nullptr,
          rest_distance_ ? restDistance(block) : nullptr,
          block.neighbourhood};
}

template class BlockStore<float>;
template class BlockStore<double>;

}  // namespace strandcast
