#include "groom/procedural_groom.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/hash.h"
#include "core/smooth_step.h"
#include "groom/procedural_body.h"

namespace strandcast {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// m, least distance from the skin of all points of a strand except its root.
constexpr float kClearance = 0.0004f;
constexpr float kPart = 0.012f;  // m, x of the parting
/// Edge lengths of winding strand after which an edge is led straight outward.
constexpr float kWinding = 12;
const Vec3 kTie(0, 0.022f, -0.122f);  // m, centre of the ponytail's tie
const Vec3 kTieAxis = Vec3(0, 0.25f, -1).normalized();

// Pseudo-random numbers in [0, 1) determined by a seed and a stream.
class Random {
 public:
  Random(uint64_t seed, uint64_t stream) : state_(splitMix64(seed) ^ splitMix64(~stream)) {}
  float uniform() { return static_cast<float>(splitMix64(state_++) >> 40) * 0x1p-24f; }
  float between(float low, float high) { return low + (high - low) * uniform(); }

 private:
  uint64_t state_;
};

float smooth(float low, float high, float x) { return smoothStep((x - low) / (high - low)); }
Vec3 unit(const Vec3& v) {
  const float length = v.norm();
  return length > 1e-9f ? Vec3(v / length) : Vec3(0, -1, 0);
}
Vec3 along(const Vec3& v, const Vec3& normal) { return v - normal * v.dot(normal); }

// Obstacles of the hair: the skin, and a smooth shell over each ear, whose folds are too fine to comb over.
const Vec3 kEar(0.0755f, -0.023f, -0.011f), kEarRadii(0.0135f, 0.034f, 0.021f);
float earDistance(const Vec3& p) {
  const Vec3 q = (Vec3(std::fabs(p.x()), p.y(), p.z()) - kEar).cwiseQuotient(kEarRadii);
  const float k0 = q.norm(), k1 = q.cwiseQuotient(kEarRadii).norm();
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -kEarRadii.minCoeff();
}
float obstacleDistance(const Vec3& p) { return std::min(bodyDistance(p), earDistance(p)); }
Vec3 obstacleNormal(const Vec3& p) {
  if (bodyDistance(p) <= earDistance(p)) return bodyNormal(p);
  const Vec3 q = (Vec3(std::fabs(p.x()), p.y(), p.z()) - kEar).cwiseQuotient(kEarRadii.cwiseAbs2());
  return unit(Vec3(p.x() < 0 ? -q.x() : q.x(), q.y(), q.z()));
}

struct Root {
  Vec3 position;
  Vec3 normal;
};

// Evenly spread points of the scalp: a golden-ratio (R2) sequence on the sphere, shifted by the seed,
// stretched to the cranium, projected to the skin along its normals, and thinned by the density of hair.
class Scalp {
 public:
  explicit Scalp(uint64_t seed)
      : seed_(seed), shift_u_(Random(seed, 1).uniform()), shift_v_(Random(seed, 2).uniform()) {}

  Root next() {
    for (;;) {
      const uint64_t i = index_++;
      Random random(seed_, 16 + i);
      const double u = shift_u_ + 0.7548776662466927 * static_cast<double>(i);
      const double v = shift_v_ + 0.5698402909980532 * static_cast<double>(i);
      const float turn = 2 * kPi * static_cast<float>(u - std::floor(u));
      const float y = 2 * static_cast<float>(v - std::floor(v)) - 1;
      const float ring = std::sqrt(std::max(0.0f, 1 - y * y));
      const Vec3 start(0.095f * ring * std::sin(turn), 0.012f + 0.11f * y,
                       0.115f * ring * std::cos(turn) - 0.01f);
      if (start.y() < -0.09f) continue;
      Root root = onSkin(start);
      if (random.uniform() < scalpDensity(root.position) && std::fabs(bodyDistance(root.position)) < 1e-5f)
        return root;
    }
  }

 private:
  static Root onSkin(Vec3 p) {
    Vec3 normal = bodyNormal(p);
    for (int i = 0; i < 12; ++i) {
      const float d = bodyDistance(p);
      if (std::fabs(d) < 2e-6f) break;
      p -= normal * d;
      normal = bodyNormal(p);
    }
    return {p, normal};
  }

