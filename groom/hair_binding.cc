#include "groom/hair_binding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>

#include "core/error.h"
#include "groom/neighbors.h"

namespace strandcast {
namespace {

constexpr size_t kCandidates = 12;
constexpr size_t kPlaces = 9;       // along a hair, at which it is compared with guides
constexpr float kFarLonger = 3;     // hair to guide
constexpr float kSameHair = 1e-8f;  // m^2, added to squared distances; bounds the weight of a guide

/// Points of a strand at increasing arc lengths.
class ArcWalk {
 public:
  explicit ArcWalk(std::span<const Vec3> points) : points_(points) {}
  /// `place`: m from the root, not below that of the call before. The tip beyond the strand's end.
  Vec3 at(float place) {
    while (next_ < points_.size()) {
      const Vec3 edge = points_[next_] - points_[next_ - 1];
      const float length = edge.norm();
      if (place <= run_ + length)
        return length > 0 ? Vec3(points_[next_ - 1] + edge * ((place - run_) / length)) : points_[next_];
      run_ += length;
      ++next_;
    }
    return points_.back();
  }

 private:
  std::span<const Vec3> points_;
  size_t next_ = 1;
  float run_ = 0;  // m, to the vertex before next_
};

using Places = std::array<Vec3, kPlaces>;

/// Points at equal parts of the first `length` m of a strand.
Places placesAlong(std::span<const Vec3> points, float length) {
  ArcWalk walk(points);
  Places places;
  for (size_t i = 0; i < kPlaces; ++i)
    places[i] = walk.at(length * (static_cast<float>(i) / static_cast<float>(kPlaces - 1)));
  return places;
}

class Binder {
 public:
  explicit Binder(const StrandSet& guides) : guides_(guides) {
    std::map<uint16_t, std::vector<uint32_t>> members;
    std::vector<uint32_t> all(guides.strands());
    std::iota(all.begin(), all.end(), 0u);
    for (uint32_t g = 0; g < guides.strands(); ++g) {
      roots_.push_back(guides.strand(g).front());
      courses_.push_back(courseOf(guides.strand(g)));
      if (!guides.parts.empty()) members[guides.parts[g]].push_back(g);
    }
    all_.emplace(roots_, std::move(all));
    for (auto& [part, of_part] : members)
      if (of_part.size() >= std::tuple_size_v<decltype(HairBinding::guides)>)
        parts_.try_emplace(part, roots_, std::move(of_part));
  }

  /// `part`: null where the hairs have no parts.
  HairBinding bind(std::span<const Vec3> hair, const uint16_t* part) {
    const auto own = part ? parts_.find(*part) : parts_.end();
    const RootTree& tree = own != parts_.end() ? own->second : *all_;
    const float length = arcLength(hair);
    const Places places = placesAlong(hair, length);
    candidates_.clear();
    for (const uint32_t g : tree.nearest(hair.front(), kCandidates)) {
      if (std::ranges::equal(hair, guides_.strand(g))) return {{g, g, g}, {0, 0}};
      const Places beside = placesAlong(guides_.strand(g), std::min(length, courses_[g].length));
      float sum = 0;
      for (size_t i = 0; i < kPlaces; ++i) sum += (places[i] - beside[i]).squaredNorm();
      candidates_.push_back({length > kFarLonger * courses_[g].length, sum / static_cast<float>(kPlaces), g});
    }
    std::sort(candidates_.begin(), candidates_.end());
    return weigh();
  }

 private:
  struct Candidate {
    bool is_short;  // far shorter than the hair
    float squared;  // m^2, distance of hair and guide
    uint32_t guide;
    auto operator<=>(const Candidate&) const = default;
  };

  /// Of candidates_, the least distances first.
  HairBinding weigh() const {
    const uint32_t first = candidates_.front().guide;
    HairBinding binding{{first, first, first}, {0, 0}};
    std::array<float, 3> weights{1 / (candidates_.front().squared + kSameHair)};
    size_t taken = 1;
    for (size_t c = 1; c < candidates_.size() && taken < weights.size(); ++c) {
      const auto [is_short, squared, g] = candidates_[c];
      if (is_short != candidates_.front().is_short || isParting(courses_[first], courses_[g])) continue;
      binding.guides[taken] = g;
      weights[taken++] = 1 / (squared + kSameHair);
    }
    const float sum = weights[0] + weights[1] + weights[2];
    for (size_t k = 1; k < taken; ++k) {
      // Not above half and a third of 255, because the weights descend.
      binding.weights[k - 1] = static_cast<uint8_t>(std::lround(255 * (weights[k] / sum)));
      if (binding.weights[k - 1] == 0) binding.guides[k] = first;
    }
    return binding;
  }

  const StrandSet& guides_;
  std::vector<Vec3> roots_;
  std::vector<StrandCourse> courses_;
  std::optional<RootTree> all_;
  std::map<uint16_t, RootTree> parts_;  // of the parts that have enough guides
  std::vector<Candidate> candidates_;
};

}  // namespace

std::vector<HairBinding> bindHairs(const StrandSet& hairs, const StrandSet& guides) {
  std::vector<HairBinding> bindings;
  if (hairs.strands() == 0) return bindings;
  if (guides.strands() == 0)
    throw Error("hairs have no guides to follow", std::to_string(hairs.strands()) + " hairs",
                "choose at least one guide");
  Binder binder(guides);
  bindings.reserve(hairs.strands());
  for (size_t s = 0; s < hairs.strands(); ++s)
    bindings.push_back(binder.bind(hairs.strand(s), hairs.parts.empty() ? nullptr : &hairs.parts[s]));
  return bindings;
}

std::vector<uint32_t> orderByGuide(std::span<const HairBinding> bindings) {
  std::vector<uint32_t> order(bindings.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return bindings[a].guides[0] < bindings[b].guides[0]; });
  return order;
}

}  // namespace strandcast
