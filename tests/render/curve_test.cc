// The tessellated hair against the same hair evaluated in double precision on the CPU.
#include <cmath>
#include <vector>

#include "offscreen.h"
#include "render/framebuffer.h"
#include "render/guide_nodes.h"
#include "render/hair_pass.h"
#include "render/scene_block.h"

namespace strandcast {
namespace {

using Vec = Eigen::Vector3d;

struct Node {
  Vec position, derivative, normal;
};

/// Curve and twist-free frame of a guide at 0 .. segments, as guide_nodes.h says.
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

/// hair_growth.h, word for word.
Vec hairPoint(const Hair& hair, const std::vector<std::vector<Node>>& guides, int segments, int wanted) {
  const int node = std::min(wanted, static_cast<int>(std::ceil(hair.extent * static_cast<float>(segments))));
  const double u = static_cast<double>(node) / segments;
  Vec x = Vec::Zero();
  for (int k = 0; k < 3; ++k) {
    const double w = (1 - hair.clump * u) * hair.weights[k] + (k == 0 ? hair.clump * u : 0);
    x += w * guides[hair.guides[k]][node].position;
  }
  const Node& main = guides[hair.guides[0]][node];
  const Vec b = main.derivative.normalized().cross(main.normal);
  const double a = hair.phase + 9 * u;
  x += (1 - 0.6 * u) * (hair.offset[0] * main.normal + hair.offset[1] * b);
  return x + hair.stray * u * u * (std::cos(a) * main.normal + std::sin(a) * b);
}

StrandSet bentGuides() {
  StrandSet guides;
  for (int g = 0; g < 40; ++g) {
    const int vertices = 2 + g % 15;
    std::vector<Vec3> points;
    for (int i = 0; i < vertices; ++i) {
      const float t =
          static_cast<float>(i * i + 3 * i) / static_cast<float>((vertices - 1) * (vertices + 2));  // uneven
      points.emplace_back(0.01f * static_cast<float>(g % 7) + 0.03f * std::sin(4 * t), 0.1f - 0.3f * t,
                          0.01f * static_cast<float>(g / 7) + 0.02f * t * t);
    }
    guides.append(points);
  }
  return guides;
}

using HairCurve = OffscreenTest;

TEST_F(HairCurve, TessellatedVerticesAreTheCurvesToRounding) {
  constexpr int kSegments = 24;
  constexpr size_t kHairs = 200;  // more than three patches, the last one partly filled
  const StrandSet guides = bentGuides();
  GuideNodes nodes(kSegments);
  nodes.setGroom(guides);
  HairPass pass;
  pass.setHairs(growHairs(guides, {.hairs = kHairs, .seed = 3}));
  const SceneBlock block = makeSceneBlock(RenderSettings{}, Camera{});
  const gl::Buffer scene(sizeof(SceneBlock), &block, GL_DYNAMIC_STORAGE_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, binding::kScene, scene.id());
  EXPECT_EQ(nodes.update(guides.positions, Pose{}), 0u);

  struct Captured {
    float position[3], hair, tangent[3], node;
  };
  const size_t capacity = kHairs * kSegments * 2;
  const gl::Program program("capture", hairStages("#define CAPTURE\n", nullptr));
  const gl::Buffer target(capacity * sizeof(Captured), nullptr, GL_DYNAMIC_STORAGE_BIT);
  GLuint query = 0;
  glGenQueries(1, &query);
  const Texture nowhere(GL_RGBA8, 16, 16,
                        GL_NEAREST);  // drawing wants a framebuffer even when nothing is rasterised
  const Framebuffer framebuffer(&nowhere, nullptr);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glEnable(GL_RASTERIZER_DISCARD);
  std::vector<Captured> captured;
  std::vector<int> seen(kHairs * (kSegments + 1), 0);
  double worst = 0, worst_tangent = 0;
  std::vector<std::vector<Node>> curves;
  for (size_t g = 0; g < guides.strands(); ++g) curves.push_back(guideNodes(guides.strand(g), kSegments));

  pass.bind(program, nodes, kHairs, 1);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, target.id());
  glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query);
  glBeginTransformFeedback(GL_LINES);
  pass.drawPatches(kHairs);
  glEndTransformFeedback();
  glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  glDisable(GL_RASTERIZER_DISCARD);
  GLuint lines = 0;
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &lines);
  glDeleteQueries(1, &query);
  ASSERT_EQ(lines, kHairs * kSegments);
  captured.resize(2 * lines);
  glGetNamedBufferSubData(target.id(), 0, static_cast<GLsizeiptr>(captured.size() * sizeof(Captured)),
                          captured.data());

  for (const Captured& vertex : captured) {
    const size_t h = static_cast<size_t>(vertex.hair);
    const int node = static_cast<int>(vertex.node);
    ASSERT_LT(h, kHairs);
    ++seen[h * (kSegments + 1) + node];
    const Hair& hair = pass.hairs()[h];
    const Vec expected = hairPoint(hair, curves, kSegments, node);
    const Vec position(vertex.position[0], vertex.position[1], vertex.position[2]);
    const double length = arcLength(guides.strand(hair.guides[0]));
    worst = std::max(worst, (position - expected).norm() / length);
    // The tangent against a central difference of a much finer evaluation would need the frame between nodes;
    // inside the hair a chord of its neighbours is close enough to catch a wrong derivative.
    if (node > 2 && node + 3 < hair.extent * kSegments) {
      const Vec chord =
          hairPoint(hair, curves, kSegments, node + 1) - hairPoint(hair, curves, kSegments, node - 1);
      const Vec tangent(vertex.tangent[0], vertex.tangent[1], vertex.tangent[2]);
      worst_tangent = std::max(worst_tangent, chord.normalized().cross(tangent).norm());
    }
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_tangent, 0.05);
  for (size_t i = 0; i < seen.size(); ++i) {
    const size_t node = i % (kSegments + 1);
    EXPECT_EQ(seen[i], node == 0 || node == kSegments ? 1 : 2)
        << "hair " << i / (kSegments + 1) << " node " << node;
  }
}

}  // namespace
}  // namespace strandcast
