#include "core/strand_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geometry.h"
#include "core/hash.h"
#include "core/rod_elasticity.h"
#include "kernels/scalar_strands.h"

namespace strandcast {
namespace {

void checkStrand(std::span<const Vec3> points, size_t strand) {
  const std::string where = fmt::format("strand {}", strand);
  if (points.size() < kMinVerticesPerStrand || points.size() > kMaxVerticesPerStrand)
    throw Error(fmt::format("a strand has {} vertices, the solver takes {} to {}", points.size(),
                            kMinVerticesPerStrand, kMaxVerticesPerStrand),
                where, "resample the groom (--vertices)");
  for (size_t i = 0; i < points.size(); ++i) {
    if (!(points[i].cwiseAbs().maxCoeff() <= kFarthestPose))
      throw Error("a vertex is farther from the origin than 10 km", where, "give the groom in metres");
    if (i > 0 && !((points[i] - points[i - 1]).norm() > 0))
      throw Error("two neighbouring vertices coincide", where, "clean the groom");
  }
}

/// Sets twist-free (Bishop 1975) material frames along the rest shape, relative to the root frame. Returns
/// the root frame, whose z axis is the strand's tangent at the root itself: half a joint before the middle of
/// the first edge.
Eigen::Quaterniond restFrames(std::span<const Vec3> points, std::span<Quat> frames) {
  const size_t edges = points.size() - 1;
  std::vector<Eigen::Quaterniond> world(edges);
  Eigen::Vector3d before = Eigen::Vector3d::UnitZ();
  for (size_t e = 0; e < edges; ++e) {
    const Eigen::Vector3d tangent = (points[e + 1] - points[e]).cast<double>().normalized();
    world[e] =
        shortestRotation<double>(before, tangent) * (e > 0 ? world[e - 1] : Eigen::Quaterniond::Identity());
    world[e].normalize();
    before = tangent;
  }
  Eigen::Quaterniond root = world[0];
  if (edges > 1) {
    Eigen::Quaterniond half = world[0].conjugate() * world[1];
    if (half.w() < 0) half.coeffs() *= -1;
    half.w() += 1;
    root = (world[0] * half.normalized().conjugate()).normalized();
  }
  for (size_t e = 0; e < edges; ++e)
    frames[e] = Quat((root.conjugate() * world[e]).normalized().cast<float>());
  return root;
}

/// Sets mass, stiffness and rest strain of strand s. A rod with a clamped root frame converges with second
/// order if the first joint gets half a cell (Romero, Neukirch, Bertails-Descoubes 2021).
void setRod(StrandModel& model, size_t s, const Material& material) {
  const uint32_t first = model.offsets[s];
  const size_t edges = model.verticesOf(s) - 1;
  std::vector<double> length(edges);
  double total = 0;
  for (size_t e = 0; e < edges; ++e) {
    length[e] = (model.rest_local[first + e + 1] - model.rest_local[first + e]).cast<double>().norm();
    total += length[e];
  }
  const RodSections sections(material, total);
  double mass = 0, along = 0;
  std::vector<double> vertex_mass(edges + 1);
  for (size_t i = 0; i <= edges; ++i) {
    const double before = i > 0 ? 0.5 * length[i - 1] : 0, behind = i < edges ? 0.5 * length[i] : 0;
    vertex_mass[i] = sections.mass(along - before, along + behind);
    mass += vertex_mass[i];
    if (i < edges) along += length[i];
  }
  const double reference = mass / static_cast<double>(edges);
  model.reference_mass[s] = static_cast<float>(reference);
  along = 0;
  Eigen::Quaterniond inner = Eigen::Quaterniond::Identity();
  for (size_t j = 0; j <= edges; ++j) {
    const uint32_t v = first + static_cast<uint32_t>(j);
    model.mass[v] = static_cast<float>(vertex_mass[j] / reference);
    if (j == edges) break;
    const double before = j > 0 ? 0.5 * length[j - 1] : 0, behind = 0.5 * length[j];
    const double cell = before + behind;
    const double bending = sections.bendingStiffness(along - before, along + behind);
    const Eigen::Quaterniond outer(model.rest_frames[v].cast<double>());
    // Strain is 2 tan(theta / 2). This scale makes the stiffness of that law at the rest angle equal to the
    // rod's, up to the fold at which the law is clamped.
    const double cosine = cappedCosine(inner, outer);
    const double scale = cosine * cosine / (cell * reference);
    model.rest_strain[v] = strainOfJoint(inner, outer).cast<float>();
    model.bend[v] = static_cast<float>(bending * scale);
    model.twist[v] = static_cast<float>(bending / (1 + material.poisson_ratio) * scale);
    inner = outer;
    along += length[j];
  }
}

void setGrooming(StrandModel& model, size_t s, const Material& material) {
  const uint32_t first = model.offsets[s], end = model.offsets[s + 1];
  const float total = arcLength({model.rest_local.data() + first, end - first});
  float along = 0;
  for (uint32_t v = first; v < end; ++v) {
    if (v > first) along += (model.rest_local[v] - model.rest_local[v - 1]).norm();
    model.air_drag_scale[v] = material.air_drag_scale.at(along / total);
    model.goal_scale[v] = material.goal_scale.at(along / total);
    model.tether[v] = material.tether > 0 ? material.tether * along : kNoTether;
    if (model.damping_along.empty()) continue;
    model.damping_along[v] = material.damping_curve.at(along / total);
    model.friction_along[v] = material.friction_curve.at(along / total);
  }
  model.damping_scale[s] = material.damping_scale;
  model.friction_scale[s] = material.friction_scale;
}

void pin(StrandModel& model, uint32_t vertex) {
  model.pinned.resize(model.vertices(), 0);
  model.pinned[vertex] = 1;
}

bool changes(const RootTipCurve& curve) {
  return std::any_of(curve.knots.begin(), curve.knots.end(), [](const auto& k) { return k.second != 1; });
}
bool isCurved(const Material& material) {
  return changes(material.damping_curve) || changes(material.friction_curve);
}
bool isGrooming(const Material& material) {
  return isCurved(material) || changes(material.air_drag_scale) || changes(material.goal_scale) ||
         material.damping_scale != 1 || material.friction_scale != 1 || material.tether > 0;
}

}  // namespace

float evenTolerance(const StrandModel& model, size_t strand) {
  constexpr float kPlace = 0x1p-22f;  // of a coordinate: rounding of an edge's two ends
  const size_t vertices = model.verticesOf(strand);
  const float length = arcLength({model.rest_local.data() + model.offsets[strand], vertices});
  const float far = model.rest_roots[strand].position.norm() + length;
  return std::max(2e-5f, kPlace * far * static_cast<float>(vertices - 1) / length);
}

bool hangsBetweenPins(const StrandModel& model, size_t strand) {
  bool seen_free = false;
  for (uint32_t v = model.offsets[strand]; v < model.offsets[strand + 1]; ++v) {
    if (seen_free && model.isPinned(strand, v)) return true;
    seen_free = seen_free || !model.isPinned(strand, v);
  }
  return false;
}

RestBends restBends(const StrandModel& model, size_t strand) {
  const uint32_t root = model.offsets[strand], joints_end = model.offsets[strand + 1] - 1;
  float bends = 0, changes = 0, second_changes = 0;
  Vec3 before = Vec3::Zero(), change_before = Vec3::Zero();
  for (uint32_t joint = root + 1; joint < joints_end; ++joint) {
    const Vec3 strain = model.rest_strain[joint], change = strain - before;
    bends += strain.squaredNorm();
    if (joint > root + 1) changes += change.squaredNorm();
    if (joint > root + 2) second_changes += (change - change_before).squaredNorm();
    before = strain;
    change_before = change;
  }
  const float joints = static_cast<float>(joints_end - root) - 1;
  return {kernels::f32::bendsUnevenly(bends, changes, second_changes, joints),
          kernels::f32::isSharp(bends, joints)};
}

bool StrandModel::hasFactors(size_t strand) const {
  if (damping_scale.empty()) return false;
  const auto changes = [](float factor) { return factor != 1; };
  if (changes(damping_scale[strand]) || changes(friction_scale[strand])) return true;
  const std::vector<float>* along[] = {&air_drag_scale, &goal_scale, &damping_along, &friction_along};
  return std::any_of(std::begin(along), std::end(along), [&](const std::vector<float>* factors) {
    return !factors->empty() &&
           std::any_of(factors->begin() + static_cast<ptrdiff_t>(offsets[strand]),
                       factors->begin() + static_cast<ptrdiff_t>(offsets[strand + 1]), changes);
  });
}

StrandModel makeStrandModel(const StrandSet& rest, const std::vector<Material>& materials) {
  checkStrandSet(rest, "makeStrandModel");
  if (materials.empty()) throw Error("no material is given", "makeStrandModel", "give at least one");
  for (const Material& material : materials) checkMaterial(material, "material");
  StrandModel model;
  model.offsets = rest.offsets;
  model.rest_local.resize(rest.vertices());
  model.rest_roots.resize(rest.strands());
  model.rest_frames.assign(rest.vertices(), Quat::Identity());
  model.rest_strain.assign(rest.vertices(), Vec3::Zero());
  model.bend.assign(rest.vertices(), 0.0f);
  model.twist.assign(rest.vertices(), 0.0f);
  model.mass.assign(rest.vertices(), 0.0f);
  model.rest_tension.assign(rest.vertices(), 0.0f);
  model.reference_mass.resize(rest.strands());
  const bool groomed = std::any_of(materials.begin(), materials.end(), isGrooming);
  if (groomed) {
    model.air_drag_scale.resize(rest.vertices());
    model.goal_scale.resize(rest.vertices());
    model.damping_scale.resize(rest.strands());
    model.friction_scale.resize(rest.strands());
    model.tether.resize(rest.vertices());
  }
  if (std::any_of(materials.begin(), materials.end(), isCurved)) {
    model.damping_along.resize(rest.vertices());
    model.friction_along.resize(rest.vertices());
  }
  for (size_t s = 0; s < rest.strands(); ++s) {
    const std::span<const Vec3> points = rest.strand(s);
    checkStrand(points, s);
    const uint32_t first = rest.offsets[s];
    const Eigen::Quaterniond root = restFrames(points, {model.rest_frames.data() + first, points.size()});
    model.rest_roots[s] = {points[0], Quat(root.cast<float>())};
    for (uint32_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d from_root = points[i].cast<double>() - points[0].cast<double>();
      model.rest_local[first + i] = Vec3((root.conjugate() * from_root).cast<float>());
      if (i > 0 && rest.isPinned(s, i)) pin(model, first + i);
    }
    const size_t part = rest.parts.empty() ? 0 : rest.parts[s];
    const Material& material = materials[std::min(part, materials.size() - 1)];
    setRod(model, s, material);
    if (groomed) setGrooming(model, s, material);
  }
  return model;
}

void checkModel(const StrandModel& model, const std::string& where) {
  const size_t vertices = model.vertices(), strands = model.offsets.empty() ? 0 : model.strands();
  const std::vector<uint32_t>& offsets = model.offsets;
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != vertices)
    throw Error("the model's offsets do not fit rest_local", where, "make it with makeStrandModel()");
  for (size_t s = 0; s < strands; ++s)
    if (offsets[s + 1] < offsets[s] + kMinVerticesPerStrand ||
        offsets[s + 1] > offsets[s] + kMaxVerticesPerStrand)
      throw Error(fmt::format("a strand does not have {} to {} vertices", kMinVerticesPerStrand,
                              kMaxVerticesPerStrand),
                  fmt::format("{}, strand {}", where, s), "make the model with makeStrandModel()");
  const auto check = [&](const char* name, const auto& values, size_t count, bool may_be_empty, auto sound,
                         const char* advice = "make it with makeStrandModel()") {
    if (!(may_be_empty && values.empty()) && values.size() != count)
      throw Error(fmt::format("the model's {} has {} entries, not {}", name, values.size(), count), where,
                  "make it with makeStrandModel()");
    if (!std::all_of(values.begin(), values.end(), sound))
      throw Error(fmt::format("the model's {} has a number that is not finite or out of range", name), where,
                  advice);
  };
  const auto is_vector = [](const Vec3& v) { return v.allFinite(); };
  const auto is_rotation = [](const Quat& q) { return std::fabs(q.norm() - 1) < kUnitTolerance; };
  const auto is_factor = [](float f) { return f >= 0 && std::isfinite(f); };
  const auto is_stiffness = [](float f) { return f >= 0 && f <= kStiffestJoint; };
  const char* softer =
      "give softer or thinner hair, longer edges, or the right unit of the groom's files (--unit-meters)";
  const auto is_mass = [](float m) { return m > 0 && std::isfinite(m); };
  const auto is_number = [](float f) { return std::isfinite(f); };
  const auto any = [](const auto&) { return true; };
  const auto is_bone = [&](uint16_t bone) { return bone < model.bones.size(); };
  check("rest_local", model.rest_local, vertices, false, is_vector);
  check("rest_roots", model.rest_roots, strands, false,
        [&](const Pose& p) { return is_vector(p.position) && is_rotation(p.rotation); });
  check("rest_frames", model.rest_frames, vertices, false, is_rotation);
  check("rest_strain", model.rest_strain, vertices, false, is_vector);
  check("bend", model.bend, vertices, false, is_stiffness, softer);
  check("twist", model.twist, vertices, false, is_stiffness, softer);
  check("mass", model.mass, vertices, false, is_mass);
  check("rest_tension", model.rest_tension, vertices, false, is_number);
  check("reference_mass", model.reference_mass, strands, false, is_mass);
  check("pinned", model.pinned, vertices, true, any);
  check("air_drag_scale", model.air_drag_scale, vertices, true, is_factor);
  check("goal_scale", model.goal_scale, vertices, true, is_factor);
  check("damping_scale", model.damping_scale, strands, true, is_factor);
  check("friction_scale", model.friction_scale, strands, true, is_factor);
  check("tether", model.tether, vertices, true, is_factor);
  const int given = !model.air_drag_scale.empty() + !model.goal_scale.empty() + !model.damping_scale.empty() +
                    !model.friction_scale.empty() + !model.tether.empty();
  if (given % 5 != 0)
    throw Error(
        "the model has some, but not all, of air_drag_scale, goal_scale, damping_scale, friction_scale, "
        "tether",
        where, "give all of them or none");
  check("damping_along", model.damping_along, vertices, true, is_factor);
  check("friction_along", model.friction_along, vertices, true, is_factor);
  if (model.damping_along.empty() != model.friction_along.empty() ||
      (given == 0 && !model.damping_along.empty()))
    throw Error("the model has damping_along or friction_along without the other or without damping_scale",
                where, "give both, and all of the grooming's, or neither");
  check("rest_distance", model.rest_distance, vertices, true, is_number);
  if (model.bones.empty()) throw Error("the model has no bone", where, "the head is its first");
  check("root_bones", model.root_bones, strands, true, is_bone);
  check("pin_bones", model.pin_bones, vertices, true, is_bone);
}

