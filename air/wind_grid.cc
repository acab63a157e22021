#include "air/wind_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "kernels/scalar_grid.h"

namespace strandcast {
template <class Scalar>
WindGrid<Scalar>::WindGrid(const GridPasses<Scalar>& passes, const Workers& workers, int cells, float cell,
                           Border border)
    : passes_(passes),
      workers_(workers),
      shape_{cells},
      cell_(cell),
      box_(cells, cell),
      border_(border),
      solver_(passes, workers, cells) {
  for (int axis = 0; axis < 3; ++axis)
    for (GridArray<Scalar>* array : {&velocity_[axis], &next_[axis], &displacement_[axis], &onward_[axis]})
      array->assign(shape_.size(), Scalar(0));
  for (GridArray<Scalar>& array : exchange_) array.assign(shape_.size(), Scalar(0));
  for (GridArray<Scalar>* array : {&pressure_, &right_}) array->assign(shape_.size(), Scalar(0));
  centre_.assign(4 * shape_.size(), Scalar(0));
  const size_t row = static_cast<size_t>(cells);
  places_.assign(3 * (row + 16) * row, Scalar(0));  // one row per layer, for concurrent layers
  sampled_.assign(4 * row * row, Scalar(0));
  fastest_.assign(row + 1, Scalar(0));
  exchanges_.assign(row * row, 0);
  solid_.assign(shape_.size(), 0);
  closed_ = solid_;
  solid_cells_.reserve(row * row * row);
  solid_velocity_.assign(shape_.size(), Vec3::Zero());
}

template <class Scalar>
WindView<Scalar> WindGrid<Scalar>::view() {
  const size_t start = shape_.at(0, 0, 0);
  WindView<Scalar> view{};
  view.shape = shape_;
  for (int axis = 0; axis < 3; ++axis) {
    view.velocity[axis] = velocity_[axis].data() + start;
    view.next[axis] = next_[axis].data() + start;
    view.displacement[axis] = displacement_[axis].data() + start;
    view.onward[axis] = onward_[axis].data() + start;
  }
  for (int c = 0; c < 4; ++c) view.exchange[c] = exchange_[c].data() + start;
  for (int c = 0; c < 6 && !slip_[c].empty(); ++c) view.slip[c] = slip_[c].data() + start;
  view.centre = centre_.data() + 4 * start;
  if (border_ == Border::kOpen) {
    view.ambient = this;
    view.ambient_velocity = &ambientVelocity;
  }
  return view;
}

template <class Scalar>
Scalar WindGrid<Scalar>::ambientVelocity(const void* self, int axis, const Scalar* place) {
  const WindGrid& grid = *static_cast<const WindGrid*>(self);
  Vec3 at;
  for (int a = 0; a < 3; ++a) at[a] = static_cast<float>(place[a]) + (a == axis ? 0.0f : 0.5f);
  return static_cast<Scalar>(grid.ambient_.at(grid.origin() + at * grid.cell_)[axis]);
}

template <class Scalar>
void WindGrid<Scalar>::setComponents(const Component& value) {
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < layersOf(axis); ++k)
      for (int j = 0; j < shape_.cells + (axis == 1); ++j)
        for (int i = 0; i < shape_.cells + (axis == 0); ++i)
          velocity_[axis][shape_.at(i, j, k)] = static_cast<Scalar>(value(axis, i, j, k));
  computeCentres();
}

template <class Scalar>
void WindGrid<Scalar>::reset() {
  std::fill(pressure_.begin(), pressure_.end(), Scalar(0));
  if (border_ == Border::kOpen) setVelocity([&](const Vec3& point) { return ambient_.at(point); });
}

template <class Scalar>
void WindGrid<Scalar>::centreAt(const Vec3& middle) {
  const Eigen::Vector3i shift = box_.centreAt(middle);
  if (shift.isZero()) return;
  target_divergence_valid_ = false;
  auto carry = [&](GridArray<Scalar>& field, GridArray<Scalar>& to, int axis) {
    const int end[3] = {shape_.cells + (axis == 0), shape_.cells + (axis == 1), shape_.cells + (axis == 2)};
    workers_.forEach(end[2], [&](int k) {
      for (int j = 0; j < end[1]; ++j)
        for (int i = 0; i < end[0]; ++i) {
          const int from[3] = {i + shift.x(), j + shift.y(), k + shift.z()};
          bool known = true;
          for (int a = 0; a < 3; ++a) known = known && from[a] >= 0 && from[a] < end[a];
          Scalar& out = to[shape_.at(i, j, k)];
          if (known)
            out = field[shape_.at(from[0], from[1], from[2])];
          else
            out = axis < 3 && border_ == Border::kOpen
                      ? static_cast<Scalar>(ambient_.at(placeOf(axis, i, j, k))[axis])
                      : Scalar(0);
        }
    });
    std::swap(field, to);
  };
  for (int axis = 0; axis < 3; ++axis) carry(velocity_[axis], next_[axis], axis);
  carry(pressure_, right_, 3);
  computeCentres();
}

