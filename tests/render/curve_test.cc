// Hair of the tessellator and of the compute shader against the same hair evaluated in double precision on
// the CPU.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "offscreen.h"
#include "render/guide_nodes.h"
#include "render/hair_pass.h"
#include "render/scene_block.h"
#include "render/shader_validation.h"

namespace strandcast {
namespace {

using Vec = Eigen::Vector3d;

struct Node {
  Vec position, derivative, normal;
};

/// Curve and twist-free frame of a guide at nodes 0 to `segments`, as guide_nodes.h defines them.
std::vector<Node> guideNodes(std::span<const Vec3> points, int segments) {
  const int n = static_cast<int>(points.size());
  std::vector<Vec> p(n);
  std::vector<double> knot(n, 0);
  for (int i = 0; i < n; ++i) p[i] = points[i].cast<double>();
  for (int i = 1; i < n; ++i) knot[i] = knot[i - 1] + (p[i] - p[i - 1]).norm();
  for (double& k : knot) k /= knot.back();
  const auto tangent = [&](int i) -> Vec {
    const int a = std::max(i - 1, 0), b = std::min(i + 1, n - 1);
    return (p[b] - p[a]) / (knot[b] - knot[a]);
  };
  std::vector<Node> nodes;
  for (int i = 0; i <= segments; ++i) {
    const double u = static_cast<double>(i) / segments;
    int k = 0;
    while (k + 2 < n && knot[k + 1] <= u) ++k;
    const double h = knot[k + 1] - knot[k], s = (u - knot[k]) / h;
    const Vec m0 = h * tangent(k), m1 = h * tangent(k + 1);
    Node node;
    node.position = (1 - 3 * s * s + 2 * s * s * s) * p[k] + (3 * s * s - 2 * s * s * s) * p[k + 1] +
                    s * (1 - s) * (1 - s) * m0 - s * s * (1 - s) * m1;
    node.derivative =
        (6 * s * (1 - s) * (p[k + 1] - p[k]) + (1 - s) * (1 - 3 * s) * m0 + s * (3 * s - 2) * m1) / h;
    const Vec t = node.derivative.normalized();
    if (i == 0) {
      node.normal = rootFrame(points).normal.cast<double>();
    } else {
      const Node& last = nodes.back();
      const auto mirrored = [](const Vec& v, const Vec& across) -> Vec {
        return v - 2 * across.dot(v) / across.squaredNorm() * across;
      };
      const Vec step = node.position - last.position;
      const Vec turned = mirrored(last.derivative.normalized(), step);
      const Vec turn = t - turned;
      node.normal = mirrored(last.normal, step);
      if (turn.norm() > 1e-9) node.normal = mirrored(node.normal, turn);
    }
    node.normal = (node.normal - t * t.dot(node.normal)).normalized();
    nodes.push_back(node);
  }
  return nodes;
}

/// An example's curl at u: the cubic with the samples' values and slopes.
Eigen::Vector2d exampleAt(const CurlExample& curl, double u) {
  constexpr int kParts = CurlExample::kParts;
  const int part = std::min(static_cast<int>(u * kParts), kParts - 1);
  const auto &a = curl.samples[static_cast<size_t>(part)], &b = curl.samples[static_cast<size_t>(part + 1)];
  const double s = u * kParts - part, r = 1 - s;
  const auto mix = [&](double p, double q, double m, double n) {
    return r * r * (1 + 2 * s) * p + s * s * (3 - 2 * s) * q + s * r * (r * m - s * n) / kParts;
  };
  return {mix(a.x, b.x, a.slope_x, b.slope_x), mix(a.y, b.y, a.slope_y, b.slope_y)};
}

/// An independent implementation of hair_growth.h and kernels/hair.h.
Vec hairPoint(const Hair& hair, const std::vector<std::vector<Node>>& guides, const HairGrowth& growth,
              int segments, int wanted) {
  const Vec3& profile = growth.lock_profile;
  const int node = std::min(wanted, static_cast<int>(std::ceil(hair.extent * static_cast<float>(segments))));
  const double u = static_cast<double>(node) / segments, turn = 2 * std::numbers::pi;
  Vec x = Vec::Zero();
  for (int k = 0; k < 3; ++k) {
    const double given = k == 0 ? 1.0 - hair.weights[0] - hair.weights[1] : hair.weights[k - 1];
    const double w = (1 - hair.clump * u) * given + (k == 0 ? hair.clump * u : 0);
    x += w * guides[hair.guides[k]][node].position;
  }
  const Node& main = guides[hair.guides[0]][node];
  const Vec n = main.normal, b = main.derivative.normalized().cross(n);
  x += (1 - hair.clump * u) * (hair.beside[0] * n + hair.beside[1] * b);
  const double lock = std::pow(1 - u, 2) * profile[0] + 2 * u * (1 - u) * profile[1] + u * u * profile[2];
  x += lock * (hair.offset[0] * n + hair.offset[1] * b);
  const double opening = 1 - std::pow(1 - u, 2);
  const double stray = hair.tip_deviation * std::pow(u, 6) + hair.whole_deviation * opening;
  const double a = turn * (hair.deviation_phase + 1.5 * u),
               c = turn * (hair.curl_phase + hair.curl_turns * u);
  x += stray * (std::cos(a) * n + std::sin(a) * b);
  if (growth.curl_example) {
    const double phase = turn * hair.curl_phase;
    const Eigen::Vector2d place = hair.example_scale * exampleAt(*growth.curl_example, u);
    const Eigen::Vector2d turned = Eigen::Rotation2Dd(phase) * place;
    x += turned.x() * n + turned.y() * b;
  }
  return x + hair.curl_radius * opening * (std::cos(c) * n + std::sin(c) * b);
}

StrandSet bentGuides() {
  StrandSet guides;
  for (int g = 0; g < 40; ++g) {
    const int vertices = 2 + g % 15;
    const float down = g % 7 < 5 ? 0.3f : -0.3f;  // the others diverge from them
    std::vector<Vec3> points;
    for (int i = 0; i < vertices; ++i) {
      const float t =
          static_cast<float>(i * i + 3 * i) / static_cast<float>((vertices - 1) * (vertices + 2));  // uneven
      points.emplace_back(0.01f * static_cast<float>(g % 7) + 0.03f * std::sin(4 * t), 0.1f - down * t,
                          0.01f * static_cast<float>(g / 7) + 0.02f * t * t);
    }
    guides.append(points);
  }
  return guides;
}

constexpr int kCurveSegments = 100;  // two patches per hair, the last one partly filled
constexpr size_t kHairs = 200;       // four patches, the last one partly filled

class HairCurve : public OffscreenTest {
 protected:
  void SetUp() override {
    OffscreenTest::SetUp();
    if (IsSkipped()) return;
    growth_.hairs = kHairs;
    growth_.seed = 3;
    growth_.curl_radius = 0.006f;
    growth_.curl_pitch = 0.1f;
    std::vector<Vec3> wave;
    for (int i = 0; i < 30; ++i) {
      const float a = 0.5f * static_cast<float>(i);
      wave.emplace_back(0.03f * std::sin(a), -0.04f * static_cast<float>(i), 0.01f * std::cos(1.3f * a));
    }
    growth_.curl_example = std::make_shared<const CurlExample>(curlOf(wave, "wave"));
    growth_.tip_deviation_part = growth_.whole_deviation_part = 0.5f;
    guides_ = bentGuides();
    nodes_ = std::make_unique<GuideNodes>(kCurveSegments);
    nodes_->setGroom(guides_);
    const SceneBlock block = makeSceneBlock(RenderSettings{}, Camera{});
    scene_ = gl::Buffer(sizeof(SceneBlock), &block, GL_DYNAMIC_STORAGE_BIT);
    glBindBufferBase(GL_UNIFORM_BUFFER, binding::kScene, scene_.id());
    EXPECT_EQ(nodes_->update(guides_.positions, Pose{}), 0u);
    hairs_ = growHairs(guides_, growth_);
    const auto beside = [](const Hair& hair) { return hair.beside[0] != 0; };
    EXPECT_GT(std::count_if(hairs_.begin(), hairs_.end(), beside), 10);
    for (size_t g = 0; g < guides_.strands(); ++g)
      curves_.push_back(guideNodes(guides_.strand(g), kCurveSegments));
  }
  Vec expected(const Hair& hair, int node) const {
    return hairPoint(hair, curves_, growth_, kCurveSegments, node);
  }
  double lengthOf(const Hair& hair) const { return arcLength(guides_.strand(hair.guides[0])); }

