#include "render/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "gl/timers.h"
#include "render/body_pass.h"
#include "render/bound_hairs.h"
#include "render/camera.h"
#include "render/framebuffer.h"
#include "render/hair_pass.h"
#include "render/hair_selection.h"
#include "render/shadow_maps.h"
#include "transport/codec/hair_codec.h"

namespace strandcast {
namespace {

constexpr double kLengthKept = 0.99;  // least fraction of the hair's length that fewer segments must keep
constexpr float kTouching = 5e-5f;    // m, beyond its radius, at which a guide counts as touching
constexpr float kBelowHair = 0.05f;   // m, times scale(): the ground below hair at rest
constexpr float kSmall = 0.1f;        // m, size below which fixed lengths are scaled
constexpr float kShadowHairs = 8;     // ratio of shadow-casting to drawn hairs, limited by all

Box boundsOf(std::span<const Vec3> positions, const PlausibleBounds& place) {
  Box box;
  for (const Vec3& p : positions)
    if (place.holds(p)) box.extend(Eigen::Vector3f(p));
  return box;
}

Box widened(const Box& box, float by) {
  const Eigen::Vector3f margin = Eigen::Vector3f::Constant(by);
  return {box.min() - margin, box.max() + margin};
}

Box moved(const Box& box, const Pose& pose) {
  Box result;
  if (box.isEmpty()) return result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(Eigen::Vector3f(pose.apply(box.corner(static_cast<Box::CornerType>(corner)))));
  return result;
}

/// The fewest segments that keep the hair's length, and so its covered area, and eight per turn of a curl.
int minSegments(const StrandSet& guides, const RenderSettings& settings, const std::vector<Hair>& hairs) {
  float turns = settings.growth.curl_example ? settings.growth.curl_example->turns : 0;
  for (const Hair& hair : hairs)
    if (hair.curl_radius > 0) turns = std::max(turns, hair.curl_turns);
  int least = settings.segments;
  while (least >= 8 && static_cast<float>(least / 2) >= 8 * turns &&
         lengthKept(guides, least / 2) > kLengthKept)
    least /= 2;
  return least;
}

int minBoundSegments(const StrandSet& hairs, int segments) {
  while (segments >= 8 && lengthKept(hairs, segments / 2) > kLengthKept) segments /= 2;
  return segments;
}

float longestOf(const StrandSet& strands) {
  float longest = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const float length = arcLength(strands.strand(s));
    if (std::isfinite(length)) longest = std::max(longest, length);
  }
  return longest;
}

/// Both paths need storage buffers in a stage for which OpenGL does not require them.
void requireBuffers(GrowthPath path) {
  const bool tessellator = path == GrowthPath::kTessellator;
  GLint blocks = 0;
  glGetIntegerv(
      tessellator ? GL_MAX_TESS_EVALUATION_SHADER_STORAGE_BLOCKS : GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS,
      &blocks);
  if (blocks < (tessellator ? 6 : 4))
    throw Error(
        "the OpenGL device cannot grow hair",
        std::string(tessellator ? "tessellation" : "vertex") + " shaders read " + std::to_string(blocks) +
            " storage buffers",
        tessellator ? "grow it in compute" : "grow it on the tessellator, or use LIBGL_ALWAYS_SOFTWARE=1");
}

/// The statistic that a pass's time is added to.
double RenderStatistics::*sumOf(RenderPass pass) {
  switch (pass) {
    case RenderPass::kGuides:
      return &RenderStatistics::guides_ms;
    case RenderPass::kGrowth:
      return &RenderStatistics::growth_ms;
    case RenderPass::kSolidShadow:
    case RenderPass::kHairShadow:
      return &RenderStatistics::shadow_ms;
    case RenderPass::kHair:
      return &RenderStatistics::hair_ms;
    case RenderPass::kResolve:
      return &RenderStatistics::resolve_ms;
    default:
      return &RenderStatistics::body_ms;
  }
}

void setPassState() {
  for (GLenum off : {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_SAMPLE_ALPHA_TO_COVERAGE})
    glDisable(off);
  for (GLenum on : {GL_DEPTH_TEST, GL_MULTISAMPLE, GL_FRAMEBUFFER_SRGB}) glEnable(on);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

}  // namespace

/// The role of a group of hair in a picture.
enum class Visibility : uint8_t { kCulled, kShadowOnly, kVisible };

/// The inputs that determine the list of a picture's hairs.
struct Selection {
  std::vector<Visibility> visibility;
  size_t drawn = 0, shading = 0;  ///< counts before culling, by the level of detail
  bool operator==(const Selection&) const = default;
};

struct Renderer::Impl {
  explicit Impl(const RenderSettings& wanted)
      : scene_buffer(sizeof(SceneBlock), nullptr, GL_DYNAMIC_STORAGE_BIT) {
    GLfloat range[2] = {1, 1};
    glGetFloatv(GL_ALIASED_LINE_WIDTH_RANGE, range);
    widest_line = std::max(range[1], 1.0f);
    setSettings(clipped(wanted));
  }