template <class Scalar>
void WindGrid<Scalar>::clearSolids() {
  for (const uint32_t c : solid_cells_) solid_[c] = 0;
  solid_cells_.clear();
}

template <class Scalar>
void WindGrid<Scalar>::addSolids(std::span<const MovingPrimitive> bodies, std::span<const uint32_t> words,
                                 double seconds) {
  const Eigen::Vector3f low = origin(),
                        size = Eigen::Vector3f::Constant(cell_ * static_cast<float>(shape_.cells));
  for (const MovingPrimitive& body : bodies) {
    const Vec3 a(body.a_end), a_before(body.a_begin), spin(body.angular_velocity);
    const Box box = Box(low, low + size).intersection(sweptBox(body));
    const Vec3 motion = (a - a_before) / static_cast<float>(seconds);
    addSolid(
        box,
        [&](std::span<const Vec3> points, float* out) {
          passes_.distances(body, words.data(), points.data()->data(), points.size(), out);
        },
        [&](const Vec3& point) { return Vec3(motion + spin.cross(point - a)); });
  }
}

// Faces of solid cells get the velocity of the solid. The pressure system is rebuilt only when the set of
// solid cells changes.
template <class Scalar>
void WindGrid<Scalar>::closeFaces() {
  const int n = shape_.cells;
  const bool open_border = border_ == Border::kOpen;
  const bool changed = solid_ != closed_;
  if (changed || !built_) {
    for (int axis = 0; axis < 3; ++axis) {
      Scalar* open = solver_.open(axis) - shape_.at(0, 0, 0);
      workers_.forEach(layersOf(axis), [&, axis, open](int k) {
        for (int j = 0; j < n + (axis == 1); ++j)
          for (int i = 0; i < n + (axis == 0); ++i) {
            const int at[3] = {i, j, k};
            const size_t c = shape_.at(i, j, k), before = c - shape_.next(axis);
            const bool first = at[axis] == 0, last = at[axis] == n;
            const bool solid_before = !first && solid_[before] != 0, solid_after = !last && solid_[c] != 0;
            const bool wall = (first || last) && !open_border;
            open[c] = wall || solid_before || solid_after ? Scalar(0) : Scalar(1);
          }
      });
    }
    solver_.build();
    closed_ = solid_;
    built_ = true;
  }
  for (const uint32_t c : solid_cells_)
    for (int axis = 0; axis < 3; ++axis) {
      const size_t after = c + shape_.next(axis);
      velocity_[axis][c] = static_cast<Scalar>(solid_velocity_[c][axis]);
      if (solid_[after] == 0) velocity_[axis][after] = static_cast<Scalar>(solid_velocity_[c][axis]);
    }
  if (open_border) return;
  for (int axis = 0; axis < 3; ++axis)
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        for (const int side : {0, n}) {
          int at[3] = {a, a, a};
          at[axis] = side;
          at[(axis + 2) % 3] = b;
          velocity_[axis][shape_.at(at[0], at[1], at[2])] = 0;
        }
}

template <class Scalar>
void WindGrid<Scalar>::setSources(std::span<const WindSource> sources) {
  drivers_.clear();
  spheres_.clear();
  for (const WindSource& source : sources)
    (source.kind == WindSource::Kind::kSphere ? spheres_ : drivers_).push_back(onGrid(source, cell_));
  target_divergence_valid_ = false;
}

template <class Scalar>
const Scalar* WindGrid<Scalar>::targetDivergence() {
  if (spheres_.empty() || border_ == Border::kClosed) return nullptr;
  if (!target_divergence_valid_) {
    target_divergence_.assign(shape_.size(), Scalar(0));
    for (const WindSource& source : spheres_) {
      const SphereOnGrid sphere(source, origin(), cell_);
      const Eigen::Vector3i first = sphere.first(shape_.cells), last = sphere.last(shape_.cells);
      workers_.forEach(std::max(0, last.z() - first.z() + 1), [&](int layer) {
        const int k = first.z() + layer;
        for (int j = first.y(); j <= last.y(); ++j)
          for (int i = first.x(); i <= last.x(); ++i)
            target_divergence_[shape_.at(i, j, k)] += static_cast<Scalar>(sphere.outflow(i, j, k));
      });
    }
    target_divergence_valid_ = true;
  }
  return target_divergence_.data() + shape_.at(0, 0, 0);
}

