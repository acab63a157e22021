#include "render/light_probe.h"

#include <algorithm>

#include "render/shaders.h"

namespace strandcast {

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

}  // namespace strandcast