uint16_t addBone(StrandModel& model, const std::string& bone) {
  const auto known = std::find(model.bones.begin(), model.bones.end(), bone);
  const size_t index = static_cast<size_t>(known - model.bones.begin());
  if (index > UINT16_MAX)
    throw Error("the model has too many bones", fmt::format("bone '{}'", bone), "use 65,535 at most");
  if (known == model.bones.end()) model.bones.push_back(bone);
  return static_cast<uint16_t>(index);
}

void pinToBone(StrandModel& model, size_t strand, float from, float to, uint16_t bone) {
  const std::string name = bone < model.bones.size() ? model.bones[bone] : std::to_string(bone);
  const std::string where = fmt::format("bone '{}', strand {}", name, strand);
  if (bone >= model.bones.size())
    throw Error("unknown bone", where, fmt::format("the model has {}", model.bones.size()));
  if (strand >= model.strands())
    throw Error("unknown strand", where, fmt::format("the model has {}", model.strands()));
  if (!(from >= 0 && from <= to && to <= 1))
    throw Error(fmt::format("{:g} to {:g} is not a part of a strand", from, to), where,
                "give 0 (root) to 1 (tip), in order");

  constexpr float kRounding = 1e-4f;  // of the strand's length, so that a limit at a vertex includes it
  const uint32_t first = model.offsets[strand], end = model.offsets[strand + 1];
  const float total = arcLength({model.rest_local.data() + first, end - first});
  std::vector<uint32_t> pinned;
  float along = 0;
  for (uint32_t v = first; v < end; ++v) {
    if (v > first) along += (model.rest_local[v] - model.rest_local[v - 1]).norm() / total;
    if (along >= from - kRounding && along <= to + kRounding) pinned.push_back(v);
  }
  if (pinned.empty())
    throw Error(fmt::format("no vertex lies from {:g} to {:g} of a strand", from, to), where,
                "give a wider range");
  model.root_bones.resize(model.strands(), 0);
  if (model.pin_bones.empty()) {
    model.pin_bones.reserve(model.vertices());
    for (size_t s = 0; s < model.strands(); ++s)
      model.pin_bones.resize(model.offsets[s + 1], model.root_bones[s]);
  }
  for (const uint32_t v : pinned) {
    pin(model, v);
    model.pin_bones[v] = bone;
  }
  if (pinned.front() == first) model.root_bones[strand] = bone;
}

