#include "render/shader_validation.h"

#include <algorithm>
#include <cmath>

#include "kernels/scalar_hair.h"
#include "render/framebuffer.h"
#include "render/guide_nodes.h"
#include "render/shaders.h"

namespace strandcast {

namespace {

std::vector<GrownVertex> readGrown(const HairPass& pass, const HairVertices& grown, int last_node,
                                   int node_stride) {
  const size_t per_hair = static_cast<size_t>(grown.nodesPerHair());
  std::vector<GrownVertex> read;
  std::vector<float> numbers;
  for (const HairVertices::Chunk& chunk : grown.chunks()) {
    if (chunk.first >= grown.hairs()) break;
    numbers.resize(std::min(chunk.hairs, grown.hairs() - chunk.first) * per_hair * 8);
    glGetNamedBufferSubData(chunk.vertices.id(), 0, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                            numbers.data());
    for (size_t v = 0; v < numbers.size() / 8; ++v) {
      const float* n = &numbers[8 * v];
      const int node = static_cast<int>(v % per_hair) * node_stride;
      read.push_back({Vec3(n[0], n[1], n[2]), pass.listed(grown.first() + chunk.first + v / per_hair),
                      Vec3(n[4], n[5], n[6]), static_cast<uint32_t>(std::min(node, last_node))});
    }
  }
  return read;
}

}  // namespace

std::vector<GrownVertex> readComputed(const HairPass& pass, const GuideNodes& nodes, int node_stride) {
  return readGrown(pass, pass.vertices(), nodes.segments(), node_stride);
}

std::vector<GrownVertex> readBound(const HairPass& pass, int vertex_stride) {
  const HairVertices& grown = pass.boundVertices();
  return readGrown(pass, grown, (grown.nodesPerHair() - 1) * vertex_stride, vertex_stride);
}

std::vector<GrownVertex> readTessellated(const HairPass& pass, const GuideNodes& nodes,
                                         const HairDetail& detail) {
  const size_t segments =
      static_cast<size_t>((nodes.segments() + detail.node_stride - 1) / detail.node_stride);
  const gl::Program program("hair read back", tessellatedStages("#define CAPTURE\n", nullptr));
  const gl::Buffer target(detail.hairs * segments * 2 * sizeof(float[8]), nullptr, GL_DYNAMIC_STORAGE_BIT);
  GLuint query = 0;
  glGenQueries(1, &query);
  // OpenGL requires a framebuffer even where nothing is rasterised.
  const Texture nowhere(GL_RGBA8, 16, 16, GL_NEAREST);
  const Framebuffer framebuffer(&nowhere, nullptr);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glEnable(GL_RASTERIZER_DISCARD);
  pass.bind(program, nodes, detail);
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, target.id());
  glBeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query);
  glBeginTransformFeedback(GL_LINES);
  pass.drawPatches(nodes, detail);
  glEndTransformFeedback();
  glEndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
  glDisable(GL_RASTERIZER_DISCARD);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  GLuint lines = 0;
  glGetQueryObjectuiv(query, GL_QUERY_RESULT, &lines);
  glDeleteQueries(1, &query);
  std::vector<float> numbers(static_cast<size_t>(lines) * 2 * 8);
  glGetNamedBufferSubData(target.id(), 0, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                          numbers.data());
  std::vector<GrownVertex> read;
  for (size_t v = 0; v < numbers.size(); v += 8) {
    const float* n = &numbers[v];
    read.push_back({Vec3(n[0], n[1], n[2]), static_cast<uint32_t>(n[3]), Vec3(n[4], n[5], n[6]),
                    static_cast<uint32_t>(n[7])});
  }
  return read;
}

LightProbe::LightProbe(const StrandSet& guides, const RenderSettings& settings)
    : settings_(clipped(settings)),
      nodes_(settings_.segments),
      hair_(GrowthPath::kCompute, HairGeometry::kLines),
      scene_(sizeof(SceneBlock), nullptr, GL_DYNAMIC_STORAGE_BIT) {
  settings_.shadows = true;
  for (Light& light : settings_.lights) light.casts_shadow = true;
  nodes_.setGroom(guides);
  nodes_.update(guides.positions, Pose{});
  hair_.setHairs(growHairs(guides, settings_.growth), settings_.growth);
  hair_.grow(nodes_, hair_.all());
  for (const Vec3& p : guides.positions) box_.extend(Eigen::Vector3f(p));
}