  uint64_t seed_;
  double shift_u_, shift_v_;
  uint64_t index_ = 0;
};

// Parameters that vary from strand to strand.
struct Character {
  float lift = 0;        // m, distance of the combed centre line from the scalp
  float length = 0;      // m, along the strand
  float amplitude = 0;   // m, of waves or curls
  float wavelength = 1;  // m, along the centre line
  float phase = 0;       // rad
  float flatness = 1;    // 1 = helix, less = wave in one plane
  float ramp = 0.03f;    // m, length over which waves and curls begin
};

// Strands with roots in the same grid cell form a lock: they share the phase of their waves.
Random lockRandom(const Vec3& root, float cell, uint64_t seed) {
  uint64_t key = 7;
  for (int c = 0; c < 3; ++c)
    key = splitMix64(key + static_cast<uint64_t>(static_cast<int64_t>(std::floor(root[c] / cell)) + 4096));
  return Random(seed ^ 0x10c4u, key);
}

Character characterOf(const Root& root, const ProceduralGroomOptions& options, Random& random) {
  Character c;
  const float high = smooth(-0.05f, 0.1f, root.position.y());  // upper hair lies over lower hair
  c.lift = 0.0015f + 0.007f * high * random.between(0.3f, 1) + 0.003f * random.uniform();
  c.length = options.length * random.between(0.9f, 1);
  c.wavelength = 0.05f;
  if (options.style == HairStyle::kWavy) {
    Random lock = lockRandom(root.position, 0.016f, options.seed);
    c.amplitude = lock.between(0.0055f, 0.0085f) * random.between(0.85f, 1.1f);
    c.wavelength = lock.between(0.055f, 0.07f);
    c.phase = 2 * kPi * lock.uniform() + random.between(-0.4f, 0.4f);
    c.flatness = 0.45f;
    c.lift += 0.004f;
    c.ramp = 0.06f;
  } else if (options.style == HairStyle::kCurly) {
    Random lock = lockRandom(root.position, 0.014f, options.seed);
    c.amplitude = lock.between(0.008f, 0.012f) * random.between(0.9f, 1.1f);
    c.wavelength = lock.between(0.026f, 0.036f);
    c.phase = 2 * kPi * lock.uniform() + random.between(-0.35f, 0.35f);
    c.lift += 0.008f + 0.010f * random.uniform();
    c.ramp = 0.025f;
  } else if (options.style == HairStyle::kPonytail) {
    c.lift = 0.0015f + 0.004f * random.uniform();
  }
  return c;
}

// Traces one strand from its root and places vertices at equal chords.
class Grower {
 public:
  Grower(const Root& root, const Character& character, const ProceduralGroomOptions& options, Random& random)
      : root_(root),
        character_(character),
        ponytail_(options.style == HairStyle::kPonytail),
        centre_(root.position) {
    side_ = root.position.x() > kPart ? 1.0f : -1.0f;
    if (std::fabs(root.position.x() - kPart) < 0.002f) side_ = random.uniform() < 0.5f ? 1.0f : -1.0f;
    const Vec3 spoke = along(root.position - kTie, kTieAxis);
    slot_ = kTie + unit(spoke) * (0.009f * std::sqrt(random.uniform()));
    spread_ = Vec3(random.between(-1, 1), random.between(-0.3f, 0.3f), random.between(-1, 0.6f)) * 0.22f;
    distance_ = 0;
    normal_ = root.normal;
    direction_ = unit(along(comb(), normal_) + 0.7f * normal_);
    if (ponytail_) direction_ = unit(unit(along(comb(), normal_)) + 0.7f * normal_);
    across_ = unit(direction_.cross(normal_));
  }