  /// On failure throws Error and leaves everything unchanged. Exception: where the device has no memory for
  /// the hair, there is none afterwards.
  void setSettings(const RenderSettings& next) {
    const auto changed = [&](auto... member) { return ((settings.*member != next.*member) || ...); };
    const bool first = !picture;
    const bool other_nodes = first || changed(&RenderSettings::segments);
    const bool other_hair =
        first || changed(&RenderSettings::growth_path, &RenderSettings::geometry, &RenderSettings::shading);
    const bool other_widths = !bound.hairs.radii.empty() && changed(&RenderSettings::hair_width);
    const bool hair_moves =
        !first && (other_nodes || other_hair || other_widths || changed(&RenderSettings::growth));
    const LightCounts counts = countsOf(next);
    const bool other_lights = counts != countsOf(settings);

    const bool other_picture =
        first || changed(&RenderSettings::width, &RenderSettings::height, &RenderSettings::samples,
                         &RenderSettings::supersampling, &RenderSettings::filter);
    Picture next_picture = other_picture ? makePicture(next) : Picture();
    std::unique_ptr<ShadowMaps> next_shadows;
    if (first || changed(&RenderSettings::opacity) || counts.casters != shadows->lights())
      next_shadows = std::make_unique<ShadowMaps>(next.opacity, counts.casters);
    std::unique_ptr<HairPass> next_hair;
    if (other_hair) {
      next_hair = std::make_unique<HairPass>(next.growth_path, next.geometry, next.shading, counts);
      next_hair->bodies().setObstacles(obstacles);
    }
    std::unique_ptr<GuideNodes> next_nodes;
    if (other_nodes) {
      next_nodes = std::make_unique<GuideNodes>(next.segments);
      next_nodes->setObstacles(obstacles);
    }
    if (other_lights && !other_hair) hair->setLights(counts);
    if (first || other_lights) body.setLights(counts);

    // Below, only placeHair() may throw.
    if (other_picture) std::tie(picture, still) = std::move(next_picture);
    if (next_shadows) shadows = std::move(next_shadows);
    if (next_hair) hair = std::move(next_hair);
    if (next_nodes) nodes = std::move(next_nodes);
    hair->setClearance(next.clearance);
    hair->keepOut(next.keep_out);
    settings = next;
    if (hair_moves) placeHair();
  }

  /// The render target and, with supersampling, the filter that reduces it.
  using Picture = std::pair<std::unique_ptr<PictureBuffer>, std::unique_ptr<Supersampling>>;
  static Picture makePicture(const RenderSettings& next) {
    const int factor = next.supersampling;
    return {
        std::make_unique<PictureBuffer>(next.width * factor, next.height * factor, next.samples),
        factor > 1 ? std::make_unique<Supersampling>(next.width, next.height, factor, next.filter) : nullptr};
  }

