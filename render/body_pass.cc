#include "render/body_pass.h"

#include <algorithm>
#include <cmath>

#include "render/shaders.h"

namespace strandcast {
namespace {

bool drawable(const TriangleMesh& mesh, const std::array<uint32_t, 3>& triangle) {
  for (uint32_t index : triangle)
    if (index >= mesh.positions.size() || !mesh.positions[index].allFinite()) return false;
  return true;
}

Eigen::Matrix4f matrix(const Pose& pose) {
  Eigen::Matrix4f m = Eigen::Matrix4f::Identity();
  m.topLeftCorner<3, 3>() = pose.rotation.normalized().toRotationMatrix();
  m.block<3, 1>(0, 3) = pose.position;
  return m;
}

gl::Program groundProgram(const LightCounts& lights) {
  return {"ground",
          {{GL_VERTEX_SHADER, shaders::kGroundVert},
           {GL_FRAGMENT_SHADER, shaders::kGroundFrag, lightDefines(lights)}}};
}

gl::Program bodyProgram(const LightCounts& lights) {
  return {"body",
          {{GL_VERTEX_SHADER, shaders::kBodyVert},
           {GL_FRAGMENT_SHADER, shaders::kBodyFrag, lightDefines(lights)}}};
}

}  // namespace

BodyPass::BodyPass()
    : background_("background", {{GL_VERTEX_SHADER, shaders::kBackgroundVert},
                                 {GL_FRAGMENT_SHADER, shaders::kBackgroundFrag}}),
      ground_(groundProgram({})),
      body_(bodyProgram({})),
      depth_("body depth", {{GL_VERTEX_SHADER, shaders::kBodyVert, "#define DEPTH_ONLY\n"},
                            {GL_FRAGMENT_SHADER, shaders::kBodyDepthFrag}}) {
  glCreateVertexArrays(1, &empty_vertices_);
  glCreateVertexArrays(1, &mesh_);
  const GLint sizes[] = {3, 3, 1};
  const GLuint offsets[] = {offsetof(Vertex, position), offsetof(Vertex, normal),
                            offsetof(Vertex, head_weight)};
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexArrayAttrib(mesh_, i);
    glVertexArrayAttribFormat(mesh_, i, sizes[i], GL_FLOAT, GL_FALSE, offsets[i]);
    glVertexArrayAttribBinding(mesh_, i, 0);
  }
}

BodyPass::~BodyPass() {
  glDeleteVertexArrays(1, &mesh_);
  glDeleteVertexArrays(1, &empty_vertices_);
}

void BodyPass::setLights(const LightCounts& lights) {
  auto ground = groundProgram(lights);
  body_ = bodyProgram(lights);
  ground_ = std::move(ground);
}

void BodyPass::setBody(const BodyDescription& body) {
  TriangleMesh mesh = body.mesh;
  std::erase_if(mesh.triangles, [&](const auto& triangle) { return !drawable(mesh, triangle); });
  if (mesh.normals.size() != mesh.positions.size()) computeNormals(mesh);
  const bool weighted = body.head_weights.size() == mesh.positions.size();
  rest_.clear();
  rest_.reserve(mesh.positions.size());
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 &p = mesh.positions[i], &n = mesh.normals[i];
    rest_.push_back({{p.x(), p.y(), p.z()}, {n.x(), n.y(), n.z()}, weighted ? body.head_weights[i] : 1.0f});
  }
  placed_ = rest_;
  triangles_ = mesh.triangles;
  computeBounds(rest_);
  vertices_ = gl::Buffer(std::span<const Vertex>(rest_));
  indices_ = gl::Buffer(std::span<const std::array<uint32_t, 3>>(mesh.triangles));
  index_count_ = static_cast<GLsizei>(3 * mesh.triangles.size());
  glVertexArrayVertexBuffer(mesh_, 0, vertices_.id(), 0, sizeof(Vertex));
  glVertexArrayElementBuffer(mesh_, indices_.id());
  bind();
}

void BodyPass::setObstacles(std::span<const HairObstacle> obstacles) {
  parts_ = bodyParts(obstacles);
  const bool was_carried = !binding_.empty();
  bind();
  if (!was_carried || !binding_.empty()) return;
  placed_ = rest_;
  vertices_.write(std::span<const Vertex>(rest_));
  computeBounds(rest_);
}

void BodyPass::bind() {
  std::vector<Vec3> positions;
  for (const Vertex& vertex : rest_) positions.emplace_back(vertex.position);
  binding_ = BodyBinding(positions, parts_);
}

void BodyPass::computeBounds(std::span<const Vertex> vertices) {
  bounds_ = Box();
  for (const auto& triangle : triangles_)
    for (uint32_t index : triangle) bounds_.extend(Eigen::Vector3f(vertices[index].position));
}

void BodyPass::setColliderPoses(std::span<const PlacedCollider> colliders) {
  if (binding_.empty()) return;
  binding_.setColliderPoses(colliders);
  std::vector<Vertex> moved = rest_;
  for (size_t v = 0; v < moved.size(); ++v) {
    if (!binding_.holds(v)) continue;
    const Vec3 rest(rest_[v].position);
    const Vec3 position = binding_.position(v, rest),
               normal = binding_.normal(v, rest, Vec3(rest_[v].normal));
    if (!position.allFinite() || !normal.allFinite()) continue;  // a damaged frame
    std::copy(position.begin(), position.end(), moved[v].position);
    std::copy(normal.begin(), normal.end(), moved[v].normal);
    moved[v].head_weight = 0;
  }
  vertices_.write(std::span<const Vertex>(moved));
  computeBounds(moved);
  placed_ = std::move(moved);
}

TriangleMesh BodyPass::mesh(const Pose& head) const {
  TriangleMesh mesh;
  mesh.triangles = triangles_;
  const Eigen::Matrix4f moves = matrix(head);
  for (const Vertex& v : placed_) {
    const Vec3 position(v.position), normal(v.normal);
    const Vec3 moved = moves.topLeftCorner<3, 3>() * position + moves.block<3, 1>(0, 3);
    const Vec3 turned = moves.topLeftCorner<3, 3>() * normal;
    mesh.positions.emplace_back(position + v.head_weight * (moved - position));
    mesh.normals.emplace_back(normal + v.head_weight * (turned - normal));
  }
  return mesh;
}

void BodyPass::drawMesh(const gl::Program& program, const Pose& head) const {
  if (index_count_ == 0) return;
  program.set("head", matrix(head));
  program.use();
  glBindVertexArray(mesh_);
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
  glBindVertexArray(0);
}

void BodyPass::drawDepth(const Pose& head, size_t light) const {
  depth_.set("map_light", static_cast<int>(light));
  drawMesh(depth_, head);
}

void BodyPass::drawBody(const Pose& head) const { drawMesh(body_, head); }

void BodyPass::drawBackground() const {
  background_.use();
  glBindVertexArray(empty_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);  // at the far plane, so that everything drawn before stays
  glBindVertexArray(0);
}

void BodyPass::drawGround() const {
  ground_.use();
  glBindVertexArray(empty_vertices_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glBindVertexArray(0);
}

}  // namespace strandcast
