#include "tests/io/reader_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "core/error.h"
#include "core/strand_model.h"
#include "groom/groom_operations.h"
#include "io/axes_and_units.h"
#include "io/distance_field_file.h"
#include "io/file_bytes.h"
#include "io/groom_file.h"
#include "io/mesh_file.h"
#include "io/skinned_mesh.h"

namespace strandcast {
namespace {

const std::string kName = "damaged.file";

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "a reader broke its word: %s\n", what);
  std::abort();
}

/// Runs `read`; returns whether it accepted the bytes.
template <class Read>
bool accepts(Read read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    const std::string_view message = error.what();
    require(message.find(kName) != std::string_view::npos, "an error does not name the file");
    require(message.find('\n') == std::string_view::npos, "an error has more than one line");
    return false;
  }
}

void checkStrandSet(const StrandSet& strands, size_t file_bytes) {
  require(strands.strands() > 0 && strands.offsets.front() == 0, "no strands");
  require(strands.offsets.back() == strands.vertices(), "the last offset is not the number of vertices");
  for (size_t s = 0; s < strands.strands(); ++s)
    require(strands.offsets[s] < strands.offsets[s + 1], "a strand without vertices");
  for (const Vec3& point : strands.positions) require(point.allFinite(), "a position is not finite");
  require(strands.pinned.empty() || strands.pinned.size() == strands.vertices(), "pins are not per vertex");
  require(strands.radii.empty() || strands.radii.size() == strands.vertices(), "radii are not per vertex");
  require(strands.uvs.empty() || strands.uvs.size() == strands.strands(), "UVs are not per strand");
  const auto fits = [&](const auto& values) { return values.empty() || values.size() == strands.strands(); };
  require(fits(strands.ids) && fits(strands.is_guide) && fits(strands.groups) && fits(strands.colours),
          "labels are not per strand");
  for (const Vec3& colour : strands.colours)
    require(colour.allFinite() && colour.minCoeff() >= 0, "a colour is negative or not finite");
  require(strands.vertices() <= file_bytes, "more vertices than the file has bytes");
}

/// Runs all stages that follow the reading of a groom. The solver's model must accept the cleaned strands.
void checkDownstream(const StrandSet& strands) {
  Groom groom;
  groom.strands = strands;
  Box bounds;
  for (const Vec3& point : groom.strands.positions) bounds.extend(Eigen::Vector3f(point));
  rotateToYUp(groom.strands.positions, UpAxis::kZ);
  scaleToMeters(groom.strands.positions, guessUnit(bounds), kName);
  cleanStrands(groom);
  require(groom.report.dropped_short + groom.strands.strands() == groom.report.strands_read,
          "strands got lost");
  if (groom.strands.strands() == 0) return;
  checkStrandSet(groom.strands, strands.vertices());
  require(makeStrandModel(groom.strands).strands() == groom.strands.strands(), "the model lost strands");
  orientRoots(groom, [](const Vec3& p) {
    return SurfacePoint{Vec3(p.x(), 0, p.z()), 0, Vec3(1, 0, 0), std::abs(p.y())};
  });
  const StrandSet even = resample(groom.strands, 5);
  require(even.vertices() == 5 * even.strands(), "resampling gave another count");
  const size_t count = std::min<size_t>(even.strands(), 3);
  require(subset(even, chooseGuides(even, count)).strands() == count,
          "another number of guides than asked for");
}

/// Reports must fit lines of a log, whatever names a file contains.
void checkReport(const FileReport& report) {
  for (const std::vector<std::string>* lines : {&report.left_out, &report.warnings}) {
    require(lines->size() < 64, "a report has too many lines");
    for (const std::string& line : *lines)
      require(!line.empty() && line.size() < 4096 &&
                  std::none_of(line.begin(), line.end(), [](char c) { return c >= 0 && c < ' '; }),
              "a report's line is empty, long or has control characters");
  }
}

void checkRawGroom(const RawGroom& raw, size_t file_bytes) {
  checkStrandSet(raw.strands, file_bytes);
  checkReport(raw.report);
  const RawGroom again = readHair(encodeHair(raw.strands, kName), kName);
  require(again.strands.positions == raw.strands.positions && again.strands.offsets == raw.strands.offsets,
          "writing and reading again gave other strands");
  checkDownstream(raw.strands);
}