  /// Grows the hair: chooses the guides that each hair follows, and adds those that are bound.
  void placeHair() {
    const bool any_bound = bound.hairs.strands() > 0;
    hair->setHairs({}, settings.growth);
    nodes->setGroom(rest_guides, any_bound);
    std::vector<Hair> hairs = growHairs(rest_guides, settings.growth, seeded);
    min_segments = minSegments(rest_guides, settings, hairs);
    std::unique_ptr<BoundHairs> shapes;
    statistics.hairs_bound = 0;
    widest_hair = 1;
    if (any_bound) {
      shapes = std::make_unique<BoundHairs>(bound.hairs);
      bound_segments = shapes->vertices() - 1;
      min_bound_segments = minBoundSegments(bound.hairs, bound_segments);
      const std::vector<Hair> also = boundHairs(bound, rest_guides, settings.growth, settings.hair_width);
      for (const Hair& one : also) widest_hair = std::max(widest_hair, one.width);
      statistics.hairs_bound = also.size();
      hairs.insert(hairs.end(), also.begin(), also.end());
      std::stable_sort(hairs.begin(), hairs.end(),
                       [](const Hair& a, const Hair& b) { return detailKey(a) > detailKey(b); });
    }
    hair->setHairs(std::move(hairs), settings.growth, std::move(shapes));
    groups = HairGroups(rest_guides, hair->hairs(), settings.growth);
    selected = {};
    statistics.hairs_grown = hair->hairs().size();
  }

  /// Bounds of hair and body; the guides' bounds are widened by the hairs' reach.
  Box content() const {
    Box box = boundsOf(guides, place);
    if (!box.isEmpty()) box = widened(box, groups.reach() + settings.hair_width * widest_hair);
    box.extend(moved(body.bounds(), head));
    box.extend(body.bounds());  // a part of it may stay at rest
    return box;
  }

  std::vector<Visibility> visibilityOfGroups() {
    if (guides.size() == nodes->vertices())
      groups.place(guides, place, settings.hair_width * widest_hair + 2 * settings.clearance);
    const ViewVolume view(block.view_projection);
    std::vector<Visibility> visibility(groups.count(), Visibility::kCulled);
    statistics.groups = groups.count();
    statistics.groups_seen = 0;
    for (size_t g = 0; g < groups.count(); ++g) {
      if (!groups.box(g).isEmpty()) {
        if (!view.misses(cornersOf(groups.box(g))))
          visibility[g] = Visibility::kVisible;
        else if (castsInto(view, groups.box(g)))
          visibility[g] = Visibility::kShadowOnly;
      }
      statistics.groups_seen += visibility[g] == Visibility::kVisible;
    }
    return visibility;
  }

  /// Whether anything in the box may cast a shadow into the view.
  bool castsInto(const ViewVolume& view, const Box& box) const {
    for (size_t light = 0; light < shadows->lights(); ++light) {
      const Eigen::Vector3f beside = Eigen::Vector3f::Constant(map_widths[light] * shadows->lookupRadius());
      if (!view.misses(shadowOf(Box(box.min() - beside, box.max() + beside), block.lights[light])))
        return true;
    }
    return false;
  }

  /// Corners whose hull contains the box and its shadow volume.
  static std::array<Eigen::Vector3f, 16> shadowOf(const Box& box, const LightBlock& light) {
    const BoxCorners corners = cornersOf(box);
    const Eigen::Vector3f from = light.place.head<3>();
    const bool placed = light.place.w() > 0;
    // For a light with a position: one factor for all corners, a linear map, so the hull maps to their hull.
    const float farther = light.way.w() / std::max(box.exteriorDistance(from), 1e-3f);
    std::array<Eigen::Vector3f, 16> swept;
    for (size_t i = 0; i < 8; ++i) {
      const Eigen::Vector3f away = placed ? Eigen::Vector3f(farther * (corners[i] - from))
                                          : Eigen::Vector3f(-light.way.w() * light.way.head<3>());
      swept[i] = corners[i];
      swept[i + 8] = corners[i] + away;
    }
    return swept;
  }

  /// Width in pixels of a hair of width 1 where visible hair is nearest to the eye.
  float widestHair(const std::vector<Visibility>& visibility) const {
    float distance = std::numeric_limits<float>::infinity();
    for (size_t g = 0; g < visibility.size(); ++g)
      if (visibility[g] == Visibility::kVisible && !groups.box(g).isEmpty())
        distance = std::min(distance, groups.box(g).exteriorDistance(block.eye.head<3>()));
    if (!std::isfinite(distance)) distance = 1;
    return block.hair_color.w() * block.eye.w() / std::max(distance, depth_range.near);
  }

