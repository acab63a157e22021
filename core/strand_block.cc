#include "core/strand_block.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/broad_phase.h"

namespace strandcast {
namespace {

// Planes of a block, in this order.
enum Plane {
  kPosition = 0,
  kVelocity = 3,
  kRestLength = 6,
  kFrame = 7,
  kTension = 11,
  kRestStrain = 12,
  kBend = 15,
  kTwist = 16,
};
static_assert(kTwist + 1 == kBlockPlanes);

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
Scalar* BlockStore<Scalar>::massData(const Block& block) const {
  return roots(block) + static_cast<size_t>(kRootPlanes) * lanes_;
}
template <class Scalar>
Scalar* BlockStore<Scalar>::grooming(const Block& block) const {
  return massData(block) +
         static_cast<size_t>(massRows(block.vertices, block.uniform)) * kMassPlanes * lanes_;
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
  model_ = &model;
  lanes_ = lanes;
  layOut();
  for (const Block& block : blocks_)
    for (int lane = 0; lane < lanes_; ++lane) setStrand(block, lane);
  held_ = std::any_of(blocks_.begin(), blocks_.end(), [](const Block& b) { return b.pinned || b.factors; });
}

template <class Scalar>
void BlockStore<Scalar>::layOut() {
  blocks_.clear();
  pins_.clear();
  max_vertices_ = 0;
  rows_ = 0;
  for (Table* table : {&rest_local_, &pbd_, &contacts_}) table->numbers = Memory();
  StrandOrder order = strandOrder(*model_);
  order_ = std::move(order.strands);
  size_t memory = 0;
  for (uint32_t first = 0; first < order_.size();) {
    const size_t vertices = model_->verticesOf(order_[first]);
    Block block{};
    block.vertices = static_cast<int>(vertices);
    block.uniform = true;
    block.first = first;
    block.memory = memory;
    block.row = rows_;
    block.neighbourhood = order.neighbourhood_of[order_[first]];
    block.first_pin = static_cast<uint32_t>(pins_.size());
    for (; block.count < static_cast<uint32_t>(lanes_) && first < order_.size() &&
           model_->verticesOf(order_[first]) == vertices;
         ++block.count, ++first) {
      const uint32_t strand = order_[first];
      block.uniform = block.uniform && isEven(strand);
      block.factors = block.factors || model_->hasFactors(strand);
      block.tethers = block.tethers || model_->hasTethers(strand);
      for (uint32_t v = model_->offsets[strand] + 1; v < model_->offsets[strand + 1]; ++v)
        block.pinned = block.pinned || model_->isPinned(strand, v);
    }
    for (int lane = 0; lane < lanes_; ++lane) {
      const uint32_t strand = strandOf(block, lane);
      for (int i = 1; i < block.vertices; ++i) {
        const uint32_t v = model_->offsets[strand] + i;
        if (model_->isBonePinned(strand, v))
          pins_.push_back({i, lane, model_->pin_bones[v], model_->restPosition(strand, v)});
      }
    }
    block.pins = static_cast<uint32_t>(pins_.size()) - block.first_pin;
    const int planes_of_vertex = kBlockPlanes + (groomed(block) ? kGroomingPlanes : 0) +
                                 (block.pins > 0 ? kBonePinPlanes : 0) +
                                 (model_->rest_distance.empty() ? 0 : 1);
    memory += static_cast<size_t>(planes_of_vertex * block.vertices + kRootPlanes +
                                  kMassPlanes * massRows(block.vertices, block.uniform)) *
              lanes_;
    rows_ += vertices;
    max_vertices_ = std::max(max_vertices_, block.vertices);
    blocks_.push_back(block);
  }
  blocks_.shrink_to_fit();
  memory_.assign(memory, Scalar(0));
}

template <class Scalar>
bool BlockStore<Scalar>::isEven(uint32_t strand) const {
  const StrandModel& model = *model_;
  const uint32_t first = model.offsets[strand], tip = model.offsets[strand + 1] - 1;
  const float tolerance = evenTolerance(model, strand);
  auto alike = [&](float number, float one) { return std::abs(number - one) <= tolerance * one; };
  const float mean = arcLength({model.rest_local.data() + first, model.verticesOf(strand)}) /
                     static_cast<float>(tip - first);
  for (uint32_t v = first; v < tip; ++v) {
    if (!alike((model.rest_local[v + 1] - model.rest_local[v]).norm(), mean)) return false;
    if (v > first && (model.isPinned(strand, v) || !alike(model.mass[v], model.mass[first + 1])))
      return false;
  }
  return true;
}

template <class Scalar>
void BlockStore<Scalar>::setStrand(const Block& block, int lane) {
  const StrandModel& model = *model_;
  const uint32_t strand = strandOf(block, lane), first = model.offsets[strand];
  const int last = block.vertices - 1;
  const std::span<const Vec3> rest(model.rest_local.data() + first, block.vertices);
  const float mean_length = arcLength(rest) / static_cast<float>(last);
  // In an evenly cut strand, mass data of vertices differ by rounding only. They are made equal,
  // independently of the other strands of the block, so that one row may serve all inner vertices. Rest
  // lengths stay exact: hair rests on them to the last digit.
  const bool even = block.uniform || isEven(strand);
  for (int i = 0; i <= last; ++i) {
    auto put = [&](int plane, float value) { number(block, plane, i, lane) = static_cast<Scalar>(value); };
    const uint32_t v = first + i;
    const float length = i < last ? (rest[i + 1] - rest[i]).norm() : 0.0f;
    put(kRestLength, length);
    for (int c = 0; c < 3; ++c) put(kRestStrain + c, model.rest_strain[v][c]);
    put(kBend, model.bend[v]);
    put(kTwist, model.twist[v]);
    const float bends_over = even && i < last ? mean_length : std::max(length, kShortestEdge * mean_length);
    const uint32_t alike = even && i > 0 && i < last ? first + 1 : v;
    const bool pinned = model.isPinned(strand, alike);
    Scalar* row = massData(block) +
                  static_cast<size_t>(massRow(i, block.vertices, block.uniform)) * kMassPlanes * lanes_ +
                  lane;
    row[kInverseLength * lanes_] = Scalar(1 / bends_over);
    row[kMass * lanes_] = Scalar(pinned ? kPinnedMass : model.mass[alike]);
    row[kWeight * lanes_] = Scalar(pinned ? 0.0f : 1 / model.mass[alike]);
    if (!model.rest_distance.empty())
      restDistance(block)[static_cast<size_t>(i) * lanes_ + lane] =
          static_cast<Scalar>(model.rest_distance[v]);
    if (groomed(block)) {
      Scalar* factors = grooming(block) + static_cast<size_t>(i) * kGroomingPlanes * lanes_ + lane;
      factors[kAirDragScale * lanes_] = static_cast<Scalar>(model.air_drag_scale[v]);
      factors[kGoalScale * lanes_] = static_cast<Scalar>(model.goal_scale[v]);
      factors[kDampingScale * lanes_] = static_cast<Scalar>(model.dampingFactor(strand, v));
      factors[kFrictionScale * lanes_] = static_cast<Scalar>(model.frictionFactor(strand, v));
      factors[kTether * lanes_] = static_cast<Scalar>(model.tether[v]);
    }
  }
}

template <class Scalar>
template <class Put>
void BlockStore<Scalar>::forStrands(const Table& table, const Put& put) {
  for (const Block& block : blocks_)
    for (int lane = 0; lane < lanes_; ++lane) {
      Scalar* numbers = rows(table, block) + lane;
      put(strandOf(block, lane), [&, numbers](int plane, uint32_t i) -> Scalar& {
        return numbers[(static_cast<size_t>(i) * table.planes + plane) * lanes_];
      });
    }
}

template <class Scalar>
void BlockStore<Scalar>::prepare(const Parameters& parameters, bool bodies) {
  const bool rod = parameters.solver == SolverKind::kRod;
  if (rod && bodies) makeRoom(contacts_);
  if ((!rod || held_ || parameters.goal_rate > 0) && rest_local_.numbers.empty()) {
    makeRoom(rest_local_);
    forStrands(rest_local_, [&](uint32_t strand, const auto& entry) {
      const uint32_t first = model_->offsets[strand];
      for (uint32_t v = first; v < model_->offsets[strand + 1]; ++v)
        for (int c = 0; c < 3; ++c) entry(c, v - first) = static_cast<Scalar>(model_->rest_local[v][c]);
    });
  }
  if (!rod && pbd_.numbers.empty()) {
    makeRoom(pbd_);
    forStrands(pbd_, [&](uint32_t strand, const auto& entry) {
      const uint32_t first = model_->offsets[strand];
      const std::span<const Vec3> rest(model_->rest_local.data() + first, model_->verticesOf(strand));
      std::array<Vec3, kMaxVerticesPerStrand> edges;
      restEdges(rest, edges);
      for (uint32_t i = 0; i < rest.size(); ++i) {
        for (int c = 0; c < 3; ++c) entry(kRestEdge + c, i) = static_cast<Scalar>(edges[i][c]);
        entry(kInverseMass, i) = Scalar(model_->isPinned(strand, first + i) ? 0 : 1);
      }
    });
  }
}

template <class Scalar>
void BlockStore<Scalar>::upload(const StrandState& state) {
  const std::vector<uint32_t>& offsets = model_->offsets;
  for (Block& block : blocks_) {
    for (int lane = 0; lane < lanes_; ++lane) {
      const uint32_t first = offsets[strandOf(block, lane)];
      for (int i = 0; i < block.vertices; ++i) {
        const uint32_t v = first + i;
        for (int c = 0; c < 3; ++c) {
          number(block, kPosition + c, i, lane) = static_cast<Scalar>(state.positions[v][c]);
          number(block, kVelocity + c, i, lane) = static_cast<Scalar>(state.velocities[v][c]);
        }
        const Quat frame = state.frames.empty() ? Quat(Quat::Identity()) : state.frames[v];
        for (int c = 0; c < 4; ++c)
          number(block, kFrame + c, i, lane) = static_cast<Scalar>(frame.coeffs()[c]);
        number(block, kTension, i, lane) =
            state.tensions.empty() ? Scalar(0) : static_cast<Scalar>(state.tensions[v]);
      }
    }
  }
  const bool pressed = std::any_of(state.contacts.begin(), state.contacts.end(),
                                   [](const Vec3& force) { return force != Vec3::Zero(); });
  for (Block& block : blocks_) block.pressed = pressed;
  if (pressed) makeRoom(contacts_);
  if (contacts_.numbers.empty()) return;
  forStrands(contacts_, [&](uint32_t strand, const auto& entry) {
    for (uint32_t v = offsets[strand]; v < offsets[strand + 1]; ++v)
      for (int c = 0; c < 3; ++c)
        entry(c, v - offsets[strand]) = pressed ? static_cast<Scalar>(state.contacts[v][c]) : Scalar(0);
  });
}

template <class Scalar>
void BlockStore<Scalar>::download(StrandState& state) const {
  const std::vector<uint32_t>& offsets = model_->offsets;
  state.positions.resize(offsets.back());
  state.velocities.resize(offsets.back());
  state.frames.resize(offsets.back());
  state.tensions.resize(offsets.back());
  state.contacts.assign(offsets.back(), Vec3::Zero());
  for (size_t b = 0; b < blocks_.size(); ++b) {
    const Block& block = blocks_[b];
    readPositions(b, state.positions);
    readVelocities(b, state.velocities);
    for (uint32_t lane = 0; lane < block.count; ++lane) {
      const uint32_t first = offsets[order_[block.first + lane]];
      const Scalar* contact = rows(contacts_, block);
      for (int i = 0; i < block.vertices; ++i) {
        auto get = [&](int plane) {
          return static_cast<float>(number(block, plane, i, static_cast<int>(lane)));
        };
        for (int c = 0; c < 4; ++c) state.frames[first + i].coeffs()[c] = get(kFrame + c);
        state.tensions[first + i] = get(kTension);
        for (int c = 0; contact != nullptr && c < 3; ++c)
          state.contacts[first + i][c] =
              static_cast<float>(contact[(static_cast<size_t>(i) * 3 + c) * lanes_ + lane]);
      }
    }
  }
}

template <class Scalar>
void BlockStore<Scalar>::read(size_t b, int plane, std::span<Vec3> vectors) const {
  static_assert(kPosition == 0 && kVelocity == 3);
  const Block& block = blocks_[b];
  Vec3* strands[kMaxLanes];
  for (size_t lane = 0; lane < block.count; ++lane)
    strands[lane] = vectors.data() + model_->offsets[order_[block.first + lane]];
  const Scalar* x = planes(block, plane);
  for (int i = 0; i < block.vertices; ++i, x += kBlockPlanes * lanes_) {
    const Scalar *y = x + lanes_, *z = y + lanes_;
    for (size_t lane = 0; lane < block.count; ++lane)
      strands[lane][i] = Eigen::Matrix<Scalar, 3, 1>(x[lane], y[lane], z[lane]).template cast<float>();
  }
}

template <class Scalar>
void BlockStore<Scalar>::clearContacts(Block& block) {
  std::fill_n(rows(contacts_, block), static_cast<size_t>(3) * block.vertices * lanes_, Scalar(0));
  block.pressed = false;
}

template <class Scalar>
void BlockStore<Scalar>::setInput(Block& block, const StepInput& input) {
  const bool pressing = input.parameters->solver == SolverKind::kRod && !input.primitives.empty();
  if (!pressing && block.pressed) clearContacts(block);
  block.pressed = pressing;
  Scalar* root = roots(block);
  for (int lane = 0; lane < lanes_; ++lane) {
    const uint32_t strand = strandOf(block, lane);
    Scalar* plane = root + lane;
    const size_t bone = model_->rootBone(strand);
    for (const Pose& on : {input.boneAtBegin(bone), input.boneAtEnd(bone)}) {
      const Pose pose = on * model_->rest_roots[strand];
      for (int c = 0; c < 3; ++c, plane += lanes_) *plane = static_cast<Scalar>(pose.position[c]);
      for (int c = 0; c < 4; ++c, plane += lanes_) *plane = static_cast<Scalar>(pose.rotation.coeffs()[c]);
    }
  }
  for (size_t i = block.first_pin; i < block.first_pin + block.pins; ++i) {
    const BonePin& pin = pins_[i];
    Scalar* row = bonePins(block) + static_cast<size_t>(pin.vertex) * kBonePinPlanes * lanes_ + pin.lane;
    const Vec3 begin = input.boneAtBegin(pin.bone).apply(pin.rest),
               end = input.boneAtEnd(pin.bone).apply(pin.rest);
    row[static_cast<size_t>(kBonePinned) * lanes_] = Scalar(1);
    for (int c = 0; c < 3; ++c) {
      row[static_cast<size_t>(kHeldBegin + c) * lanes_] = static_cast<Scalar>(begin[c]);
      row[static_cast<size_t>(kHeldEnd + c) * lanes_] = static_cast<Scalar>(end[c]);
    }
  }
}

template <class Scalar>
void BlockStore<Scalar>::setAccelerations(const Block& block, const StepInput& input, Scalar* out) const {
  const Vec3* strands[kMaxLanes];
  for (int lane = 0; lane < lanes_; ++lane)
    strands[lane] = input.accelerations.data() + model_->offsets[strandOf(block, lane)];
  for (int i = 0; i < block.vertices; ++i)
    for (int c = 0; c < 3; ++c, out += lanes_)
      for (int lane = 0; lane < lanes_; ++lane) out[lane] = static_cast<Scalar>(strands[lane][i][c]);
}

template <class Scalar>
BlockView<Scalar> BlockStore<Scalar>::block(size_t b, const StepInput& input, Scalar* scratch) {
  Block& block = blocks_[b];
  setInput(block, input);
  Scalar* accelerations = nullptr;
  if (!input.accelerations.empty()) {
    accelerations =
        scratch + blockScratch(block.vertices, lanes_) - accelerationScratch(block.vertices, lanes_);
    setAccelerations(block, input, accelerations);
  }
  return {block.vertices,
          block.pinned,
          block.uniform,
          planes(block, kPosition),
          planes(block, kVelocity),
          planes(block, kRestLength),
          planes(block, kFrame),
          planes(block, kTension),
          planes(block, kRestStrain),
          planes(block, kBend),
          planes(block, kTwist),
          massData(block),
          roots(block),
          block.factors,
          groomed(block) ? grooming(block) : nullptr,
          block.pins > 0 ? bonePins(block) : nullptr,
          model_->rest_distance.empty() ? nullptr : restDistance(block),
          {rows(rest_local_, block)},
          rows(pbd_, block),
          {rows(contacts_, block)},
          {accelerations},
          block.neighbourhood};
}

template class BlockStore<float>;
template class BlockStore<double>;

}  // namespace strandcast
