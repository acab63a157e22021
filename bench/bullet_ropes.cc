#include "bench/bullet_ropes.h"

#ifdef STRANDCAST_HAS_BULLET
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <fmt/format.h>

#include <cmath>
#else
#include "core/error.h"
#endif

namespace strandcast {
#ifdef STRANDCAST_HAS_BULLET

bool bulletAvailable(std::string*) { return true; }
std::string bulletVersion() {
  return fmt::format("{}.{:02}", BT_BULLET_VERSION / 100, BT_BULLET_VERSION % 100);
}

namespace {
btVector3 toBullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
}  // namespace

struct BulletRopes::World {
  btSoftBodyWorldInfo info;
  std::vector<std::unique_ptr<btSoftBody>> ropes;
  std::vector<Vec3> roots;  // rest positions
  float step = 0;           // s
  int substeps = 1;
};

BulletRopes::BulletRopes(const std::vector<StrandPoints>& strands, double mass_per_length)
    : world_(std::make_unique<World>()) {
  world_->info.m_gravity.setValue(0, -static_cast<float>(kGravity), 0);
  world_->info.m_sparsesdf.Initialize();
  for (const StrandPoints& points : strands) {
    const int vertices = static_cast<int>(points.size());
    constexpr int kHoldFirst = 1;
    world_->ropes.emplace_back(btSoftBodyHelpers::CreateRope(
        world_->info, toBullet(points.front()), toBullet(points.back()), vertices - 2, kHoldFirst));
    btSoftBody& rope = *world_->ropes.back();
    rope.m_materials[0]->m_kLST = 1;
    rope.m_cfg.collisions = 0;
    const double edge = static_cast<double>((points.back() - points.front()).norm()) / (vertices - 1);
    for (int v = 1; v < vertices; ++v)
      rope.setMass(v, static_cast<float>(mass_per_length * edge * (v == vertices - 1 ? 0.5 : 1)));
    world_->roots.push_back(points.front());
  }
}

BulletRopes::~BulletRopes() = default;

void BulletRopes::configure(double frame, int substeps, int iterations, double drag) {
  world_->substeps = substeps;
  world_->step = static_cast<float>(frame / substeps);
  for (const auto& rope : world_->ropes) {
    rope->m_cfg.piterations = iterations;
    rope->m_cfg.kDP = static_cast<float>(1 - std::exp(-drag * frame / substeps));
  }
}

void BulletRopes::step(const Pose& begin, const Pose& end) {
  const float step = world_->step;
  for (size_t r = 0; r < world_->ropes.size(); ++r) {
    btSoftBody& rope = *world_->ropes[r];
    const Vec3 from = begin.rotation * world_->roots[r] + begin.position,
               to = end.rotation * world_->roots[r] + end.position;
    for (int i = 1; i <= world_->substeps; ++i) {
      // Bullet moves a fixed node by its velocity.
      const btVector3 target =
          toBullet(from + (to - from) * (static_cast<float>(i) / static_cast<float>(world_->substeps)));
      rope.m_nodes[0].m_v = (target - rope.m_nodes[0].m_x) / step;
      rope.predictMotion(step);
      rope.solveConstraints();
      rope.integrateMotion();
    }
  }
}

std::vector<Vec3> BulletRopes::positions() const {
  std::vector<Vec3> out;
  for (const auto& rope : world_->ropes)
    for (int v = 0; v < rope->m_nodes.size(); ++v) {
      const btVector3& x = rope->m_nodes[v].m_x;
      out.emplace_back(x.x(), x.y(), x.z());
    }
  return out;
}

#else

struct BulletRopes::World {};

bool bulletAvailable(std::string* reason) {
  if (reason != nullptr)
    *reason = "this build has no Bullet: install libbullet-dev (./dev setup) and configure again";
  return false;
}
std::string bulletVersion() { return ""; }

BulletRopes::BulletRopes(const std::vector<StrandPoints>&, double) {
  throw Error("this build has no Bullet", "Bullet's ropes", "install libbullet-dev (./dev setup)");
}
BulletRopes::~BulletRopes() = default;
void BulletRopes::configure(double, int, int, double) {}
void BulletRopes::step(const Pose&, const Pose&) {}
std::vector<Vec3> BulletRopes::positions() const { return {}; }

#endif
}  // namespace strandcast