template <class Scalar>
const Scalar* WindGrid<Scalar>::targetDivergenceAmongSolids() {
  const Scalar* all = targetDivergence();
  if (all == nullptr || solid_cells_.empty()) return all;
  target_divergence_among_solids_.resize(shape_.size());
  workers_.forEach(shape_.cells, [&](int k) {
    for (int j = 0; j < shape_.cells; ++j)
      for (int i = 0; i < shape_.cells; ++i) {
        const size_t c = shape_.at(i, j, k);
        const bool blows =
            target_divergence_[c] != 0 &&
            seesBorder(shape_.cells, i, j, k, [&](int x, int y, int z) { return isSolid(x, y, z); });
        target_divergence_among_solids_[c] = blows ? target_divergence_[c] : Scalar(0);
      }
  });
  return target_divergence_among_solids_.data() + shape_.at(0, 0, 0);
}

template <class Scalar>
Scalar WindGrid<Scalar>::maxTargetDivergence(const Scalar* target_divergence, int k) const {
  const Scalar* fluid = solver_.finest().diagonal;
  Scalar most = 0;
  for (int j = 0; j < shape_.cells; ++j)
    for (int i = 0; i < shape_.cells; ++i) {
      const size_t c = shape_.at(i, j, k) - shape_.at(0, 0, 0);
      if (fluid[c] > 0) most = std::max(most, std::fabs(target_divergence[c]));
    }
  return most;
}

template <class Scalar>
template <class Work>
void WindGrid<Scalar>::eachFace(const Work& work) const {
  workers_.forEach(shape_.cells + 1, [&](int k) {
    for (int axis = 0; axis < 3; ++axis)
      if (k < layersOf(axis)) work(axis, k);
  });
}

template <class Scalar>
void WindGrid<Scalar>::computeCentres() {
  const WindView<Scalar> w = view();
  workers_.forEach(shape_.cells, [&](int k) { passes_.centre(w, k); });
}

template <class Scalar>
void WindGrid<Scalar>::advect(double seconds, bool mac_cormack) {
  const WindView<Scalar> w = view();
  const Scalar courant = static_cast<Scalar>(seconds / static_cast<double>(cell_));
  workers_.forEach(shape_.cells, [&](int k) {
    passes_.displace(w, courant, w.displacement, k);
    if (mac_cormack) passes_.displace(w, -courant, w.onward, k);
  });
  eachFace([&](int axis, int k) { passes_.advect(w, axis, k); });
  for (int axis = 0; mac_cormack && axis < 3; ++axis) {
    Scalar* corrected = right_.data() + shape_.at(0, 0, 0);
    workers_.forEach(layersOf(axis), [&](int k) { passes_.correct(w, axis, corrected, k); });
    std::swap(next_[axis], right_);
  }
  for (int axis = 0; axis < 3; ++axis) std::swap(velocity_[axis], next_[axis]);
  if (mac_cormack) std::fill(right_.begin(), right_.end(), Scalar(0));
}

template <class Scalar>
void WindGrid<Scalar>::diffuse(double seconds, double viscosity) {
  const double whole = viscosity * seconds / (static_cast<double>(cell_) * static_cast<double>(cell_));
  const int steps = static_cast<int>(std::ceil(whole / kLargestPart));
  for (int step = 0; step < steps; ++step) {
    const WindView<Scalar> w = view();
    // A row writes its own padding, which no other row reads, so layers may run concurrently.
    eachFace([&](int axis, int k) { passes_.diffuse(w, axis, static_cast<Scalar>(whole / steps), k); });
    for (int axis = 0; axis < 3; ++axis) std::swap(velocity_[axis], next_[axis]);
  }
}

template <class Scalar>
std::pair<int, int> WindGrid<Scalar>::cellsInHair(const HairDrag<Scalar>& hair, const Scalar* at,
                                                  const Scalar* step) const {
  double first = 0, last = shape_.cells - 1;
  for (int c = 0; c < 3; ++c) {
    const double here = static_cast<double>(at[c]), per_cell = static_cast<double>(step[c]);
    const double low = hair.box.min()[c] - 1, high = hair.box.max()[c] + 1;
    if (std::fabs(per_cell) < 1e-6) {  // the row moves by less than 1e-3 cells on this axis
      if (here < low - 1e-3 || here > high + 1e-3) return {0, 0};
      continue;
    }
    const double a = (low - here) / per_cell, b = (high - here) / per_cell;
    first = std::max(first, std::floor(std::min(a, b)));
    last = std::min(last, std::ceil(std::max(a, b)));
  }
  return first > last ? std::pair(0, 0) : std::pair(static_cast<int>(first), static_cast<int>(last) + 1);
}