void LightProbe::bindScene(const ShadowMaps& maps, const OpacityLayers& layers) {
  settings_.opacity = layers;
  block_ = makeSceneBlock(settings_, Camera{});
  for (size_t light = 0; light < maps.lights(); ++light) maps.fit(block_.lights[light], box_);
  scene_.write(std::span<const SceneBlock>(&block_, 1));
  glBindBufferBase(GL_UNIFORM_BUFFER, binding::kScene, scene_.id());
}

std::vector<LightFragment> LightProbe::fragments(int map_size, size_t light) {
  OpacityLayers layers;
  layers.map_size = map_size;
  bindScene(ShadowMaps(layers, settings_.lights.size()), layers);
  const gl::Program program("hair fragments", grownStages("#define OPACITY\n", shaders::kHairFragmentsFrag));
  program.set("map_light", static_cast<int>(light));
  const Texture nowhere(GL_R8, map_size, map_size, GL_NEAREST);
  const Framebuffer target(&nowhere, nullptr);
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glViewport(0, 0, map_size, map_size);
  glDisable(GL_DEPTH_TEST);
  std::vector<LightFragment> found;
  // A first pass counts the fragments, a second one stores them.
  for (uint32_t room = 0, count = 1; count > room || found.empty();) {
    const uint32_t head[4] = {0, room, 0, 0};
    gl::Buffer list(sizeof head + room * sizeof(LightFragment), nullptr, GL_DYNAMIC_STORAGE_BIT);
    list.write(std::span<const uint32_t>(head));
    list.bindStorage(binding::kProbe);
    hair_.draw(program, nodes_, hair_.all(), false);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(list.id(), 0, sizeof count, &count);
    if (count == 0) break;
    found.resize(std::min(count, room));
    glGetNamedBufferSubData(list.id(), sizeof head,
                            static_cast<GLsizeiptr>(found.size() * sizeof(LightFragment)), found.data());
    if (count <= room) break;
    room = count;
  }
  glEnable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return found;
}

