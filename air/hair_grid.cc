#include "air/hair_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/hash.h"
#include "kernels/scalar_grid.h"

namespace strandcast {
namespace {

constexpr size_t kMaxSumBytes = size_t{1} << 28;  // limit of all chunks' sums together
constexpr int kMaxSampleChunks = 16;

NodeBox grown(const NodeBox& box) {
  return box.isEmpty() ? box
                       : NodeBox(box.min() - Eigen::Vector3i::Ones(), box.max() + Eigen::Vector3i::Ones());
}

/// Clears the nodes of `numbers` numbers in `box`. `array`: a whole array of the grid.
template <class Array>
void clear(const GridShape& shape, size_t numbers, const NodeBox& box, Array* array) {
  if (box.isEmpty()) return;
  const size_t row = numbers * static_cast<size_t>(box.sizes().x() + 1);
  for (int k = box.min().z(); k <= box.max().z(); ++k)
    for (int j = box.min().y(); j <= box.max().y(); ++j)
      std::fill_n(array + numbers * shape.at(box.min().x(), j, k), row, 0);
}

}  // namespace

template <class Scalar>
HairGrid<Scalar>::HairGrid(const GridPasses<Scalar>& passes, const Workers& workers, const StrandModel& model,
                           int cells, const Box& box)
    : passes_(passes),
      workers_(workers),
      shape_{cells},
      origin_(shape_.at(0, 0, 0)),
      layout_(hairLayout(box, cells)) {
  samples_ = strandSamples(model, layout_.cell);
  for (const StrandSample& sample : samples_.samples) mass_ += sample.mass;
  const size_t bytes = 5 * sizeof(int32_t) * shape_.size();
  chunks_ = std::clamp<size_t>(kMaxSumBytes / bytes, 1, std::min(workers.threads(), kMaxSampleChunks));
  sums_.resize(chunks_);
  number_sums_.resize(chunks_);
  for (auto& sum : sums_) sum.resize(4 * shape_.size());
  for (auto& sum : number_sums_) sum.resize(shape_.size());
  reach_.resize(chunks_);
  const size_t padded = (samples_.samples.size() + 15) / 16 * 16 + 16;
  places_.assign(kPlacePlanes * padded, Scalar(0));
  motion_.assign(4 * padded, Scalar(0));
  masses_.assign(padded, Scalar(0));
  for (size_t n = 0; n < samples_.samples.size(); ++n)
    masses_[n] = static_cast<Scalar>(samples_.samples[n].mass);
  drag_shares_ = dragShares(model, samples_);
  if (!drag_shares_.of_samples.empty()) {
    drag_nodes_.assign(4 * shape_.size(), Scalar(0));
    drag_masses_ = masses_;
    for (size_t n = 0; n < samples_.samples.size(); ++n)
      drag_masses_[n] *= static_cast<Scalar>(drag_shares_.of_samples[n]);
  }
  view_.stride = padded;
  for (GridArray<Scalar>* array : {&nodes_, &spread_, &scratch4_, &changes_})
    array->assign(4 * shape_.size(), Scalar(0));
  for (GridArray<Scalar>* array : {&density_, &crowding_, &crowded_, &scratch_})
    array->assign(shape_.size(), Scalar(0));
  for (GridArray<Scalar>* array : {&rest_density_, &held_, &largest_crowding_})
    array->assign(padded, Scalar(0));
  computeRestDensity(model);
}

template <class Scalar>
void HairGrid<Scalar>::computeRestDensity(const StrandModel& model) {
  std::vector<Vec3> positions(model.vertices()), velocities(model.vertices(), Vec3::Zero());
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      positions[v] = model.restPosition(s, v);
  locate(positions, velocities, Pose{});
  splat();
  blurDensity(blurBox(false, false));
  passes_.sampleNumbers(view_, 0, samples_.samples.size(), density_.data() + origin_, rest_density_.data());
}

template <class Scalar>
void HairGrid<Scalar>::computeCrowdingBounds(float volume_target) {
  const double alone = kDensityAlone / std::pow(static_cast<double>(layout_.cell), 3);
  bound_target_ = volume_target;
  crowding_bound_ = 0;
  for (size_t n = 0; n < samples_.samples.size(); ++n) {
    const double mass = samples_.samples[n].mass;
    const double rest = static_cast<double>(rest_density_[n]) / static_cast<double>(volume_target);
    const double most = kernels::f64::largestCrowding(rest, alone * mass);
    largest_crowding_[n] = static_cast<Scalar>(most);
    crowding_bound_ += mass * most * (1 + kMaxHeldCrowding);
  }
}

// Crowding is evaluated per sample, so it is exactly 0 where hair has its rest density. A node gets the mean
// of its samples.
template <class Scalar>
void HairGrid<Scalar>::computeCrowding(const Parameters& p, double stiffness, double seconds,
                                       const NodeBox& box) {
  if (bound_target_ != p.volume_target) computeCrowdingBounds(p.volume_target);
  const double scale = kWhole / (stiffness * crowding_bound_);
  const CrowdView<Scalar> crowd{
      density_.data() + origin_,
      rest_density_.data(),
      held_.data(),
      largest_crowding_.data(),
      static_cast<Scalar>((1 + kDensityNoise) / static_cast<double>(p.volume_target)),
      static_cast<Scalar>(stiffness),
      static_cast<Scalar>(static_cast<double>(p.volume_hold) * seconds),
      static_cast<Scalar>(scale)};
  workers_.forEach(static_cast<int>(chunks_), [&](int c) {
    clear(shape_, 1, box, number_sums_[c].data());
    passes_.crowd(view_, firstOf(c), firstOf(c + 1), crowd, number_sums_[c].data() + origin_);
  });
  const Scalar back = static_cast<Scalar>(1 / (scale * std::pow(static_cast<double>(layout_.cell), 3)));
  eachLayer(box, [&](int k) {
    for (int j = box.min().y(); j <= box.max().y(); ++j) {
      const size_t last = shape_.at(box.max().x(), j, k);
      int32_t* sum = number_sums_[0].data();
      for (size_t i = shape_.at(box.min().x(), j, k); i <= last; ++i) {
        for (size_t c = 1; c < chunks_; ++c) sum[i] += number_sums_[c][i];
        crowded_[i] = back * static_cast<Scalar>(sum[i]);
        crowding_[i] = sum[i] > 0 && nodes_[4 * i + 3] > 0 ? crowded_[i] / nodes_[4 * i + 3] : Scalar(0);
      }
    }
  });
}

template <class Scalar>
void HairGrid<Scalar>::reset() {
  std::fill(held_.begin(), held_.end(), Scalar(0));
}

template <class Scalar>
void HairGrid<Scalar>::moveOrigin(const Vec3& way) {
  head_.position -= way;
  layout_.frame(head_, frame_);
}

template <class Scalar>
void HairGrid<Scalar>::locate(std::span<const Vec3> positions, std::span<const Vec3> velocities,
                              const Pose& head, double seconds) {
  head_ = head;
  layout_.frame(head, frame_);
  SplatView<Scalar>& view = view_;
  view.shape = shape_;
  std::copy(frame_, frame_ + 12, view.frame);
  view.positions = positions.data()->data();
  view.velocities = velocities.data()->data();
  view.ahead = static_cast<Scalar>(seconds);
  view.samples = samples_.samples.data();
  view.shares = samples_.shares.data();
  view.masses = masses_.data();
  view.places = places_.data();
  view.motion = motion_.data();
  workers_.forEach(static_cast<int>(chunks_),
                   [&](int c) { reach_[c] = passes_.place(view, firstOf(c), firstOf(c + 1)); });
}

template <class Scalar>
void HairGrid<Scalar>::splat() {
  SplatView<Scalar>& view = view_;
  double fastest = 1e-6;
  NodeBox box;
  for (const SplatReach<Scalar>& reach : reach_) {
    fastest = std::max(fastest, static_cast<double>(reach.fastest));
    if (reach.low[0] > reach.high[0]) continue;
    for (const Scalar* corner : {reach.low, reach.high}) {
      const Eigen::Vector3i node = Eigen::Map<const Eigen::Array<Scalar, 3, 1>>(corner).template cast<int>();
      box.extend(node).extend(Eigen::Vector3i(node + Eigen::Vector3i::Ones()));
    }
  }
  const NodeBox changed = filled_.merged(box);
  filled_ = box;
  view.mass_scale = static_cast<Scalar>(kWhole / mass_);
  view.momentum_scale = static_cast<Scalar>(kWhole / (mass_ * fastest));
  splatNodes(view, changed, nodes_);
}

template <class Scalar>
void HairGrid<Scalar>::splatDrag() {
  if (drag_shares_.of_samples.empty()) return;
  SplatView<Scalar> view = view_;
  view.masses = drag_masses_.data();
  splatNodes(view, drag_filled_.merged(filled_), drag_nodes_);
  drag_filled_ = filled_;
}

template <class Scalar>
void HairGrid<Scalar>::reserveSlip() {
  for (GridArray<Scalar>& numbers : slip_of_samples_) numbers.resize(motion_.size());
  for (GridArray<Scalar>& nodes : slip_nodes_) nodes.resize(4 * shape_.size());
}

template <class Scalar>
void HairGrid<Scalar>::splatSlip(std::span<const Vec3> positions) {
  workers_.forEach(static_cast<int>(chunks_), [&](int c) {
    for (size_t n = firstOf(c); n < firstOf(c + 1); ++n) {
      const StrandSample& sample = samples_.samples[n];
      const Vec3 chord = positions[sample.vertex + sample.count - 1] - positions[sample.vertex];
      const kernels::f32::real3 t = kernels::f32::directionOfPiece({chord.x(), chord.y(), chord.z()});
      const Scalar x = static_cast<Scalar>(t.x), y = static_cast<Scalar>(t.y), z = static_cast<Scalar>(t.z);
      const Scalar* v = velocity(n);
      const Scalar along = x * v[0] + y * v[1] + z * v[2];
      const Scalar parts[2][4] = {{x * along, y * along, z * along, x * x}, {y * y, y * z, x * z, x * y}};
      for (size_t part = 0; part < 2; ++part)
        std::copy_n(parts[part], 4, slip_of_samples_[part].begin() + static_cast<ptrdiff_t>(4 * n));
    }
  });
  const NodeBox changed = slip_filled_.merged(filled_);
  slip_filled_ = filled_;
  SplatView<Scalar> view = view_;
  if (!drag_masses_.empty()) view.masses = drag_masses_.data();
  for (size_t part = 0; part < 2; ++part) {
    view.motion = slip_of_samples_[part].data();
    if (part == 1) view.momentum_scale = view.mass_scale;
    splatNodes(view, changed, slip_nodes_[part]);
  }
}

template <class Scalar>
void HairGrid<Scalar>::splatNodes(const SplatView<Scalar>& view, const NodeBox& box,
                                  GridArray<Scalar>& nodes) {
  workers_.forEach(static_cast<int>(chunks_), [&](int c) {
    clear(shape_, 4, box, sums_[c].data());
    passes_.splat(view, firstOf(c), firstOf(c + 1), sums_[c].data() + 4 * origin_);
  });
  const Scalar volume = static_cast<Scalar>(layout_.cell) * static_cast<Scalar>(layout_.cell) *
                        static_cast<Scalar>(layout_.cell);
  const Scalar density = 1 / (view.mass_scale * volume), flow = 1 / (view.momentum_scale * volume);
  eachLayer(box, [&](int k) {
    for (int j = box.min().y(); j <= box.max().y(); ++j) {
      const size_t first = shape_.at(box.min().x(), j, k), end = shape_.at(box.max().x(), j, k) + 1;
      int32_t* sum = sums_[0].data();
      for (size_t c = 1; c < chunks_; ++c)
        for (size_t i = 4 * first; i < 4 * end; ++i) sum[i] += sums_[c][i];
      for (size_t i = first; i < end; ++i) {
        for (size_t c = 0; c < 3; ++c) nodes[4 * i + c] = flow * static_cast<Scalar>(sum[4 * i + c]);
        nodes[4 * i + 3] = density * static_cast<Scalar>(sum[4 * i + 3]);
      }
    }
  });
}

template <class Scalar>
float HairGrid<Scalar>::densityAtPoint(const Vec3& point) const {
  int node[3];
  for (int r = 0; r < 3; ++r) {
    double at = static_cast<double>(frame_[9 + r]);
    for (int c = 0; c < 3; ++c) at += static_cast<double>(frame_[3 * r + c]) * static_cast<double>(point[c]);
    if (!(at > -0.5 && at < shape_.cells - 0.5)) return 0;
    node[r] = static_cast<int>(std::lround(at));
  }
  return static_cast<float>(nodes_[4 * shape_.at(node[0], node[1], node[2]) + 3]);
}

template <class Scalar>
uint64_t HairGrid<Scalar>::splatHash() const {
  ContentHash hash;
  for (const auto* sum : {&sums_[0], &number_sums_[0]}) hash.add(sum->data(), sum->size() * sizeof(int32_t));
  return hash.value();
}

template <class Scalar>
template <class Work>
void HairGrid<Scalar>::eachLayer(const NodeBox& box, const Work& work) const {
  if (box.isEmpty()) return;
  const int first = box.min().z();
  workers_.forEach(box.max().z() - first + 1, [&](int layer) { work(first + layer); });
}

template <class Scalar>
NodeBox HairGrid<Scalar>::blurBox(bool crowds, bool rubs) {
  NodeBox box = grown(blurred_.merged(filled_));
  // Fields that were not blurred for some steps hold values at former positions of the hair: blur everywhere.
  if (crowds != had_crowding_ || rubs != had_friction_)
    box = NodeBox(Eigen::Vector3i::Zero(), Eigen::Vector3i::Constant(shape_.cells - 1));
  blurred_ = filled_;
  had_crowding_ = crowds;
  had_friction_ = rubs;
  return box;
}

// Samples keep two nodes from the border of the grid, so a box grown by one node stays inside.
template <class Scalar>
void HairGrid<Scalar>::blur(int numbers, const NodeBox& box, GridArray<Scalar>& field) {
  const size_t start = origin_ * static_cast<size_t>(numbers);
  GridArray<Scalar>& scratch = numbers == 4 ? scratch4_ : scratch_;
  Scalar *a = field.data() + start, *b = scratch.data() + start;
  eachLayer(box, [&](int k) {
    passes_.blur(shape_, numbers, 0, box, a, b, k);
    passes_.blur(shape_, numbers, 1, box, b, a, k);
  });
  eachLayer(box, [&](int k) { passes_.blur(shape_, numbers, 2, box, a, b, k); });
  std::swap(field, scratch);
}

template <class Scalar>
void HairGrid<Scalar>::blurDensity(const NodeBox& box) {
  eachLayer(box, [&](int k) {
    for (int j = box.min().y(); j <= box.max().y(); ++j) {
      const size_t last = shape_.at(box.max().x(), j, k);
      for (size_t i = shape_.at(box.min().x(), j, k); i <= last; ++i) density_[i] = nodes_[4 * i + 3];
    }
  });
  blur(1, box, density_);
}

template <class Scalar>
void HairGrid<Scalar>::computeForces(const Parameters& p, double seconds) {
  const bool crowds = p.volume_stiffness > 0, rubs = p.hair_friction > 0;
  const NodeBox box = blurBox(crowds, rubs);
  blurDensity(box);
  const double stiffness =
      std::min(static_cast<double>(p.volume_stiffness), layout_.largestStiffness(seconds));
  HairView<Scalar> view{};
  view.shape = shape_;
  view.nodes = nodes();
  view.density = density_.data() + origin_;
  view.changes = changes_.data() + 4 * origin_;
  if (rubs) {
    view.spread = spread_.data() + 4 * origin_;
    eachLayer(box, [&](int k) { passes_.spread(view, box, k); });
    blur(4, box, spread_);
    view.spread = spread_.data() + 4 * origin_;
    view.part = static_cast<Scalar>(1 - std::exp(-static_cast<double>(p.hair_friction) * seconds));
  }
  if (crowds) {
    computeCrowding(p, stiffness, seconds, box);
    blur(1, box, crowded_);
    view.crowding = crowding_.data() + origin_;
    view.crowded = crowded_.data() + origin_;
    view.slope = static_cast<Scalar>(-seconds / (2 * static_cast<double>(layout_.cell)));
    const Eigen::Matrix3f turn = Eigen::Quaternionf(head_.rotation).toRotationMatrix();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) view.turn[3 * r + c] = static_cast<Scalar>(turn(r, c));
  }
  eachLayer(box, [&](int k) { passes_.forces(view, box, k); });
}

template <class Scalar>
void HairGrid<Scalar>::changes(size_t begin, size_t end, Scalar* out) const {
  passes_.change(view_, changes_.data() + 4 * origin_, begin, end, out);
}

template class HairGrid<float>;
template class HairGrid<double>;

}  // namespace strandcast