template <class Scalar>
void WindGrid<Scalar>::reserveSlip() {
  for (GridArray<Scalar>& array : slip_) array.resize(shape_.size());
}

template <class Scalar>
void WindGrid<Scalar>::computeExchangeWithHair(double seconds, const HairDrag<Scalar>& hair, size_t from,
                                               size_t count, const Scalar* places, Scalar* sampled) {
  const size_t stride = static_cast<size_t>(shape_.cells) + 16;
  const Scalar rate = static_cast<Scalar>(seconds) * hair.rate, slips = rate * hair.less;
  passes_.sample(*hair.shape, hair.nodes, places, stride, count, sampled);
  for (size_t c = 0; c < 4; ++c)
    for (size_t i = 0; i < count; ++i) exchange_[c][from + i] = rate * sampled[4 * i + (c + 3) % 4];
  if (hair.slip[0] == nullptr) return;
  passes_.sample(*hair.shape, hair.slip[0], places, stride, count, sampled);
  for (size_t i = 0; i < count; ++i) {
    for (size_t c = 0; c < 3; ++c) exchange_[1 + c][from + i] -= slips * sampled[4 * i + c];
    slip_[0][from + i] = slips * sampled[4 * i + 3];
  }
  passes_.sample(*hair.shape, hair.slip[1], places, stride, count, sampled);
  for (size_t i = 0; i < count; ++i) {
    slip_[1][from + i] = slips * sampled[4 * i];
    // t is a unit vector, so the trace of m t t' is m: zz follows from xx and yy.
    slip_[2][from + i] = hair.less * exchange_[0][from + i] - slip_[0][from + i] - slip_[1][from + i];
    for (size_t c = 3; c < 6; ++c) slip_[c][from + i] = slips * sampled[4 * i + c - 2];
  }
}

template <class Scalar>
void WindGrid<Scalar>::computeExchange(double seconds, const HairDrag<Scalar>& hair,
                                       const Scalar* target_divergence, int j, int k, Scalar* places,
                                       Scalar* sampled) {
  const int n = shape_.cells;
  const size_t row = static_cast<size_t>(n), first = shape_.at(0, j, k);
  uint8_t& exchanges = exchanges_[row * static_cast<size_t>(k) + static_cast<size_t>(j)];
  if (exchanges != 0) {
    auto clear = [&](GridArray<Scalar>& array) { std::fill_n(array.data() + first, n, Scalar(0)); };
    for (GridArray<Scalar>& array : exchange_) clear(array);
    for (GridArray<Scalar>& array : slip_)
      if (!array.empty()) clear(array);
  }
  exchanges = 0;
  const Vec3 begin = placeOf(3, 0, j, k);
  if (hair.nodes != nullptr && !hair.box.isEmpty()) {
    Scalar at[3], step[3];
    for (int c = 0; c < 3; ++c) {
      const Scalar* f = hair.frame + 3 * c;
      at[c] = f[0] * static_cast<Scalar>(begin.x()) + f[1] * static_cast<Scalar>(begin.y()) +
              f[2] * static_cast<Scalar>(begin.z()) + hair.frame[9 + c];
      step[c] = f[0] * static_cast<Scalar>(cell_);
    }
    const auto [low, high] = cellsInHair(hair, at, step);
    if (low < high) {
      const size_t count = static_cast<size_t>(high - low), from = first + static_cast<size_t>(low);
      for (int c = 0; c < 3; ++c)
        for (int i = low; i < high; ++i)
          places[static_cast<size_t>(c) * (row + 16) + static_cast<size_t>(i - low)] =
              at[c] + step[c] * static_cast<Scalar>(i);
      computeExchangeWithHair(seconds, hair, from, count, places, sampled);
      exchanges = 1;
    }
  }
  if (target_divergence != nullptr) {
    const double courant = seconds / static_cast<double>(cell_);
    const Scalar* of_row = target_divergence + (first - shape_.at(0, 0, 0));
    for (size_t i = 0; i < row; ++i) {
      if (!(of_row[i] > 0)) continue;
      exchanges = 1;
      exchange_[0][first + i] +=
          static_cast<Scalar>(kernels::f64::sphereExchange(static_cast<double>(of_row[i]), courant));
    }
  }
  for (const WindSource& source : drivers_) {
    const Box reach = source.reach();
    if (begin.y() < reach.min().y() || begin.y() > reach.max().y() || begin.z() < reach.min().z() ||
        begin.z() > reach.max().z())
      continue;
    exchanges = 1;
    for (int i = 0; i < n; ++i) {
      Vec3 velocity;
      if (!source.velocityAt(placeOf(3, i, j, k), velocity)) continue;
      const float rate = source.rate * static_cast<float>(seconds);
      exchange_[0][first + static_cast<size_t>(i)] += static_cast<Scalar>(rate);
      for (int c = 0; c < 3; ++c)
        exchange_[1 + c][first + static_cast<size_t>(i)] += static_cast<Scalar>(rate * velocity[c]);
    }
  }
}