  /// Line width in pixels: that of the widest hair at the nearest visible guide vertex. Group boxes would
  /// overestimate it for an eye near one.
  float lineWidth() const {
    float nearest = std::numeric_limits<float>::infinity();
    for (const Vec3& p : guides) {
      const Eigen::Vector4f clip = block.view_projection * Eigen::Vector4f(p.x(), p.y(), p.z(), 1);
      const bool seen = clip.w() > depth_range.near && clip.head<2>().cwiseAbs().maxCoeff() < clip.w();
      if (seen && clip.w() < nearest) nearest = clip.w();
    }
    const float widest = std::max(1.25f, widest_hair) * block.hair_color.w() * block.eye.w() / nearest;
    return std::clamp(widest * std::max(1 / detail.threshold, 1.0f), 1.0f, widest_line);
  }

  /// Line width in a light's maps of `size` texels per side, whole texels: that of a hair of width 1 at the
  /// centre of the lit bounds.
  float lineInMap(size_t light, int size) const {
    const LightBlock& l = block.lights[light];
    float per_metre = l.cone.z() * static_cast<float>(size) / static_cast<float>(shadows->opacitySize());
    if (l.place.w() > 0) per_metre /= std::max((l.place.head<3>() - lit.center()).norm(), 0.1f);
    const float width = settings.hair_width * std::max(1 / shadow_detail.threshold, 1.0f);
    return std::clamp(std::round(width * per_metre), 1.0f, widest_line);
  }

  /// Lists the picture's hairs: drawn ones first, then those that only cast shadows. Sets the counts of both
  /// details accordingly.
  void selectHairs(const std::vector<Visibility>& visibility) {
    Selection wanted{settings.cull ? visibility : std::vector(visibility.size(), Visibility::kVisible),
                     detail.hairs, shadows->lights() > 0 ? shadow_detail.hairs : detail.hairs};
    if (wanted != selected) {
      std::vector<uint32_t> list;
      for (size_t i = 0; i < wanted.drawn; ++i)
        if (wanted.visibility[groups.groupOf(i)] == Visibility::kVisible)
          list.push_back(static_cast<uint32_t>(i));
      seen_hairs = list.size();
      for (size_t i = 0; i < wanted.shading; ++i) {
        const Visibility own = wanted.visibility[groups.groupOf(i)];
        if (own == Visibility::kShadowOnly || (own == Visibility::kVisible && i >= wanted.drawn))
          list.push_back(static_cast<uint32_t>(i));
      }
      computed_hairs = list.size();
      hair->select(list);
      selected = std::move(wanted);
    }
    detail.hairs = seen_hairs;
    shadow_detail.hairs = computed_hairs;
    statistics.hairs_computed = computed_hairs;
  }

  /// Factor of lengths that are fixed for content the size of a head; below 1 for smaller content.
  float scale() const {
    const Box box = rest_bounds.merged(body.bounds());
    return box.isEmpty() ? 1 : std::clamp(box.diagonal().norm() / kSmall, 1e-3f, 1.0f);
  }

  /// As SceneBlock::ground: the body stands on it, and hair at rest does not touch it.
  Eigen::Vector4f ground() const {
    const Box& base = body.bounds().isEmpty() ? rest_bounds : body.bounds();
    if (base.isEmpty()) return {0, -0.5f, 0, 2};
    float height = base.min().y();
    if (!rest_bounds.isEmpty()) height = std::min(height, rest_bounds.min().y() - kBelowHair * scale());
    return {base.center().x(), height, base.center().z(),
            std::max(4 * base.diagonal().norm(), 0.1f * scale())};
  }

  static Box boxOfGround(const Eigen::Vector4f& ground) {
    const Eigen::Vector3f middle = ground.head<3>(), radius(ground.w(), 0, ground.w());
    return {middle - radius, middle + radius};
  }