/// A groom's labels are the same after writing and reading.
void checkLabels(const RawGroom& raw) {
  std::vector<size_t> counts(raw.groups.size());
  for (const uint32_t group : raw.strands.groups) {
    require(group < raw.groups.size(), "a group is not in the table");
    ++counts[group];
  }
  for (const size_t count : counts) require(count > 0, "a group has no strands");
  StrandSet strands = raw.strands;
  strands.radii.clear();  // widths beyond a float would cost curves
  const RawGroom again = readUsda(encodeUsda(strands, 1, kName, raw.groups), kName);
  require(again.strands.positions == strands.positions && again.strands.ids == strands.ids &&
              again.strands.is_guide == strands.is_guide && again.strands.groups == strands.groups &&
              again.strands.colours == strands.colours,
          "writing and reading again gave other strands");
  for (size_t g = 0; g < raw.groups.size(); ++g)
    require(again.groups[g].id == raw.groups[g].id && again.groups[g].name == raw.groups[g].name,
            "writing and reading again gave other groups");
}

void checkMesh(const TriangleMesh& mesh) {
  require(!mesh.triangles.empty(), "a mesh without triangles");
  require(mesh.normals.size() == mesh.positions.size(), "normals are not per vertex");
  for (const Vec3& point : mesh.positions) require(point.allFinite(), "a position is not finite");
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle)
      require(corner < mesh.positions.size(), "an index is out of range");
}

/// Limits within the time and memory of the checks of damaged files.
GltfLimits fewOfAll() {
  GltfLimits limits;
  limits.primitives = limits.vertices = limits.triangles = limits.instances = 20'000;
  limits.target_vertices = limits.clip_values = 100'000;
  limits.accessor_bytes = 1'000'000;
  return limits;
}

/// Targets refer to existing vertices, and all weights of clips are finite.
void checkTargets(const SkinnedMesh& skin) {
  for (const MorphTarget& target : skin.targets)
    for (const MorphTarget::Move& move : target.moves)
      require(move.vertex < skin.stored.size() && move.by.allFinite(), "a target moves what is not there");
  for (const SkinnedMesh::TargetBinding& pair : skin.target_bindings)
    require(pair.target < skin.targets.size() && pair.binding < skin.bindings.size(),
            "a target is bound to none");
  for (const SkeletonClip& clip : skin.clips) {
    std::vector<float> weights = skin.restWeights();
    for (const MorphChannel& channel : clip.morphs) {
      require(channel.target < weights.size(), "a channel has no target");
      require(clip.samplers.at(channel.sampler).components == 1, "a weight has more than one component");
    }
    for (const double part : {-1.0, 0.0, 0.3, 1.0, 2.0}) {
      clip.weigh(part * clip.duration, weights);
      for (const float weight : weights) require(std::isfinite(weight), "a weight is not finite");
    }
    const std::vector<Placement> rest = skin.skeleton.worldTransforms(skin.skeleton.rest());
    require(skin.blended(rest, weights).size() == skin.stored.size(), "targets lost vertices");
    require(skin.bindingsAt(rest, weights).size() == skin.bindings.size() + skin.target_bindings.size(),
            "targets have no bindings");
  }
}

/// An accepted skin can be posed at any time of any clip.
void checkSkin(const SkinnedMesh& skin) {
  checkMesh(skin.mesh);
  checkReport(skin.report);
  checkTargets(skin);
  const size_t vertices = skin.mesh.positions.size();
  require(skin.stored.size() == vertices && skin.influences.size() == vertices, "a skin is not per vertex");
  for (const SkinInfluences& influences : skin.influences) {
    float sum = 0;
    for (const auto& [binding, weight] : influences) {
      require(binding < skin.bindings.size() && weight >= 0, "an influence is out of range");
      sum += weight;
    }
    require(std::abs(sum - 1) < 1e-4f, "weights do not add up to 1");
  }
  for (const SkinBinding& binding : skin.bindings)
    require(binding.joint < skin.skeleton.joints.size(), "a binding has no joint");
  for (size_t j = 0; j < skin.skeleton.joints.size(); ++j)
    require(skin.skeleton.joints[j].parent < static_cast<int>(j), "a joint comes before its parent");
  size_t values = 0;
  for (const SkeletonClip& clip : skin.clips) {
    std::vector<JointTransform> locals = skin.skeleton.rest();
    for (const double part : {-1.0, 0.0, 0.3, 0.7, 1.0, 2.0}) {
      clip.pose(part * clip.duration, locals);
      for (const JointTransform& local : locals)
        require(
            local.translation.allFinite() && local.rotation.coeffs().allFinite() && local.scale.allFinite(),
            "a clip's pose is not finite");
    }
    for (const ClipSampler& sampler : clip.samplers) values += sampler.values.size();
    require(skin.blended(skin.skeleton.worldTransforms(locals)).size() == vertices, "a pose lost vertices");
  }
  require(values <= fewOfAll().clip_values, "more values than the limit");
}