template <class Scalar>
void WindGrid<Scalar>::exchange(double seconds, const HairDrag<Scalar>& hair) {
  const Scalar* of_spheres = targetDivergence();
  if (hair.nodes == nullptr && drivers_.empty() && of_spheres == nullptr) return;
  const size_t row = static_cast<size_t>(shape_.cells);
  workers_.forEach(shape_.cells, [&](int k) {
    Scalar *places = places_.data() + 3 * (row + 16) * static_cast<size_t>(k),
           *sampled = sampled_.data() + 4 * row * static_cast<size_t>(k);
    for (int j = 0; j < shape_.cells; ++j) computeExchange(seconds, hair, of_spheres, j, k, places, sampled);
  });
  const WindView<Scalar> w = view();
  if (hair.slip[0] != nullptr) {
    computeCentres();
    eachFace([&](int axis, int k) { passes_.exchangeAmong(w, axis, k); });
  } else {
    eachFace([&](int axis, int k) { passes_.exchange(w, axis, k); });
  }
}

template <class Scalar>
double WindGrid<Scalar>::fastest() const {
  double most = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < layersOf(axis); ++k)
      for (int j = 0; j < shape_.cells + (axis == 1); ++j)
        for (int i = 0; i < shape_.cells + (axis == 0); ++i)
          most = std::max(most, std::fabs(static_cast<double>(velocity_[axis][shape_.at(i, j, k)])));
  return most;
}

template <class Scalar>
PressureReport WindGrid<Scalar>::project() {
  closeFaces();
  WindView<Scalar> w = view();
  w.target_divergence = targetDivergenceAmongSolids();
  const PressureView<Scalar>& p = solver_.finest();
  const size_t start = shape_.at(0, 0, 0);
  Scalar *right = right_.data() + start, *pressure = pressure_.data() + start;
  workers_.forEach(shape_.cells + 1, [&](int k) {
    if (k < shape_.cells) passes_.outflow(w, p, right, k);
    fastest_[k] = passes_.fastest(w, k);
    if (w.target_divergence != nullptr && k < shape_.cells)
      fastest_[k] = std::max(
          fastest_[k], static_cast<Scalar>(kMinFaceShare) * maxTargetDivergence(w.target_divergence, k));
  });
  const double fastest = static_cast<double>(*std::max_element(fastest_.begin(), fastest_.end()));
  const double tolerance = std::max(kResidual * fastest, kStill);
  const PressureReport report =
      solver_.solve(right, pressure, static_cast<Scalar>(tolerance), kMaxPressureIterations);
  eachFace([&](int axis, int k) { passes_.subtractGradient(w, p, pressure, axis, k); });
  computeCentres();
  return report;
}

template <class Scalar>
double WindGrid<Scalar>::largestOutflow() {
  const size_t start = shape_.at(0, 0, 0);
  WindView<Scalar> w = view();
  w.target_divergence = targetDivergenceAmongSolids();
  double most = 0;
  for (int k = 0; k < shape_.cells; ++k) {
    passes_.outflow(w, solver_.finest(), right_.data() + start, k);
    for (int j = 0; j < shape_.cells; ++j)
      for (int i = 0; i < shape_.cells; ++i)
        most = std::max(most, std::fabs(static_cast<double>(right_[shape_.at(i, j, k)])));
  }
  return most;
}

template <class Scalar>
Vec3 WindGrid<Scalar>::velocityAt(const Vec3& point) const {
  const Vec3 at = (point - origin()) / cell_ - Vec3::Constant(0.5f);
  constexpr size_t kStride = 16;
  Scalar place[3 * kStride] = {}, out[4];
  for (int c = 0; c < 3; ++c) place[kStride * static_cast<size_t>(c)] = static_cast<Scalar>(at[c]);
  passes_.sample(shape_, centres(), place, kStride, 1, out);
  return {static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2])};
}

template class WindGrid<float>;
template class WindGrid<double>;

}  // namespace strandcast