  HairGrowth growth_;
  StrandSet guides_;
  std::vector<Hair> hairs_;
  std::unique_ptr<GuideNodes> nodes_;
  gl::Buffer scene_;
  std::vector<std::vector<Node>> curves_;
};

TEST_F(HairCurve, TessellatedVerticesAreTheCurvesToRounding) {
  HairPass pass(GrowthPath::kTessellator, HairGeometry::kLines);
  pass.setHairs(hairs_, growth_);
  pass.grow(*nodes_, pass.all());
  const std::vector<GrownVertex> captured = readTessellated(pass, *nodes_, pass.all());
  ASSERT_EQ(captured.size(), 2 * kHairs * kCurveSegments);
  std::vector<int> seen(kHairs * (kCurveSegments + 1), 0);
  double worst = 0, worst_tangent = 0;
  for (const GrownVertex& vertex : captured) {
    const size_t h = vertex.hair;
    const int node = static_cast<int>(vertex.node);
    ASSERT_LT(h, kHairs);
    ++seen[h * (kCurveSegments + 1) + node];
    const Hair& hair = pass.hairs()[h];
    worst = std::max(worst, (vertex.position.cast<double>() - expected(hair, node)).norm() / lengthOf(hair));
    // A central difference of a much finer evaluation would need the frame between nodes. The chord of the
    // neighbouring nodes is close enough to detect a wrong derivative.
    if (node > 2 && node + 3 < hair.extent * kCurveSegments) {
      const Vec chord = expected(hair, node + 1) - expected(hair, node - 1);
      const Vec tangent = vertex.tangent.cast<double>();
      worst_tangent = std::max(worst_tangent, chord.normalized().cross(tangent).norm());
    }
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_tangent, 0.05);
  for (size_t i = 0; i < seen.size(); ++i) {
    const size_t node = i % (kCurveSegments + 1);
    EXPECT_EQ(seen[i], node == 0 || node == kCurveSegments ? 1 : 2)
        << "hair " << i / (kCurveSegments + 1) << " node " << node;
  }
}

TEST_F(HairCurve, VerticesOfTheComputeShaderAreTheCurvesToRounding) {
  HairPass pass(GrowthPath::kCompute, HairGeometry::kLines);
  pass.setHairs(hairs_, growth_);
  const HairReference reference(guides_, guides_.positions, kCurveSegments);
  for (const int stride : {1, 3}) {
    HairDetail detail = pass.all();
    detail.node_stride = stride;
    pass.grow(*nodes_, detail);
    const std::vector<GrownVertex> grown = readComputed(pass, *nodes_, stride);
    ASSERT_EQ(grown.size(), kHairs * (stride == 1 ? kCurveSegments + 1 : 35));
    double worst = 0, worst_tangent = 0, worst_reference = 0;
    for (const GrownVertex& vertex : grown) {
      const Hair& hair = pass.hairs()[vertex.hair];
      const int node = static_cast<int>(vertex.node);
      const HairReference::Vertex exact = reference.at(hair, growth_, node);
      worst = std::max(worst, (vertex.position.cast<double>() - exact.position).norm() / lengthOf(hair));
      worst_tangent = std::max(worst_tangent, (vertex.tangent.cast<double>() - exact.tangent).norm());
      worst_reference =
          std::max(worst_reference, (expected(hair, node) - exact.position).norm() / lengthOf(hair));
    }
    EXPECT_LT(worst, 1e-5);
    EXPECT_LT(worst_tangent, 1e-3);
    // Knots are floats on the device and in only one of the two references.
    EXPECT_LT(worst_reference, 1e-6);
  }
}

}  // namespace
}  // namespace strandcast