  /// `widest`: width in pixels of a hair of width 1 at its nearest point.
  HairDetail detailFor(float widest) const {
    const LevelOfDetail& wanted = settings.detail;
    const float finest =
        wanted.finest_hair > 0 ? wanted.finest_hair : 1 / static_cast<float>(picture->samples());
    HairDetail chosen = wanted.part > 0 ? detailOfPart(hair->hairs(), wanted.part)
                                        : detailOfSize(hair->hairs(), widest, finest);
    const auto stride = [&](float length, int segments, int least) {
      const float segment_pixels = length / static_cast<float>(segments) * widest / block.hair_color.w();
      return strideFor(segment_pixels, wanted.longest_segment, segments, least);
    };
    chosen.node_stride = stride(longest_guide, settings.segments, min_segments);
    if (bound_segments > 0) chosen.vertex_stride = stride(longest_bound, bound_segments, min_bound_segments);
    return chosen;
  }

  /// Light passes through many hairs: with only the visible ones its maps would be noisy.
  HairDetail shadowDetailFor(const HairDetail& seen) const {
    HairDetail chosen = detailOfSize(hair->hairs(), kShadowHairs * seen.threshold, 1);
    chosen.node_stride = seen.node_stride;
    chosen.vertex_stride = seen.vertex_stride;
    return chosen;
  }

  void accept(const GuideFrame& frame) {
    const bool fits = frame.positions.size() == nodes->vertices() && frame.head.position.allFinite() &&
                      frame.head.rotation.coeffs().allFinite() && frame.head.rotation.norm() > 1e-6f;
    if (!fits) {
      ++statistics.frames_ignored;
      return;
    }
    guides = frame.positions;
    head = frame.head;
    place.carryTo(head);
    colliders = frame.colliders;
  }

  PictureGeometry geometry(const GuideFrame& frame) {
    accept(frame);
    body.setColliderPoses(colliders);
    std::vector<uint32_t> all(hair->hairs().size());
    std::iota(all.begin(), all.end(), 0u);
    hair->select(all);
    selected = {};  // the next picture lists its hairs again
    PictureGeometry result;
    if (!all.empty()) {
      nodes->update(guides, head, colliders);
      hair->bodies().place(head, colliders);
      hair->grow(*nodes, hair->all());
      addGrownHair(*hair, settings, result);
    }
    result.body = body.mesh(head);
    const Eigen::Vector4f below = ground();
    result.ground_center = below.head<3>();
    result.ground_radius = below.w();
    return result;
  }

  void draw(const Camera& camera) {
    prepare(camera);
    setPassState();
    picture->clear();
    clock.restart();
    clock.stamp();
    for (const RenderPass pass : settings.passes) {
      run(pass);
      clock.stamp();
    }
    glDisable(GL_FRAMEBUFFER_SRGB);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glUseProgram(0);
    ++statistics.frames_drawn;
  }

  /// Sets the state that the passes of this picture share.
  void prepare(const Camera& camera) {
    RenderSettings large = settings;
    large.width *= settings.supersampling;
    large.height *= settings.supersampling;
    lit = content();
    const Eigen::Vector4f below = ground();
    depth_range =
        depthRange(clipped(camera), static_cast<float>(large.width) / static_cast<float>(large.height),
                   std::array{lit, boxOfGround(below)});
    block = makeSceneBlock(large, camera, depth_range);
    block.ground = below;
    for (size_t light = 0; light < shadows->lights(); ++light)
      map_widths[light] = shadows->fit(block.lights[light], lit, scale());
    const std::vector<Visibility> visibility = visibilityOfGroups();
    const float widest = held_width.of(widestHair(visibility), settings.detail.hysteresis);
    block.sampling.x() = static_cast<float>(picture->samples());
    block.sampling.z() = scale();
    detail = detailFor(widest);
    shadow_detail = shadowDetailFor(detail);
    selectHairs(visibility);
    block.sampling.y() = lineWidth();
    scene_buffer.write(std::span<const SceneBlock>(&block, 1));
    glBindBufferBase(GL_UNIFORM_BUFFER, binding::kScene, scene_buffer.id());
    statistics.hairs_drawn = detail.hairs;
    statistics.segments_drawn = (settings.segments + detail.node_stride - 1) / detail.node_stride;
  }