  // Adds vertices at distance `edge` from each other until there are `count`.
  void grow(int count, float edge, std::vector<Vec3>& out) {
    out.assign(1, root_.position);
    const float step = std::clamp(edge / 4, 0.0002f, 0.0022f);
    Vec3 before = root_.position;
    float since = 0;  // m, along the strand since the newest vertex
    while (static_cast<int>(out.size()) < count) {
      since += step;
      const Vec3 here =
          since < kWinding * edge ? advance(step) : Vec3(before + step * unit(before - root_.position));
      while (static_cast<int>(out.size()) < count && (here - out.back()).norm() >= edge) {
        before = crossing(out.back(), edge, before, here);
        out.push_back(before);
        since = 0;
      }
      before = here;
    }
  }

  // Arc length of the centre line from the root to the tie.
  float pathToTie() {
    float path = 0;
    while (!tied_ && path < 0.6f) {
      advance(0.0022f);
      path += 0.0022f;
    }
    return path;
  }

 private:
  // Point where the segment from a to b leaves the sphere of radius `edge` about `centre`.
  static Vec3 crossing(const Vec3& centre, float edge, const Vec3& a, const Vec3& b) {
    const Eigen::Vector3d d = (b - a).cast<double>(), f = (a - centre).cast<double>();
    const double aa = d.squaredNorm(), half = f.dot(d),
                 c = f.squaredNorm() - static_cast<double>(edge) * edge;
    const double root = std::sqrt(std::max(0.0, half * half - aa * c));
    const double t = std::clamp(aa > 0 ? (-half + root) / aa : 1.0, 0.0, 1.0);
    return (a.cast<double>() + t * d).cast<float>();
  }

  // Combing direction at the current point, before the skin is taken into account.
  Vec3 comb() const {
    const Vec3& p = centre_;
    if (ponytail_) {
      if (!tied_) return unit(slot_ - p);
      return unit(Vec3(0, -1, 0) + spread_);
    }
    // Away from the parting sideways and back, more so at the front, then down.
    const float top = smooth(-0.01f, 0.085f, p.y());
    // The parting ends at the crown; behind it hair falls back.
    const float parted = smooth(-0.085f, 0.01f, p.z());
    const float front = smooth(0.0f, 0.07f, p.z());
    Vec3 way = Vec3(0, -1, 0) +
               top * Vec3((0.15f + 0.95f * parted) * side_, 0, -0.25f - 0.9f * front - 0.5f * (1 - parted));
    // Keeps the face clear: hair that would hang before it goes outward and back.
    const float face = smooth(0.035f, 0.065f, p.z()) * smooth(0.075f, 0.03f, p.y()) *
                       smooth(0.095f, 0.07f, std::fabs(p.x()));
    way += face * Vec3(1.2f * side_, 0, -1.5f);
    return unit(way);
  }

  void observeSkin(float step) {
    distance_ -= step;  // a lower bound while far away
    if (distance_ > 0.03f) return;
    distance_ = obstacleDistance(centre_);
    if (distance_ < 0.03f) normal_ = obstacleNormal(centre_);
  }

  // Advances the centre line by `step` and returns the strand's point there.
  Vec3 advance(float step) {
    travelled_ += step;
    Vec3 want = comb();
    const float lift = character_.lift * smooth(0, 0.03f, travelled_);
    const float near = smooth(lift + 0.012f, lift, distance_);
    if (near > 0) {
      want -= normal_ * (std::min(0.0f, want.dot(normal_)) * near);
      want = unit(want) + normal_ * std::clamp((lift - distance_) / 0.012f, 0.0f, 0.8f);
    }
    const float to_slot = (slot_ - centre_).norm();
    const float stiffness = !ponytail_ ? 0.014f : tied_ ? 0.045f : std::min(0.006f, 0.1f * to_slot);
    direction_ = unit(direction_ + (unit(want) - direction_) * (1 - std::exp(-step / stiffness)));
    centre_ += direction_ * step;
    observeSkin(step);
    const float floor = std::max(kClearance, 0.5f * lift);
    if (distance_ < floor) {
      centre_ += normal_ * (floor - distance_);
      distance_ = obstacleDistance(centre_);
    }
    if (ponytail_ && !tied_ && to_slot < 0.006f) {
      tied_ = true;
      direction_ = unit(direction_ * 0.3f + kTieAxis);
    }
    return offSkin(waved());
  }

