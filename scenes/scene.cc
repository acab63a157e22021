#include "scenes/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "collision/field_bake.h"
#include "collision/field_cache.h"
#include "collision/mesh_query.h"
#include "collision/primitive_fit.h"
#include "core/error.h"
#include "core/hash.h"
#include "groom/groom.h"
#include "groom/groom_operations.h"
#include "groom/hair_binding.h"
#include "groom/procedural_body.h"
#include "io/mesh_file.h"
#include "scenes/head_motion.h"

namespace strandcast {
namespace {

constexpr float kHairDamping = 2e-3f;  // s: at 10 Hz, 6 % of critical
// 1/s. Still air takes 3.8 1/s from a hair of 80 um that creeps across it (slender body, 25 cm long). From
// some cm/s on it takes several times that, by the drag of a cylinder. Inside a tress the drag is less.
constexpr float kHairAirDrag = 5;

struct NamedScene {
  SceneInfo info;
  ProceduralGroomOptions groom;
  const char* motion;
  float shape_rate, shape_rate_tip;  // 1/s
};

const std::vector<NamedScene>& namedScenes() {
  static const std::vector<NamedScene> list = {
      {{"straight", "long straight hair with a parting, on the procedural head"},
       {HairStyle::kStraight, 2400, 28, 0.34f, 1},
       "shake",
       120,
       15},
      {{"wavy", "shoulder-length waves, on the procedural head"},
       {HairStyle::kWavy, 2400, 28, 0.30f, 1},
       "nod+turn",
       200,
       60},
      {{"curly", "a full head of curls, on the procedural head"},
       {HairStyle::kCurly, 2400, 40, 0.26f, 1},
       "shake",
       400,
       200},
      {{"ponytail", "hair combed back into a tail, on the procedural head"},
       {HairStyle::kPonytail, 2400, 28, 0.42f, 1},
       "shake",
       120,
       20},
  };
  return list;
}

const NamedScene& namedScene(const std::string& name) {
  std::string names;
  for (const NamedScene& scene : namedScenes()) {
    if (scene.info.name == name) return scene;
    names += (names.empty() ? "" : ", ") + scene.info.name;
  }
  throw Error("unknown scene", name, "choose one of " + names);
}

std::vector<std::filesystem::path> guideFiles(const SceneOptions& options) {
  return options.guides.file.empty() ? options.groom
                                     : std::vector<std::filesystem::path>{options.guides.file};
}

/// Empty where hairs, if any, are strands of the guides' files.
std::vector<std::filesystem::path> hairFiles(const SceneOptions& options) {
  return options.guides.file.empty() ? options.hairs : options.groom;
}

/// Sets the materials of parts, and hair_radius from the thickest. Called before any bake: fields depend on
/// it, and errors appear early.
void makeMaterials(const SceneOptions& options, Scene& scene) {
  scene.materials = partMaterials(options.materials, scene.part_names);
  const float thickest = std::min(thickestRadius(scene.materials), kThickestHair);
  if (!(thickest > scene.parameters.hair_radius)) return;
  scene.parameters.hair_radius = thickest;
  if (options.hair_radius_is_set) return;
  scene.notes.push_back(
      fmt::format("hair_radius is {:.3g} mm, from the thickest material: the axis of all hair keeps this "
                  "distance from bodies; --hair-width sets the drawn width",
                  1e3 * static_cast<double>(thickest)));
}

/// Options for the fields of this scene's bodies. Thick hair does not make the fields coarser.
FieldOptions fieldOptions(const SceneOptions& options, const Scene& scene) {
  FieldOptions out;
  out.thickest_hair = scene.parameters.hair_radius;
  out.cell = options.body_cell;
  return out;
}

void report(const Progress& progress, const std::string& what, double part) {
  if (progress && !progress(what, part)) throw BakeStopped();
}

/// Sets the head's motion. `own`: the default motion.
void moveHead(const SceneOptions& options, const char* own, Scene& scene) {
  ClipMotionOptions clip;
  clip.unit_meters = options.clip_unit_meters;
  if (scene.skinned) clip.skeleton = &scene.skinned->skin().skeleton;
  scene.motion = headMotion(options.motion.empty() ? own : options.motion, scene.head_pivot, clip,
                            &scene.notes, &scene.warnings);
}

Scene makeProceduralScene(const SceneOptions& options, const Progress& progress) {
  const NamedScene& named = namedScene(options.name);
  Scene scene;
  scene.parameters = sceneParameters(options);
  scene.name = named.info.name;
  scene.part_names = {scene.name};
  makeMaterials(options, scene);
  report(progress, "sculpting the body", 0.1);
  static const ProceduralBody kSculpted = makeProceduralBody();  // shared by all scenes of the process
  ProceduralBody body = kSculpted;
  const ProceduralGroomOptions groom = proceduralGroomOf(options);
  constexpr double kFrom = 0.15, kTo = 0.45;  // range of the scene's progress
  scene.groom = makeProceduralGroom(
      groom, [&](double part) { report(progress, "growing hair", kFrom + part * (kTo - kFrom)); });
  scene.body = std::move(body.mesh);
  scene.head_weights = std::move(body.head_weight);
  scene.bodies.push_back({std::move(body.head), true});
  scene.bodies.push_back({std::move(body.shoulders), false});
  scene.head_pivot = body.neck_pivot;
  moveHead(options, named.motion, scene);
  return scene;
}

/// Shrinks spheres until no free vertex of the groom at rest lies inside. An inextensible strand cannot be
/// pushed out of a body if its root is deep inside. Real roots are up to centimetres under the skin.
void keepOutOfRestingHair(const StrandSet& strands, float hair_radius,
                          std::vector<ContactPrimitive>& spheres) {
  constexpr float kMargin = 2e-4f, kSmallest = 2e-3f;  // m
  for (ContactPrimitive& sphere : spheres)
    for (size_t s = 0; s < strands.strands(); ++s)
      for (size_t i = 1; i < strands.verticesOf(s); ++i)
        if (!strands.isPinned(s, i))
          sphere.radius =
              std::min(sphere.radius, (strands.strand(s)[i] - sphere.a).norm() - hair_radius - kMargin);
  std::erase_if(spheres, [](const ContactPrimitive& sphere) { return sphere.radius < kSmallest; });
}

void fillBody(const SceneOptions& options, const Progress& progress, Scene& scene) {
  report(progress, "fitting spheres into the body", 0.6);
  PrimitiveFitOptions fit;
  fit.max_primitives = options.body_primitives;
  const OrientedSurface oriented = orientSurface(scene.body);
  for (const std::string& line : oriented.repair.lines()) scene.warnings.push_back("the body: " + line);
  RigidBody body{fitSpheres(oriented.mesh, fit), true};
  const size_t fitted = body.primitives.size();
  keepOutOfRestingHair(scene.groom.strands, scene.parameters.hair_radius, body.primitives);
  if (!body.primitives.empty())
    scene.notes.push_back(fmt::format("{} spheres represent the body in collisions", body.primitives.size()));
  else if (options.body_primitives == 0)
    scene.notes.push_back("no spheres are fitted into the body (fitted_spheres = 0): hair passes through it");
  else if (fitted == 0)
    scene.warnings.push_back("no sphere fits into the body mesh: hair passes through it");
  else
    scene.warnings.push_back(
        fmt::format("hair at rest lies in each of the {} spheres fitted into the body, so all are left out: "
                    "hair passes through it",
                    fitted));
  scene.bodies.push_back(std::move(body));
}

void bakeBody(const SceneOptions& options, const Progress& progress, Scene& scene) {
  constexpr double kFrom = 0.45, kTo = 0.95;  // range of the scene's progress
  const FieldOptions field = fieldOptions(options, scene);
  const FieldCache cache(options.field_cache);
  SceneField baked = fieldOf(
      scene.body, field, cache,
      [&](const std::string& what, double part) {
        return !progress || progress("the body's distance field: " + what, kFrom + part * (kTo - kFrom));
      },
      bakesOf(options.bake_begins, "the body"));
  (baked.trouble.empty() ? scene.notes : scene.warnings).push_back(std::move(baked.note));
  ContactPrimitive shape;
  shape.kind = PrimitiveKind::kField;
  shape.field = std::make_shared<const DistanceField>(std::move(baked.field));
  for (const std::string& warning : baked.warnings) scene.warnings.push_back("the body: " + warning);
  scene.bodies.push_back({{std::move(shape)}, true, true});
}

/// Bakes the fields of the parts, with the cell that one field of the whole body would have.
void bakeParts(const SceneOptions& options, const Progress& progress, Scene& scene,
               std::shared_ptr<SkinnedBody> skinned) {
  constexpr double kFrom = 0.45, kTo = 0.95;  // range of the scene's progress
  FieldOptions field = fieldOptions(options, scene);
  field.cell = resolveFieldOptions(scene.body, field).cell;
  field.is_oriented = true;  // the skin from which they are cut is oriented
  const FieldCache cache(options.field_cache);
  size_t bytes = 0, found = 0;
  skinned->first_body = scene.bodies.size();
  std::vector<NamedMesh> meshes;
  for (const SkinPart& part : skinned->parts()) meshes.push_back({part.name, &part.mesh});
  std::vector<SceneField> fields = fieldsOf(
      meshes, field, cache,
      [&](const std::string& what, double share) {
        return !progress ||
               progress("the distance fields of the skin: " + what, kFrom + share * (kTo - kFrom));
      },
      bakesOf(options.bake_begins, "the skinned body"));
  for (size_t i = 0; i < fields.size(); ++i) {
    const SkinPart& part = skinned->parts()[i];
    SceneField& baked = fields[i];
    bytes += baked.field.bytes();
    found += baked.from_cache ? 1 : 0;
    if (!baked.trouble.empty()) scene.warnings.push_back(baked.note);
    ContactPrimitive shape;
    shape.kind = PrimitiveKind::kField;
    shape.field = std::make_shared<const DistanceField>(std::move(baked.field));
    for (const std::string& warning : baked.warnings)
      scene.warnings.push_back(fmt::format("{}: {}", part.name, warning));
    scene.bodies.push_back(
        {.primitives = {std::move(shape)}, .holds_roots = true, .bends = !part.samples.empty()});
  }
  scene.notes.push_back(fmt::format(
      "the skinned body's distance fields: {} parts, cells of {:.3g} mm, {:.1f} MiB, {} found in the cache",
      skinned->parts().size(), 1e3 * field.cell, static_cast<double>(bytes) / (1 << 20), found));
  scene.skinned = std::move(skinned);
}

/// The point of a field's grid nearest to `place`.
Vec3 nearestOf(const FieldGrid& grid, const Vec3& place) {
  const Vec3 low(grid.origin[0], grid.origin[1], grid.origin[2]);
  Vec3 size;
  for (int c = 0; c < 3; ++c) size[c] = grid.cell * static_cast<float>(kBrickCells * grid.bricks[c]);
  return place.cwiseMax(low).cwiseMin(low + size);
}

/// Notes the distance of the parts' fields from the blended skin over the clip.
void noteBodyMotion(Scene& scene) {
  constexpr int kLooks = 8;
  const SkinnedBody& skinned = *scene.skinned;
  if (!skinned.hasClip()) return;
  double sum = 0, count = 0;
  float below = 0, above = 0;
  for (int look = 1; look <= kLooks; ++look) {
    const double seconds = kStartSeconds + skinned.duration() * look / kLooks;
    std::vector<SkinnedBody::PlacedPart> parts = skinned.placedParts(skinned.at(seconds, Pose{}));
    for (SkinnedBody::PlacedPart& part : parts) part.pose = part.pose.inverse();
    for (const Vec3& p : skinned.surface(seconds, Pose{})) {
      float distance = std::numeric_limits<float>::max();
      for (size_t i = 0; i < parts.size(); ++i) {
        const ContactPrimitive& shape = scene.bodies[skinned.first_body + i].primitives[0];
        const Vec3 place = parts[i].pose.apply(p);
        // As in contact (kernels/distance_field.h): outside the grid the bend at the grid's border applies.
        const Vec3 shift = parts[i].bend.shift(nearestOf(shape.field->grid, place));
        distance = std::min(distance, shape.field->at(place + shift).distance);
      }
      sum += static_cast<double>(std::fabs(distance));
      below = std::max(below, distance);
      above = std::max(above, -distance);
      count += 1;
    }
  }
  scene.notes.push_back(fmt::format(
      "the parts are {:.2f} mm from the skin's vertices in the mean of {} moments of the clip, {:.1f} mm at "
      "most below it, {:.1f} mm above",
      1e3 * sum / count, kLooks, 1e3 * static_cast<double>(below), 1e3 * static_cast<double>(above)));
}

/// Notes the share of hair that is inside the body at rest.
void noteHairInBody(const StrandSet& strands, const std::vector<RigidBody>& bodies,
                    std::vector<std::string>& notes) {
  std::vector<const DistanceField*> fields;
  for (const RigidBody& body : bodies)
    for (const ContactPrimitive& shape : body.primitives)
      if (shape.field) fields.push_back(shape.field.get());
  if (fields.empty()) return;
  size_t inside = 0, free = 0;
  float deepest = 0;
  for (size_t s = 0; s < strands.strands(); ++s)
    for (size_t i = 1; i < strands.verticesOf(s); ++i) {
      if (strands.isPinned(s, i)) continue;
      float distance = std::numeric_limits<float>::max();
      for (const DistanceField* field : fields)
        distance = std::min(distance, field->at(strands.strand(s)[i]).distance);
      ++free;
      inside += distance < 0;
      deepest = std::min(deepest, distance);
    }
  if (inside > 0)
    notes.push_back(
        fmt::format("{:.1f} % of the hair's vertices are inside the body at rest, by up to {:.1f} mm: they "
                    "may stay that deep",
                    100.0 * static_cast<double>(inside) / static_cast<double>(free), -1e3 * deepest));
}

/// Mean distance from the body, m, of the nearer ends of a sample of the strands, scaled by `scale`.
double meanDistance(const StrandSet& strands, const ClosestPoint& scalp, float scale) {
  constexpr size_t kSample = 500;
  const size_t every = std::max<size_t>(strands.strands() / kSample, 1);
  double sum = 0, count = 0;
  for (size_t s = 0; s < strands.strands(); s += every, ++count)
    sum += static_cast<double>(std::min(scalp(scale * strands.strand(s).front()).distance,
                                        scalp(scale * strands.strand(s).back()).distance));
  return sum / count;
}

/// Replaces a unit of the groom that is guessed from its size: the usual unit with which the roots lie
/// nearest to a body of known unit is more reliable.
void fitUnitToBody(const SceneOptions& options, const ClosestPoint& scalp, Scene& scene) {
  constexpr double kClearlyNearer = 0.5;              // share of the previous distance
  constexpr double kOnBody = 0.05, kRounding = 1e-4;  // share of the body's diagonal
  const float by_size = scene.groom.report.unit_meters;
  const auto distanceWith = [&](float unit) {
    return meanDistance(scene.groom.strands, scalp, unit / by_size);
  };
  float best = by_size;
  double nearest = distanceWith(by_size);
  const double before = nearest;
  for (const float unit : usualUnits())
    if (const double distance = distanceWith(unit); distance < nearest) {
      best = unit;
      nearest = distance;
    }
  const auto size = static_cast<double>(scene.body.bounds().diagonal().norm());
  if (!(nearest < kClearlyNearer * before && before - nearest > kRounding * size && nearest < kOnBody * size))
    return;
  GroomReadOptions units = options.units;
  units.unit_meters = best;
  scene.groom = loadGroom(guideFiles(options), units);
  scene.groom.report.warnings.push_back(
      fmt::format("{}: the unit is guessed: {:g} m, with which the roots are {:.1f} mm off the body ({:.1f} "
                  "mm with {:g} m, the guess from the groom's size alone); give --unit-meters to be sure",
                  options.groom.front().string(), best, 1e3 * nearest, 1e3 * before, by_size));
}

/// Warns when the sizes of hair and body suggest different units.
void warnOfSizes(const TriangleMesh& body, const StrandSet& strands, std::vector<std::string>& warnings) {
  constexpr float kMaxRatio = 100;
  Box hair;
  for (const Vec3& p : strands.positions) hair.extend(Eigen::Vector3f(p));
  const float hair_size = hair.sizes().maxCoeff(), body_size = body.bounds().sizes().maxCoeff();
  if (hair_size > kMaxRatio * body_size || body_size > kMaxRatio * hair_size)
    warnings.push_back(
        fmt::format("the hair is {:.3g} m large and the body {:.3g} m: correct the wrong unit "
                    "(--unit-meters, --body-unit-meters)",
                    hair_size, body_size));
}

/// Warns when the distance of the roots suggests different units.
void warnOfFarRoots(const TriangleMesh& body, const RootBinding& binding,
                    std::vector<std::string>& warnings) {
  constexpr float kFar = 0.1f;  // share of the body's diagonal
  const float size = body.bounds().diagonal().norm();
  if (binding.mean_distance > kFar * size)
    warnings.push_back(
        fmt::format("roots are {:.3g} m off the body on average, whose diagonal is {:.3g} m: do groom and "
                    "body have the right units (--unit-meters, --body-unit-meters) and the same place?",
                    binding.mean_distance, size));
}

/// Passes warnings on early: a wrong unit should be known before minutes are spent on a bake.
void reportWarnings(const SceneOptions& options, Scene& scene) {
  if (!options.warns_early) return;
  for (std::vector<std::string>* lines : {&scene.groom.report.warnings, &scene.warnings})
    for (const std::string& line : std::exchange(*lines, {})) options.warns_early(line);
}

ClosestPoint scalpOf(const TriangleMesh& body) {
  return [query = std::make_shared<MeshQuery>(body)](const Vec3& point) {
    const MeshPoint found = query->closest(point);
    return SurfacePoint{found.position, found.triangle, found.barycentric, found.distance};
  };
}

/// Notes what could move the body but is not read.
void noteRig(const SceneOptions& options, Scene& scene) {
  const BodyRig& rig = scene.body_rig;
  std::vector<std::string> parts, remedies;
  if (!rig.joints.empty()) {
    parts.push_back(fmt::format("{} joints", rig.joints.size()));
    remedies.emplace_back("--body-joint or --body-clip");
  }
  if (!rig.targets.empty()) {
    parts.push_back(fmt::format("{} morph targets", rig.targets.size()));
    remedies.emplace_back("--body-targets all");
  }
  if (parts.empty()) return;
  scene.notes.push_back(
      fmt::format("{} has {} and is read without them; clips and live poses move it with {}",
                  options.body.filename().string(), fmt::join(parts, " and "), fmt::join(remedies, " and ")));
}

void fitBody(const SceneOptions& options, const Progress& progress, Scene& scene) {
  report(progress, "reading the body", 0.2);
  const GroomReadOptions units =
      meshUnits(options.body, options.body_units, {scene.groom.report.unit_meters, options.units.up});
  std::shared_ptr<SkinnedBody> skinned;
  if (options.skinned) {
    SkinnedMotion motion = *options.skinned;
    motion.clip_unit_meters = options.clip_unit_meters;
    skinned = std::make_shared<SkinnedBody>(loadSkinnedMesh(options.body, units, motion.targets), motion);
    for (const ScenePrimitive& primitive : options.primitives)
      if (!primitive.joint.empty()) skinned->checkJoint(primitive.joint, primitive.where);
    appendReport(options.body, skinned->skin().report, scene.notes, scene.warnings);
    scene.notes.insert(scene.notes.end(), skinned->notes().begin(), skinned->notes().end());
    for (const std::string& line : skinned->repair().lines()) scene.warnings.push_back("the body: " + line);
    scene.body_rig = skinned->skin().rig;
    scene.body = skinned->skin().mesh;
    scene.head_weights = skinned->jointWeights();
  } else {
    ReadMesh body = loadMesh(options.body, units);
    appendReport(options.body, body.report, scene.notes, scene.warnings);
    scene.body = std::move(body.mesh);
    scene.body_rig = std::move(body.rig);
    noteRig(options, scene);
  }
  report(progress, "binding roots to the body", 0.4);
  const ClosestPoint scalp = scalpOf(scene.body);
  const bool is_unit_known = isGltf(options.body) || options.body_units.unit_meters > 0;
  if (scene.groom.report.is_unit_guessed && is_unit_known) fitUnitToBody(options, scalp, scene);
  orientRoots(scene.groom, scalp);
  warnOfSizes(scene.body, scene.groom.strands, scene.warnings);
  const RootBinding binding = bindRoots(scene.groom.strands, scalp);
  scene.notes.push_back(fmt::format("roots are {:.1f} mm off the body on average, {:.1f} mm at most",
                                    1000 * binding.mean_distance, 1000 * binding.max_distance));
  warnOfFarRoots(scene.body, binding, scene.warnings);
  reportWarnings(options, scene);
  if (options.body_contact == BodyContact::kNone) {
    scene.skinned = std::move(skinned);
  } else if (skinned) {
    bakeParts(options, progress, scene, std::move(skinned));
    noteBodyMotion(scene);
  } else if (options.body_contact == BodyContact::kField)
    bakeBody(options, progress, scene);
  else
    fillBody(options, progress, scene);
}

/// Attaches roots to the skin. Of the 65,535 bones of a model besides the head, `pinned` are reserved for
/// pins.
void growOnSkin(const StrandSet& strands, size_t pinned, Scene& scene) {
  constexpr size_t kMaxBones = std::numeric_limits<uint16_t>::max();
  scene.skinned->growOnSkin(strands, kMaxBones - std::min(pinned, kMaxBones));
  const std::vector<std::string>& found = scene.skinned->roots()->notes();
  scene.notes.insert(scene.notes.end(), found.begin(), found.end());
}

/// Hairs of files of their own, in the unit and at the place of the groom.
StrandSet loadHairs(const SceneOptions& options, const std::vector<std::filesystem::path>& files,
                    Scene& scene) {
  Groom hairs = loadGroom(files, options.units);
  GroomReadOptions units = options.units;
  units.unit_meters = scene.groom.report.unit_meters;
  if (hairs.report.is_unit_guessed && hairs.report.unit_meters != units.unit_meters)
    hairs = loadGroom(files, units);
  if (!scene.body.positions.empty()) orientRoots(hairs, scalpOf(scene.body));
  for (const std::string& line : hairs.report.lines()) scene.notes.push_back("the hairs: " + line);
  for (const std::string& line : hairs.report.warnings) scene.warnings.push_back("the hairs: " + line);
  // Parts are the numbers of files.
  if (files.size() != guideFiles(options).size()) hairs.strands.parts.clear();
  return std::move(hairs.strands);
}

/// Indices of the strands that are marked as guides or, with `marked` false, of the others.
std::vector<uint32_t> strandsThatAre(bool marked, const StrandSet& strands) {
  std::vector<uint32_t> found;
  for (uint32_t s = 0; s < strands.strands(); ++s)
    if ((strands.is_guide[s] != 0) == marked) found.push_back(s);
  return found;
}

/// Takes from the groom the strands that are not guides. Returns the hairs that follow those.
StrandSet takeHairs(const SceneOptions& options, Scene& scene) {
  StrandSet& strands = scene.groom.strands;
  if (const std::vector<std::filesystem::path> files = hairFiles(options); !files.empty())
    return loadHairs(options, files, scene);
  const GuideChoice& choice = options.guides;
  if (choice.all) return {};
  if (choice.share > 0) {
    const auto count =
        static_cast<size_t>(std::lround(choice.share * static_cast<double>(strands.strands())));
    StrandSet hairs = strands;
    strands = subset(strands, chooseGuides(strands, std::max<size_t>(count, 1)));
    return hairs;
  }
  if (strands.is_guide.empty()) return {};
  const std::vector<uint32_t> guides = strandsThatAre(true, strands);
  if (guides.empty() || guides.size() == strands.strands()) return {};
  StrandSet hairs = subset(strands, strandsThatAre(false, strands));
  strands = subset(strands, guides);
  scene.notes.push_back(
      fmt::format("{} strands are marked as guides, and {} others follow them; --guides all simulates all",
                  strands.strands(), hairs.strands()));
  return hairs;
}

/// Files and option of the hairs.
std::string hairSource(const SceneOptions& options) {
  const std::vector<std::filesystem::path> own = hairFiles(options),
                                           &files = own.empty() ? options.groom : own;
  const std::string more = files.size() > 1 ? fmt::format(" and {} more", files.size() - 1) : "";
  return fmt::format("{}{} ({})", files.front().string(), more,
                     options.hairs.empty() ? "--groom" : "--hair-files");
}

void bindSceneHairs(const SceneOptions& options, StrandSet hairs, Scene& scene) {
  if (hairs.strands() == 0) return;
  scene.hairs.source = hairSource(options);
  hairs.pinned.clear();
  hairs.is_guide.clear();
  hairs.groups.clear();
  if (std::ranges::any_of(hairs.radii, [](float radius) { return radius > kThickestHair; })) {
    hairs.radii.clear();
    scene.warnings.push_back("the hairs are drawn without their radii, of which some are above 1 cm");
  }
  const std::vector<HairBinding> bindings = bindHairs(hairs, scene.groom.strands);
  const std::vector<uint32_t> order = orderByGuide(bindings);
  scene.hairs.strands = subset(hairs, order);
  for (const uint32_t h : order) scene.hairs.bindings.push_back(bindings[h]);
  scene.notes.push_back(
      fmt::format("{} hairs follow {} guides", hairs.strands(), scene.groom.strands.strands()));
}

Scene makeFileScene(const SceneOptions& options, const Progress& progress) {
  Scene scene;
  scene.parameters = sceneParameters(options);
  scene.name = options.groom.front().stem().string();
  for (const std::filesystem::path& file : options.groom) scene.part_names.push_back(file.stem().string());
  makeMaterials(options, scene);
  report(progress, "reading the groom", 0.1);
  scene.groom = loadGroom(guideFiles(options), options.units);
  if (!options.body.empty()) fitBody(options, progress, scene);
  StrandSet hairs = takeHairs(options, scene);
  StrandSet& strands = scene.groom.strands;
  if (options.strands > 0 && static_cast<size_t>(options.strands) < strands.strands()) {
    report(progress, "choosing guides", 0.97);
    strands = subset(strands, chooseGuides(strands, static_cast<size_t>(options.strands)));
  } else if (static_cast<size_t>(options.strands) > strands.strands()) {
    scene.warnings.push_back(fmt::format("{} strands are requested, but the groom has {}: all are used",
                                         options.strands, strands.strands()));
  }
  if (options.vertices > 0) {
    strands = resample(strands, options.vertices);
    scene.groom.report.resampled = strands.strands();
    cleanStrands(scene.groom);
  }
  report(progress, "binding hairs to guides", 0.97);
  bindSceneHairs(options, std::move(hairs), scene);
  for (std::string& line : scene.groom.report.lines()) scene.notes.push_back(std::move(line));
  for (const std::string& line : scene.groom.report.warnings) scene.warnings.push_back(line);
  if (!strands.radii.empty())
    scene.notes.push_back("the radii of the groom's files are not simulated: those of [[material]] are");
  noteHairInBody(strands, scene.bodies, scene.notes);

  if (scene.skinned) {
    if (options.skinned->roots == BodyRoots::kSkin) growOnSkin(strands, options.pins.size(), scene);
    scene.head_pivot = scene.skinned->pivot();
  } else {
    // The joint of head and neck is about 8 cm below the centre of the roots.
    for (size_t s = 0; s < strands.strands(); ++s)
      scene.head_pivot += strands.strand(s)[0] / static_cast<float>(strands.strands());
    scene.head_pivot.y() -= 0.08f;
  }
  const char* own = scene.skinned && scene.skinned->hasClip() ? "still" : "turn";
  moveHead(options, own, scene);
  return scene;
}

}  // namespace

const std::vector<SceneInfo>& sceneList() {
  static const std::vector<SceneInfo> list = [] {
    std::vector<SceneInfo> infos;
    for (const NamedScene& scene : namedScenes()) infos.push_back(scene.info);
    return infos;
  }();
  return list;
}

ProceduralGroomOptions proceduralGroomOf(const SceneOptions& options) {
  ProceduralGroomOptions groom = namedScene(options.name).groom;
  groom.seed = options.seed;
  if (options.strands > 0) groom.strands = options.strands;
  if (options.vertices > 0) groom.vertices = options.vertices;
  if (options.length > 0) groom.length = options.length;
  return groom;
}

Parameters sceneParameters(const SceneOptions& options) {
  Parameters parameters;
  parameters.damping_time = kHairDamping;
  parameters.air_drag = kHairAirDrag;
  if (!options.groom.empty()) return parameters;
  const NamedScene& named = namedScene(options.name);
  parameters.shape_rate = named.shape_rate;
  parameters.shape_rate_tip = named.shape_rate_tip;
  return parameters;
}

StrandModel sceneModel(const Scene& scene) {
  StrandModel model = makeStrandModel(scene.groom.strands, scene.materials);
  if (scene.skinned && scene.skinned->roots() != nullptr) scene.skinned->roots()->addTo(model);
  pinParts(model, scene.pins, scene.part_names, scene.groom.strands.parts);
  return model;
}

namespace {

/// Throws Error on options that do not apply to the kind of groom, of files or procedural.
void checkHair(const SceneOptions& options) {
  const GuideChoice& guides = options.guides;
  if (options.groom.empty() && (!options.hairs.empty() || !guides.file.empty() || guides.share > 0))
    throw Error("a procedural scene has no hairs that follow guides",
                "hairs or guides (--hair-files, --guides)", "name groom files (--groom)");
  if (!options.hairs.empty() && (!guides.file.empty() || guides.share > 0 || guides.all))
    throw Error("where hairs have files of their own, all strands of the groom are guides",
                "guides (--guides)", "leave hairs or guides out");
  if (options.groom.empty() && !options.body.empty())
    throw Error("no hair is given for this body", options.body.string(),
                "name groom files (--groom), or leave the body out: procedural scenes have their own");
  if (!options.groom.empty() && options.length > 0)
    throw Error("hair of groom files has its own length", options.groom.front().string(),
                "leave length out (--length): it is for procedural scenes");
}

/// Throws Error on units of files that are not given.
void checkUnits(const SceneOptions& options) {
  const bool has_body_units = options.body_units.unit_meters > 0 || options.body_units.up != UpAxis::kAuto;
  if (has_body_units && (options.groom.empty() || options.body.empty()))
    throw Error("there is no body file", "unit or up axis of the body (--body-unit-meters, --body-up)",
                "leave it out, or name groom and body files (--groom, --body)");
  const bool has_clip = isBvh(options.motion) || (options.skinned && isBvh(options.skinned->clip));
  if (options.clip_unit_meters > 0 && !has_clip)
    throw Error("there is no .bvh clip", "unit of clips (--clip-unit-meters)",
                "leave it out, or name a clip (--body-clip, --motion)");
}

void checkNamesAndJoints(const SceneOptions& options) {
  checkNames(options.primitives, options.body_name);
  if (!options.body_name.empty() && !options.groom.empty() && options.body.empty())
    throw Error("no body is given for the name '" + options.body_name + "'", "name of [body]",
                "give it a file, or leave its name out");
  for (const ScenePrimitive& primitive : options.primitives)
    if (!primitive.joint.empty() && !options.skinned)
      throw Error("the body is not skinned, so it has no joint '" + primitive.joint + "'", primitive.where,
                  "give [body] a glTF file with a skin and a clip, or the joint that hair grows on; or leave "
                  "joint out");
}

void checkSkinned(const SceneOptions& options) {
  if (!options.skinned) return;
  if (options.groom.empty() || options.body.empty())
    throw Error("no body file is given", "clip, joint, roots or targets of the body",
                "name groom and body files (--groom, --body)");
  if (options.body_contact == BodyContact::kSpheres)
    throw Error("a skinned body cannot collide as spheres", options.body.string(),
                "use --body-contact field");
}

MeshBodyOptions meshBodyOptions(const SceneOptions& options, const Scene& scene) {
  MeshBodyOptions out;
  if (options.groom.empty())  // procedural scenes are in metres, with Y up
    out.obj_units = {options.units.unit_meters > 0 ? options.units.unit_meters : 1,
                     options.units.up == UpAxis::kAuto ? UpAxis::kY : options.units.up};
  else
    out.obj_units = {scene.groom.report.unit_meters, options.units.up};
  out.field = fieldOptions(options, scene);
  out.cache = options.field_cache;
  return out;
}

void addPrimitives(const SceneOptions& options, const Progress& progress, Scene& scene) {
  constexpr double kFrom = 0.97, kTo = 1;  // range of the scene's progress
  scene.mesh_bodies = meshBodyOptions(options, scene);
  PrimitiveBodies made = primitiveBodies(
      options.primitives, scene.mesh_bodies, scene.body,
      [&](const std::string& what, double part) {
        return !progress || progress(what, kFrom + part * (kTo - kFrom));
      },
      options.bake_begins);
  for (PrimitiveBody& made_body : made.bodies) {
    const BodyId id = scene.bodies.size();
    if (!made_body.joint.empty()) scene.skinned->attachToJoint(id, made_body.joint);
    if (!made_body.name.empty()) scene.named_bodies[made_body.name] = id;
    scene.bodies.push_back(std::move(made_body.body));
    if (made_body.mesh_hash == 0) continue;
    uint64_t& known = scene.mesh_hashes[made_body.name];
    ContentHash both;
    both.add(known);
    both.add(made_body.mesh_hash);
    known = both.value();
  }
  for (std::string& line : made.notes) scene.notes.push_back(std::move(line));
  for (std::string& line : made.warnings) scene.warnings.push_back(std::move(line));
}

}  // namespace

Scene makeScene(const SceneOptions& options, const Progress& progress) {
  checkNamesAndJoints(options);
  checkSkinned(options);
  checkHair(options);
  checkUnits(options);
  Scene scene =
      options.groom.empty() ? makeProceduralScene(options, progress) : makeFileScene(options, progress);
  scene.pins = options.pins;
  if (scene.groom.strands.strands() == 0)
    throw Error("the groom has no strand to simulate", scene.name, "see `strandcast info FILE`");
  for (RigidBody& body : scene.bodies)
    for (ContactPrimitive& shape : body.primitives) shape.friction = options.body_friction;
  scene.body_name = options.body_name;
  if (!scene.body_name.empty()) scene.named_parts = scene.bodies.size();
  addPrimitives(options, progress, scene);
  report(progress, "ready", 1);
  return scene;
}

}  // namespace strandcast