  void run(RenderPass pass) {
    switch (pass) {
      case RenderPass::kGuides:
        statistics.guides_unusable = shadow_detail.hairs > 0 || settings.marks.any()
                                         ? nodes->update(guides, head, colliders)
                                         : nodes->check(guides);
        return;
      case RenderPass::kGrowth:
        hair->bodies().place(head, colliders);
        hair->grow(*nodes, shadow_detail);
        return;
      case RenderPass::kSolidShadow:
        for (size_t light = 0; light < shadows->lights(); ++light) {
          shadows->beginSolids(light);
          body.drawDepth(head, light);
        }
        return;
      case RenderPass::kHairShadow:
        for (size_t light = 0; light < shadows->lights(); ++light) {
          shadows->beginHairFront(light);
          hair->drawFront(*nodes, shadow_detail, light, lineInMap(light, shadows->frontSize()));
          shadows->beginHairOpacity(light);
          hair->drawOpacity(*nodes, shadow_detail, light, shadows->opacitySize(),
                            lineInMap(light, shadows->opacitySize()));
          shadows->end();
        }
        return;
      case RenderPass::kBackground:
        beginPicture();
        body.drawBackground();
        return;
      case RenderPass::kBody:
        beginPicture();
        body.drawBody(head);
        return;
      case RenderPass::kGround:
        beginPicture();
        body.drawGround();
        return;
      case RenderPass::kHair:
        drawHair();
        return;
      case RenderPass::kMarks:
        if (!settings.marks.any()) return;
        beginPicture();
        marks.draw(settings.marks, *nodes, *hair, hair_radius + kTouching);
        return;
      case RenderPass::kResolve:
        picture->resolve();
        if (still) still->draw(picture->resolvedTexture());
        return;
    }
  }

  void beginPicture() const {
    picture->bindForDrawing();
    shadows->bindTextures();
  }

  void drawHair() {
    beginPicture();
    if (settings.coverage == HairCoverage::kAlphaToCoverage && picture->samples() > 1)
      glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    hair->drawColor(*nodes, block, detail);
    glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  }

  GLuint shownTexture() const { return still ? still->texture().id() : picture->resolvedTexture(); }
  GLuint shownFramebuffer() const {
    return still ? still->framebuffer().id() : picture->resolvedFramebuffer();
  }