void pinToBone(StrandModel& model, size_t strand, float from, float to, const std::string& bone) {
  const size_t bones = model.bones.size();
  const uint16_t index = addBone(model, bone);
  try {
    pinToBone(model, strand, from, to, index);
  } catch (const Error&) {
    model.bones.resize(bones);
    throw;
  }
}

Box restBox(const StrandModel& model) {
  Box box;
  for (size_t s = 0; s < model.strands(); ++s)
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v)
      box.extend(Eigen::Vector3f(model.restPosition(s, v)));
  return box;
}

std::vector<float> strandLengths(const StrandModel& model) {
  std::vector<float> lengths;
  lengths.reserve(model.strands());
  for (size_t s = 0; s < model.strands(); ++s)
    lengths.push_back(arcLength({model.rest_local.data() + model.offsets[s], model.verticesOf(s)}));
  return lengths;
}

StrandState restState(const StrandModel& model, const std::vector<Pose>& roots) {
  if (roots.size() != model.strands())
    throw Error(fmt::format("{} roots are given for {} strands", roots.size(), model.strands()), "restState",
                "give one per strand");
  StrandState state;
  state.positions.resize(model.vertices());
  state.frames.resize(model.vertices());
  state.velocities.assign(model.vertices(), Vec3::Zero());
  state.tensions = model.rest_tension;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      state.positions[v] = roots[s].apply(model.rest_local[v]);
      state.frames[v] = roots[s].rotation * model.rest_frames[v];
    }
  }
  return state;
}

uint64_t stateHash(const StrandState& state) {
  ContentHash hash;
  for (const std::vector<Vec3>* plane : {&state.positions, &state.velocities})
    hash.add(plane->data(), plane->size() * sizeof(Vec3));
  return hash.value();
}

}  // namespace strandcast