std::vector<LightAnswer> LightProbe::ask(const OpacityLayers& layers, std::span<const Vec3> points,
                                         size_t light) {
  const ShadowMaps maps(layers, settings_.lights.size());
  bindScene(maps, layers);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  for (size_t each = 0; each < maps.lights(); ++each) {
    maps.beginHairFront(each);
    hair_.drawFront(nodes_, hair_.all(), each);
    maps.beginHairOpacity(each);
    hair_.drawOpacity(nodes_, hair_.all(), each, maps.opacitySize());
    maps.end();
  }
  maps.bindTextures();
  const gl::Program program("optical depth", {{GL_COMPUTE_SHADER, shaders::kOpticalDepthComp}});
  const gl::Buffer from(points);
  const gl::Buffer to(points.size() * sizeof(LightAnswer), nullptr, 0);
  from.bindStorage(binding::kProbe);
  to.bindStorage(binding::kProbeAnswer);
  program.set("point_count", static_cast<unsigned>(points.size()));
  program.set("light", static_cast<int>(light));
  program.use();
  glDispatchCompute(static_cast<GLuint>((points.size() + 63) / 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<LightAnswer> answers(points.size());
  glGetNamedBufferSubData(to.id(), 0, static_cast<GLsizeiptr>(answers.size() * sizeof(LightAnswer)),
                          answers.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return answers;
}

namespace {

namespace f64 = kernels::f64;

f64::real3 toLanes(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d fromLanes(const f64::real3& v) { return {v.x, v.y, v.z}; }

f64::AcrossGuide exampleAt(const CurlExample& curl, const Hair& hair, double u) {
  const double place = u * CurlExample::kParts;
  const int part = std::min(static_cast<int>(place), CurlExample::kParts - 1);
  const auto &a = curl.samples[static_cast<size_t>(part)], &b = curl.samples[static_cast<size_t>(part + 1)];
  return f64::exampleAcross({a.x, a.y, 0}, {b.x, b.y, 0}, {a.slope_x, a.slope_y, 0},
                            {b.slope_x, b.slope_y, 0}, 1.0 / CurlExample::kParts, place - part,
                            hair.curl_phase, hair.example_scale);
}

}  // namespace

HairReference::HairReference(const StrandSet& rest_guides, std::span<const Vec3> positions, int segments)
    : segments_(segments),
      nodes_(rest_guides.strands() * (segments + 1),
             Node{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}) {
  for (size_t g = 0; g < rest_guides.strands(); ++g) {
    const auto rest = rest_guides.strand(g);
    const size_t n = rest.size();
    if (n < 2) continue;
    std::vector<double> knots(n, 0);
    for (size_t i = 1; i < n; ++i) knots[i] = knots[i - 1] + (rest[i] - rest[i - 1]).cast<double>().norm();
    if (!(knots.back() > 0)) continue;
    for (double& k : knots) k /= knots[n - 1];
    const auto point = [&](size_t i) {
      return toLanes(positions[rest_guides.offsets[g] + i].cast<double>());
    };
    const auto tangent = [&](size_t i) {
      const size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, n - 1);
      return (point(b) - point(a)) * (1 / std::max(knots[b] - knots[a], 1e-6));
    };
    f64::real3 normal = toLanes(rootFrame(rest).normal.cast<double>());
    f64::real3 last_position = point(0), last_tangent = f64::normalizeOrZero(tangent(0));
    for (int i = 0; i <= segments; ++i) {
      const double u = static_cast<double>(i) / segments;
      const size_t above = std::upper_bound(knots.begin(), knots.end(), u) - knots.begin();
      const size_t k = std::min(above - 1, n - 2);
      const double h = std::max(knots[k + 1] - knots[k], 1e-6), s = std::clamp((u - knots[k]) / h, 0.0, 1.0);
      const f64::real3 position =
          f64::splinePosition(point(k), point(k + 1), tangent(k), tangent(k + 1), h, s);
      const f64::real3 derivative =
          f64::splineDerivative(point(k), point(k + 1), tangent(k), tangent(k + 1), h, s);
      const f64::real3 along = f64::normalizeOrZero(derivative);
      normal = f64::carriedNormal(normal, last_tangent, position - last_position, along);
      last_position = position;
      last_tangent = along;
      nodes_[g * (segments + 1) + i] = {fromLanes(position), fromLanes(derivative), fromLanes(normal)};
    }
  }
}

HairReference::Vertex HairReference::at(const Hair& hair, const HairGrowth& growth, int wanted) const {
  const int node = std::min(wanted, static_cast<int>(std::ceil(hair.extent * static_cast<float>(segments_))));
  const double u = static_cast<double>(node) / segments_;
  const Node* of[3];
  for (int k = 0; k < 3; ++k) of[k] = &nodes_[hair.guides[k] * static_cast<size_t>(segments_ + 1) + node];
  const auto from = [&](int k, auto member) { return toLanes(of[k]->*member - of[0]->*member); };
  const f64::real3 normal = toLanes(of[0]->normal);
  const f64::real3 derivative = toLanes(of[0]->derivative);
  const f64::real3 binormal = f64::cross(f64::normalizeOrZero(derivative), normal);
  const f64::Closing closing = f64::hairClosing(u, hair.clump, 0, 0);
  f64::AcrossGuide across = f64::hairAcross(
      u, {hair.offset[0], hair.offset[1], 0}, toLanes(growth.lock_profile.cast<double>()), hair.tip_deviation,
      hair.whole_deviation, hair.deviation_phase, hair.curl_radius, hair.curl_turns, hair.curl_phase);
  across = f64::bothAcross(across, f64::besideGuide({hair.beside[0], hair.beside[1], 0}, closing));
  if (growth.curl_example) across = f64::bothAcross(across, exampleAt(*growth.curl_example, hair, u));
  const f64::real3 ab = from(1, &Node::position), ac = from(2, &Node::position);
  const f64::real3 position = f64::hairPosition(toLanes(of[0]->position), ab, ac, hair.weights[0],
                                                hair.weights[1], closing, across, normal, binormal);
  const f64::real3 slope =
      f64::hairDerivative(derivative, from(1, &Node::derivative), from(2, &Node::derivative), ab, ac,
                          hair.weights[0], hair.weights[1], closing, across, normal, binormal);
  return {fromLanes(position), fromLanes(f64::normalizeOrZero(slope))};
}

double HairReference::guideLength(const Hair& hair) const {
  const Node* node = &nodes_[hair.guides[0] * static_cast<size_t>(segments_ + 1)];
  double length = 0;
  for (int i = 0; i < segments_; ++i) length += (node[i + 1].position - node[i].position).norm();
  return length;
}

}  // namespace strandcast