  RenderSettings settings;
  std::unique_ptr<PictureBuffer> picture;
  std::unique_ptr<Supersampling> still;  // null without supersampling
  std::unique_ptr<ShadowMaps> shadows;
  std::unique_ptr<GuideNodes> nodes;
  std::unique_ptr<HairPass> hair;
  std::vector<HairObstacle> obstacles;
  BodyPass body;
  Marks marks;
  gl::PassClock clock;
  gl::Buffer scene_buffer;
  float widest_line = 1;
  StrandSet rest_guides;
  std::vector<uint8_t> seeded;  // per guide, 1: hair from the seed may follow it; empty: all
  std::vector<Vec3> guides;     // of the newest frame that matched the groom
  Pose head;
  PlausibleBounds place;
  std::vector<PlacedCollider> colliders;
  Box rest_bounds;
  HairDescription bound;
  float longest_guide = 0, longest_bound = 0;  // m
  float hair_radius = 0;                       // m, of the groom
  int min_segments = 1;
  int bound_segments = 0, min_bound_segments = 1;  // of the bound hair with the most vertices
  float widest_hair = 1;                           // factor of the settings' width, at least 1
  // State of the picture in progress.
  Box lit;
  DepthRange depth_range;
  SceneBlock block{};
  std::array<float, kMaxLights> map_widths{};  // m, upper bound on the width of each light's shadow maps
  HairDetail detail, shadow_detail;
  HairGroups groups;
  Selection selected;
  size_t seen_hairs = 0, computed_hairs = 0;
  HysteresisSize held_width;
  RenderStatistics statistics;
};

Renderer::Renderer(const RenderSettings& settings) {
  requireBuffers(settings.growth_path);
  impl_ = std::make_unique<Impl>(settings);
}

Renderer::~Renderer() = default;

void Renderer::setSettings(const RenderSettings& settings) {
  requireBuffers(settings.growth_path);
  impl_->setSettings(clipped(settings));
}

const RenderSettings& Renderer::settings() const { return impl_->settings; }

void Renderer::setGroom(const GroomDescription& groom) {
  const StrandSet& guides = groom.guides;
  if (guides.offsets.empty() || guides.offsets.back() != guides.positions.size() ||
      (!groom.seeded.empty() && groom.seeded.size() != guides.strands()))
    throw Error("a groom is damaged", groom.name, "its strands and its vertices do not fit together");
  impl_->rest_guides = guides;
  impl_->seeded = (groom.growth & GroomDescription::kFromSeed) != 0
                      ? groom.seeded
                      : std::vector<uint8_t>(guides.strands(), 0);
  impl_->hair_radius = groom.hair_radius;
  impl_->bound = {};
  impl_->placeHair();
  impl_->longest_guide = longestOf(guides);
  impl_->guides = guides.positions;
  impl_->head = Pose{};
  impl_->place = PlausibleBounds(guides.positions);
  impl_->rest_bounds = boundsOf(guides.positions, impl_->place);
  impl_->statistics.guides = guides.strands();
}

void Renderer::setHairs(const HairDescription& hairs) {
  const bool any = hairs.hairs.strands() > 0;
  if (any) {
    requireBuffers(GrowthPath::kCompute);
    checkHairs(hairs, impl_->rest_guides, "bound hairs");
  } else if (impl_->bound.hairs.strands() == 0) {
    return;
  }
  impl_->bound = hairs;
  impl_->longest_bound = longestOf(hairs.hairs);
  try {
    impl_->placeHair();
  } catch (const Error&) {  // too large for the device
    impl_->bound = {};
    impl_->placeHair();
    throw;
  }
}

void Renderer::setBody(const BodyDescription& body) { impl_->body.setBody(body); }

void Renderer::setObstacles(std::vector<HairObstacle> obstacles) {
  impl_->hair->bodies().setObstacles(obstacles);
  impl_->body.setObstacles(obstacles);
  impl_->nodes->setObstacles(obstacles);
  impl_->obstacles = std::move(obstacles);
}

PictureGeometry Renderer::geometry(const GuideFrame& frame) { return impl_->geometry(frame); }

void Renderer::draw(const GuideFrame& frame, const Camera& camera) {
  impl_->accept(frame);
  impl_->body.setColliderPoses(impl_->colliders);
  impl_->draw(camera);
}

Image Renderer::read() {
  Image image;
  image.width = impl_->settings.width;
  image.height = impl_->settings.height;
  const size_t row = static_cast<size_t>(image.width) * 3;
  std::vector<uint8_t> bottom_up(row * image.height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(impl_->shownTexture(), 0, GL_RGB, GL_UNSIGNED_BYTE,
                    static_cast<GLsizei>(bottom_up.size()), bottom_up.data());
  image.rgb.reserve(bottom_up.size());
  for (int y = image.height - 1; y >= 0; --y)
    image.rgb.insert(image.rgb.end(), bottom_up.begin() + row * y, bottom_up.begin() + row * (y + 1));
  return image;
}

void Renderer::present(int left, int below, int width, int height) {
  if (width <= 0 || height <= 0) return;
  glDisable(GL_FRAMEBUFFER_SRGB);  // the picture is stored as sRGB already
  glBlitNamedFramebuffer(impl_->shownFramebuffer(), 0, 0, 0, impl_->settings.width, impl_->settings.height,
                         left, below, left + width, below + height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

float Renderer::hairReach() const { return impl_->groups.meanReach(); }

RenderStatistics Renderer::statistics() const {
  RenderStatistics statistics = impl_->statistics;
  statistics.samples = impl_->picture->samples();
  if (statistics.frames_drawn == 0) return statistics;
  statistics.passes.clear();
  for (size_t i = 0; i < impl_->settings.passes.size(); ++i)
    statistics.passes.push_back({impl_->settings.passes[i], impl_->clock.milliseconds(i)});
  for (const PassTime& time : statistics.passes) statistics.*sumOf(time.pass) += time.ms;
  statistics.device_bytes = impl_->nodes->bytes() + impl_->hair->bytes() + impl_->shadows->bytes();
  return statistics;
}

}  // namespace strandcast