/// An accepted field can be sampled anywhere, and is written back bit for bit.
void checkField(const StoredField& stored, std::span<const std::byte> bytes) {
  const DistanceField& field = stored.field;
  require(field.bytes() <= bytes.size(), "more memory than the file has bytes");
  const auto at = [&](uint32_t n, int axis) {
    const auto along = static_cast<float>(n) / 12;
    return field.grid.origin[axis] + (1.5f * along - 0.25f) * field.grid.cell *
                                         static_cast<float>(kBrickCells * field.grid.bricks[axis]);
  };
  for (uint32_t n = 0; n < 13 * 13 * 13; ++n) {
    const FieldSample sample = field.at({at(n % 13, 0), at(n / 13 % 13, 1), at(n / 169, 2)});
    require(std::isfinite(sample.distance) && sample.gradient.allFinite(), "a sample is not finite");
  }
  const std::vector<std::byte> again = encodeDistanceField(field, stored.key);
  require(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()), "another file was written");
}

}  // namespace

bool checkTfxReader(std::span<const std::byte> bytes) {
  return accepts([&] { checkRawGroom(readTfx(bytes, kName), bytes.size()); });
}

bool checkHairReader(std::span<const std::byte> bytes) {
  return accepts([&] { checkRawGroom(readHair(bytes, kName), bytes.size()); });
}

bool checkObjStrandsReader(std::span<const std::byte> bytes) {
  return accepts([&] { checkRawGroom(readObjStrands(bytes, kName), bytes.size()); });
}

bool checkUsdaReader(std::span<const std::byte> bytes) {
  return accepts([&] {
    const RawGroom groom = readUsda(bytes, kName);
    require(groom.unit_meters > 0 && std::isfinite(groom.unit_meters), "the unit is no length");
    for (const float radius : groom.strands.radii)
      require(radius >= 0 && std::isfinite(radius), "a radius is negative or not finite");
    for (const Vec2& uv : groom.strands.uvs) require(uv.allFinite(), "a UV is not finite");
    checkRawGroom(groom, bytes.size());
    checkLabels(groom);
  });
}

bool checkObjMeshReader(std::span<const std::byte> bytes) {
  return accepts([&] {
    const ReadMesh read = readObjMesh(bytes, kName, {"helper-"});
    checkMesh(read.mesh);
    checkReport(read.report);
  });
}

bool checkGltfReader(std::span<const std::byte> bytes) {
  return accepts([&] {
    const ReadMesh read = readGltfMesh(bytes, kName, fewOfAll());
    checkMesh(read.mesh);
    checkReport(read.report);
    require(read.mesh.positions.size() <= fewOfAll().vertices, "more vertices than the limit");
  });
}

bool checkGltfSkinReader(std::span<const std::byte> bytes) {
  return accepts([&] { checkSkin(readGltfSkin(bytes, kName, fewOfAll())); });
}

bool checkSdfReader(std::span<const std::byte> bytes) {
  // Checks behind the hash must hold as well: an attacker can compute a matching hash.
  std::vector<std::byte> stamped(bytes.begin(), bytes.end());
  stampDistanceField(stamped);
  return accepts([&] { checkField(readDistanceField(stamped, kName), stamped); });
}

void writeFuzzSeeds(int argc, char** argv, const std::vector<std::vector<std::byte>>& seeds) {
  for (int a = 1; a < argc; ++a) {
    const std::filesystem::path folder = argv[a];
    if (argv[a][0] == '-' || !std::filesystem::is_directory(folder)) continue;
    for (size_t s = 0; s < seeds.size(); ++s) writeFileBytes(folder / ("seed" + std::to_string(s)), seeds[s]);
    return;
  }
}

}  // namespace strandcast