  Vec3 waved() {
    across_ = unit(along(across_, direction_));
    const float amplitude = character_.amplitude * smooth(0, character_.ramp, travelled_);
    if (amplitude <= 0) return centre_;
    const float angle = 2 * kPi * travelled_ / character_.wavelength + character_.phase;
    const Vec3 other = direction_.cross(across_);
    return centre_ + amplitude * (std::cos(angle) * across_ + character_.flatness * std::sin(angle) * other);
  }

  Vec3 offSkin(Vec3 p) const {
    if (distance_ - character_.amplitude > 2 * kClearance) return p;
    for (int i = 0; i < 8; ++i) {
      const float d = obstacleDistance(p);
      if (d >= kClearance) break;
      p += obstacleNormal(p) * (kClearance * 1.2f - d);
    }
    return p;
  }

  Root root_;
  Character character_;
  bool ponytail_;
  bool tied_ = false;
  Vec3 centre_, direction_, normal_, across_;
  Vec3 slot_, spread_;
  float side_ = 1;
  float distance_ = 0;  // m, from the centre line to the skin; a lower bound while far away
  float travelled_ = 0;
};

void check(const ProceduralGroomOptions& options) {
  const auto refuse = [](const std::string& what, const std::string& value, const std::string& range) {
    throw Error(what + " is out of range", "procedural groom, " + value, "choose " + range);
  };
  if (options.strands < 1 || options.strands > 1000000)
    refuse("strands", std::to_string(options.strands), "1 to 1000000");
  if (options.vertices < 2 || options.vertices > 128)
    refuse("vertices", std::to_string(options.vertices), "2 to 128 per strand");
  if (!(options.length >= 0.01f && options.length <= 2.0f))
    refuse("length", std::to_string(options.length) + " m", "0.01 to 2 m");
}

// Azimuthal equidistant projection from above: the crown at (0.5, 0.5), the front at small v.
Vec2 scalpUv(const Vec3& p) {
  const Vec3 d = unit(p - Vec3(0, 0, -0.01f));
  const float polar = std::acos(std::clamp(d.y(), -1.0f, 1.0f)) / kPi;
  const float ring = std::hypot(d.x(), d.z());
  return ring > 0 ? Vec2(0.5f + 0.5f * polar * d.x() / ring, 0.5f - 0.5f * polar * d.z() / ring)
                  : Vec2(0.5f, 0.5f);
}

}  // namespace

Groom makeProceduralGroom(const ProceduralGroomOptions& options,
                          const std::function<void(double part)>& growing) {
  constexpr int kProgressInterval = 256;  // strands
  check(options);
  Groom groom;
  groom.name = "procedural";
  Scalp scalp(options.seed);
  std::vector<Vec3> points;
  for (int s = 0; s < options.strands; ++s) {
    if (growing && s % kProgressInterval == 0) growing(s / static_cast<double>(options.strands));
    const Root root = scalp.next();
    Random random(options.seed ^ 0x57a9d, static_cast<uint64_t>(s));
    const Character character = characterOf(root, options, random);
    const Grower grower(root, character, options, random);
    const bool ponytail = options.style == HairStyle::kPonytail;
    const float to_tie = ponytail ? Grower(grower).pathToTie() : 0;
    const float edge = (to_tie + character.length) / static_cast<float>(options.vertices - 1);
    Grower(grower).grow(options.vertices, edge, points);
    groom.strands.append(points);
    groom.strands.uvs.push_back(scalpUv(root.position));
    groom.strands.pinned.push_back(1);
    for (size_t i = 1; i < points.size(); ++i) {
      // The tie pins the vertex nearest to it, and the next one, which leads the tail outward.
      const float past = edge * static_cast<float>(i) - to_tie;
      groom.strands.pinned.push_back(ponytail && past > -0.5f * edge && past <= 1.5f * edge ? 1 : 0);
    }
  }
  groom.report.strands_read = groom.strands.strands();
  return groom;
}

}  // namespace strandcast
