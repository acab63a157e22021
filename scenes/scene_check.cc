#include "scenes/scene_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "collision/body_distance.h"
#include "collision/field_bake.h"
#include "core/error.h"
#include "core/quantile.h"
#include "core/strand_model.h"
#include "io/axes_and_units.h"
#include "io/bvh_skeleton.h"

namespace strandcast {
namespace {

constexpr float kMinUsualBody = 0.1f, kMaxUsualBody = 3.0f;  // m, of the longest side
constexpr size_t kSurfaceSamples = 2000, kPlacementSamples = 300, kMaxMarks = 20000;

void reportCheck(const Progress& progress, const std::string& what, double part) {
  if (progress && !progress(what, part)) throw BakeStopped();
}

double percentOf(size_t part, size_t whole) {
  return 100.0 * static_cast<double>(part) / static_cast<double>(std::max<size_t>(whole, 1));
}

CheckSeverity warnIf(bool is_bad) { return is_bad ? CheckSeverity::kWarning : CheckSeverity::kOk; }

/// A row whose remedy is left out where nothing is wrong.
CheckResult rowOf(CheckSeverity severity, const std::string& key, const std::string& what, double number,
                  const std::string& unit, const std::string& where, const std::string& remedy) {
  return {severity, key, what, number, unit, where, severity == CheckSeverity::kOk ? "" : remedy};
}

std::string pointText(const Vec3& p) { return fmt::format("at {:.3f} {:.3f} {:.3f} m", p.x(), p.y(), p.z()); }

std::string strandAt(const Scene& scene, size_t s) {
  const StrandSet& strands = scene.groom.strands;
  return fmt::format("{}, root {}", strandPlace(strands, s, scene.part_names),
                     pointText(strands.strand(s).front()));
}

void mark(CheckReport& out, CheckMark::Kind kind, const Vec3& at) {
  if (out.marks.size() < kMaxMarks) out.marks.push_back({kind, at});
}

// ---- Body ----

/// Edges of three or more triangles.
size_t nonManifoldEdges(const TriangleMesh& mesh) {
  size_t count = 0;
  forEachEdge(SurfacePieces(mesh).edges(), [&](std::span<const EdgeUse> uses) { count += uses.size() > 2; });
  return count;
}

/// Share of the surface, 0 to 1, with inside on both sides.
double hiddenShare(const TriangleMesh& mesh, const MeshQuery& query) {
  const float step = 1e-3f * mesh.bounds().diagonal().norm();
  const std::vector<SurfaceSample> samples = sampleSurface(mesh, kSurfaceSamples);
  const auto hidden = std::count_if(samples.begin(), samples.end(), [&](const SurfaceSample& sample) {
    return !boundsOutside(query, sample.position, step * sample.normal);
  });
  return samples.empty() ? 0 : static_cast<double>(hidden) / static_cast<double>(samples.size());
}

}  // namespace

CheckReport checkBodyMesh(const TriangleMesh& mesh) {
  CheckReport out;
  const Eigen::Vector3f size = mesh.bounds().sizes();
  const float longest = size.maxCoeff();
  out.add(rowOf(isUnlikelySize(longest) ? CheckSeverity::kFault
                                        : warnIf(longest < kMinUsualBody || longest > kMaxUsualBody),
                "body_size",
                fmt::format("body of {} triangles: {:.3g} x {:.3g} x {:.3g} m", mesh.triangles.size(),
                            size.x(), size.y(), size.z()),
                static_cast<double>(longest), "m", "",
                fmt::format("a body is usually {:g} to {:g} m large: give its unit (--body-unit-meters)",
                            kMinUsualBody, kMaxUsualBody)));

  const OrientedSurface oriented = orientSurface(mesh);
  const MeshCheck check = checkMesh(oriented.mesh);
  const MeshQuery query(oriented.mesh);
  const double doubt =
      check.open_edges.empty()
          ? 0
          : 100 * uncertainShare(oriented.mesh, query, 1e-3f * mesh.bounds().diagonal().norm());
  constexpr double kMuchDoubt = 2;  // percent of the surface
  out.add(rowOf(warnIf(doubt > kMuchDoubt), "body_open",
                check.open_edges.empty()
                    ? "body is closed"
                    : fmt::format("body has {} open edges; {:.2g} % of the surface has a doubtful inside",
                                  check.open_edges.size(), doubt),
                static_cast<double>(check.open_edges.size()), "edges",
                check.open_edges.empty() ? "" : pointText(check.open_edges.front().from),
                "close the holes near hair: contact ends at them"));
  const size_t many = nonManifoldEdges(mesh);
  out.add(rowOf(warnIf(many > 0), "body_manifold",
                fmt::format("{} edges of the body belong to three or more triangles", many),
                static_cast<double>(many), "edges", "", "separate or delete the surplus faces"));
  const SurfaceRepair& repair = oriented.repair;
  const std::vector<std::string> lines = repair.lines();
  out.add(rowOf(
      warnIf(repair.changed() || repair.is_inside_out), "body_winding",
      lines.empty() ? (repair.is_inside_out ? "body is inside out" : "faces of the body are wound outward")
                    : fmt::format("body: {}", fmt::join(lines, "; ")),
      static_cast<double>(repair.turned_triangles + repair.repeated + repair.inner), "triangles", "",
      "flip the normals, delete duplicate and inner faces; contact repairs them for itself alone"));
  const double hidden = 100 * hiddenShare(oriented.mesh, query);
  // Percent of the surface. Eyes, teeth and clothes are a part of most bodies.
  constexpr double kMuchHidden = 30;
  out.add(rowOf(warnIf(hidden > kMuchHidden), "body_overlap",
                fmt::format("{:.2g} % of the body's surface lies inside another shell of it", hidden), hidden,
                "%", "", "leave out what is never seen: it makes the bake slower"));
  if (check.without_area > 0)
    out.add(rowOf(CheckSeverity::kOk, "body_flat",
                  fmt::format("{} triangles of the body have no area", check.without_area),
                  static_cast<double>(check.without_area), "triangles", "", ""));
  return out;
}

// ---- Placement ----

namespace {

Box boxOf(const StrandSet& strands) {
  Box box;
  for (const Vec3& p : strands.positions) box.extend(Eigen::Vector3f(p));
  return box;
}

/// Sample of roots and tips, m, Y up.
std::vector<std::pair<Vec3, Vec3>> strandEnds(const StrandSet& strands) {
  std::vector<std::pair<Vec3, Vec3>> ends;
  const size_t every = std::max<size_t>(strands.strands() / kPlacementSamples, 1);
  for (size_t s = 0; s < strands.strands(); s += every)
    ends.emplace_back(strands.strand(s).front(), strands.strand(s).back());
  return ends;
}

/// Mean distance from the body, m, of the nearer end of each strand.
double meanEndDistance(const std::vector<std::pair<Vec3, Vec3>>& ends, const MeshQuery& query) {
  double sum = 0;
  for (const auto& [root, tip] : ends) sum += static_cast<double>(query.distance(tip, query.distance(root)));
  return ends.empty() ? 0 : sum / static_cast<double>(ends.size());
}

/// Points with `from` up in the file, as they are with `to` up. Both are Y up after reading.
Vec3 withOtherUp(Vec3 point, UpAxis from, UpAxis to) {
  const std::span<Vec3> one(&point, 1);
  for (int turn = 0; turn < 3; ++turn) rotateToYUp(one, from);  // three quarter turns undo one
  rotateToYUp(one, to);
  return point;
}

/// A factor and an up axis with which the groom would lie on the body.
struct Fit {
  float factor;
  UpAxis up;
  double distance;  ///< m, mean of the nearer ends
};

/// The best fit of usual units and axes; none that is clearly better than the present one.
std::optional<Fit> betterFit(const Scene& scene, const MeshQuery& query, double present) {
  constexpr double kClearlyNearer = 0.5, kOnBody = 0.05, kOfGroom = 0.2;
  const std::vector<std::pair<Vec3, Vec3>> ends = strandEnds(scene.groom.strands);
  const Box hair = boxOf(scene.groom.strands);
  const auto hair_size = static_cast<double>(hair.diagonal().norm());
  const auto body_size = static_cast<double>(scene.body.bounds().diagonal().norm());
  const GroomReport& report = scene.groom.report;
  std::vector<float> factors{1};
  for (const float unit : usualUnits())
    for (const float other : usualUnits()) factors.push_back(unit / other);
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end(), isSameUnit), factors.end());
  std::optional<Fit> best;
  const UpAxis axes[] = {report.up, UpAxis::kY, UpAxis::kZ, UpAxis::kX};
  for (size_t a = 0; a < std::size(axes); ++a) {
    if (a > 0 && axes[a] == report.up) continue;
    for (const float factor : factors) {
      std::vector<std::pair<Vec3, Vec3>> moved = ends;
      for (auto& [root, tip] : moved) {
        root = factor * withOtherUp(root, report.up, axes[a]);
        tip = factor * withOtherUp(tip, report.up, axes[a]);
      }
      const double distance = meanEndDistance(moved, query);
      // A groom that shrinks to a point may lie near the body by chance: hence the bound by its own size.
      if (distance > kOfGroom * static_cast<double>(factor) * hair_size || distance > kOnBody * body_size)
        continue;
      if (distance < kClearlyNearer * (best ? best->distance : present))
        best = Fit{factor, axes[a], distance};
    }
  }
  return best;
}

const char* axisOption(UpAxis axis) { return axis == UpAxis::kX ? "x" : axis == UpAxis::kZ ? "z" : "y"; }

/// The options that make a fit. A body in .obj takes unit and axis of the groom unless it has its own.
std::string optionsOf(const Fit& fit, const Scene& scene, const SceneOptions& options) {
  constexpr float kMinHair = 0.05f, kMaxHair = 3.0f;  // m, plausible size of a groom
  const Box hair = boxOf(scene.groom.strands);
  const float hair_size = hair.sizes().maxCoeff(), body_size = scene.body.bounds().sizes().maxCoeff();
  const float unit = scene.groom.report.unit_meters;
  const bool has_own = isGltf(options.body) || options.body_units.unit_meters > 0;
  const float body_unit = options.body_units.unit_meters > 0 ? options.body_units.unit_meters
                          : isGltf(options.body)             ? 1
                                                             : unit;
  std::vector<std::string> given;
  if (!isSameUnit(fit.factor, 1)) {
    const bool hair_is_right = hair_size > kMinHair && hair_size < kMaxHair;
    const bool body_is_right = body_size > kMinUsualBody && body_size < kMaxUsualBody;
    if (hair_is_right && !body_is_right) {
      given.push_back(fmt::format("--body-unit-meters {:.4g}", body_unit / fit.factor));
    } else {
      given.push_back(fmt::format("--unit-meters {:.4g}", unit * fit.factor));
      if (!has_own) given.push_back(fmt::format("--body-unit-meters {:.4g}", body_unit));
    }
  }
  if (fit.up != scene.groom.report.up) {
    given.push_back(fmt::format("--up {}", axisOption(fit.up)));
    if (!isGltf(options.body) && options.body_units.up == UpAxis::kAuto)
      given.push_back(fmt::format("--body-up {}", axisOption(options.units.up)));
  }
  return fmt::format("{}", fmt::join(given, " "));
}

}  // namespace

CheckReport checkPlacement(const Scene& scene, const SceneOptions& options, const MeshQuery& query) {
  constexpr double kFar = 0.1;        // share of the body's diagonal
  constexpr double kMaxRatio = 20;    // of the longest sides
  constexpr double kDoubtful = 5e-3;  // m, distance from which on better units and axes are looked for
  // Eyebrows on a figure are far smaller than it, but lie on it: distance as a share of the groom's size.
  constexpr double kOfGroom = 0.2;
  CheckReport out;
  const StrandSet& strands = scene.groom.strands;
  const Box hair = boxOf(scene.groom.strands);
  const Box body = scene.body.bounds();
  const auto hair_size = static_cast<double>(hair.sizes().maxCoeff());
  const auto body_size = static_cast<double>(body.sizes().maxCoeff());
  const double ratio = std::max(hair_size, 1e-9) / std::max(body_size, 1e-9);
  const double off = meanEndDistance(strandEnds(strands), query);
  const bool is_far = off > kFar * static_cast<double>(body.diagonal().norm());
  const bool is_odd = ratio > kMaxRatio || (ratio < 1 / kMaxRatio && off > kOfGroom * hair_size);
  std::optional<Fit> fit;
  if (is_far || is_odd || off > kDoubtful) fit = betterFit(scene, query, off);
  const std::string remedy =
      fit ? fmt::format("{}? Ends of strands would then be {:.1f} mm off the body",
                        optionsOf(*fit, scene, options), 1e3 * fit->distance)
          : "no usual unit or axis brings them together: export groom and body from one scene, at rest";
  out.add(rowOf(is_odd ? CheckSeverity::kFault : CheckSeverity::kOk, "scale",
                ratio >= 1 ? fmt::format("the groom is {:.3g} times as large as the body", ratio)
                           : fmt::format("the body is {:.3g} times as large as the groom", 1 / ratio),
                ratio, "", "", remedy));
  const Eigen::Vector3f between = hair.center() - body.center();
  out.add(rowOf(is_far ? CheckSeverity::kFault : warnIf(fit.has_value()), "placement",
                fmt::format("ends of strands are {:.1f} mm off the body in the mean; the boxes' centres are "
                            "{:.3g} m apart",
                            1e3 * off, between.norm()),
                1e3 * off, "mm", "", remedy));
  return out;
}

// ---- Roots ----

CheckReport checkRoots(const Scene& scene, const MeshQuery& query) {
  constexpr double kMedianFault = 2 * static_cast<double>(kRootOffSkin);  // m
  constexpr double kFewNear = 2, kLostFault = 25;                         // percent of the roots
  CheckReport out;
  const StrandSet& strands = scene.groom.strands;
  std::vector<double> distances;
  size_t loose = 0, off = 0, lost = 0, inside = 0, worst = 0;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const Vec3& root = strands.strand(s).front();
    const float distance = query.distance(root);
    distances.push_back(static_cast<double>(distance));
    loose += distance > kRootNearSkin;
    off += distance > kRootOffSkin;
    lost += distance > kFarthestFromSkin;
    inside += distance > kRootNearSkin && isInside(query, root);
    if (distances[s] > distances[worst]) worst = s;
    if (distance > kRootNearSkin) mark(out, CheckMark::Kind::kRoot, root);
  }
  if (distances.empty()) return out;
  const double median = quantileOf(distances, 0.5), most = quantileOf(distances, 0.95);
  out.add(rowOf(
      median > kMedianFault ? CheckSeverity::kFault
                            : warnIf(percentOf(loose, strands.strands()) > kFewNear || off > 0),
      "roots_off_skin",
      fmt::format("roots are {:.2f} mm off the skin (median; 95 % below {:.2f}, largest {:.1f} mm); {} above "
                  "{:g} mm, {} above {:g} mm; {} of them below the skin",
                  1e3 * median, 1e3 * most, 1e3 * distances[worst], loose,
                  1e3 * static_cast<double>(kRootNearSkin), off, 1e3 * static_cast<double>(kRootOffSkin),
                  inside),
      static_cast<double>(off), "strands", strandAt(scene, worst),
      "snap roots to the skin that the groom was made on, or export that skin as the body"));
  const char* carrier = scene.skinned ? "they follow the joint, not the skin under them"
                                      : "they are held in the air or deep inside the body";
  out.add(rowOf(percentOf(lost, strands.strands()) > kLostFault ? CheckSeverity::kFault : warnIf(lost > 0),
                "roots_without_skin",
                lost > 0 ? fmt::format("{} roots have no skin within {:g} mm: {}", lost,
                                       1e3 * static_cast<double>(kFarthestFromSkin), carrier)
                         : fmt::format("every root has skin within {:g} mm",
                                       1e3 * static_cast<double>(kFarthestFromSkin)),
                static_cast<double>(lost), "strands", lost > 0 ? strandAt(scene, worst) : "",
                "delete these strands, or give the body that they grow on"));
  return out;
}

// ---- Inside ----

namespace {

/// Depth of each vertex below the skin, m; 0 outside.
void depthsOf(std::span<const Vec3> points, const Box& box, const MeshQuery& query,
              std::vector<float>& depths) {
  depths.clear();
  for (const Vec3& p : points)
    depths.push_back(box.contains(Eigen::Vector3f(p)) && isInside(query, p) ? query.distance(p) : 0);
}

}  // namespace

CheckReport checkHairInside(const Scene& scene, const MeshQuery& query, const Progress& progress) {
  constexpr double kManyVertices = 1, kBuriedFault = 50;  // percent
  constexpr double kDeep = 2e-3;                          // m, median above which there is a warning
  CheckReport out;
  const StrandSet& strands = scene.groom.strands;
  const Box box = scene.body.bounds();
  const size_t every = (strands.strands() + kMaxStrandsInside - 1) / kMaxStrandsInside;
  size_t looked = 0, vertices = 0, touched = 0, buried = 0, deepest_strand = 0;
  std::vector<double> inside;
  double deepest = 0;
  std::vector<float> depths;
  for (size_t s = 0; s < strands.strands(); s += std::max<size_t>(every, 1), ++looked) {
    if (looked % 256 == 0)
      reportCheck(progress, "looking for hair inside the body",
                  static_cast<double>(s) / static_cast<double>(strands.strands()));
    const std::span<const Vec3> points = strands.strand(s);
    depthsOf(points, box, query, depths);
    vertices += points.size();
    const size_t before = inside.size();
    // Up to the first vertex outside, a strand may be as deep as its root, which contact allows for.
    const float allowed = std::max(depths[0], kRootNearSkin) + kSkinDepth;
    bool is_out = false;
    for (size_t i = 0; i < points.size(); ++i) {
      is_out |= depths[i] == 0;
      const float tolerated = is_out ? kInsideTolerance : allowed;
      if (i == 0 || depths[i] <= tolerated) continue;
      const auto depth = static_cast<double>(depths[i]);
      inside.push_back(depth);
      mark(out, CheckMark::Kind::kInside, points[i]);
      if (depth > deepest) {
        deepest = depth;
        deepest_strand = s;
      }
    }
    touched += inside.size() > before;
    buried += !is_out;
  }
  const double median = quantileOf(inside, 0.5), share = percentOf(inside.size(), vertices);
  const std::string of = every > 1 ? fmt::format(" (of {} strands looked at)", looked) : "";
  out.add(rowOf(warnIf(share > kManyVertices || median > kDeep), "hair_inside",
                inside.empty()
                    ? "no hair inside the body beyond its root" + of
                    : fmt::format("{} vertices ({:.2g} %) of {} strands{} inside the body beyond their root; "
                                  "median depth {:.2f} mm, largest {:.1f} mm",
                                  inside.size(), share, touched, of, 1e3 * median, 1e3 * deepest),
                static_cast<double>(inside.size()), "vertices",
                inside.empty() ? "" : strandAt(scene, deepest_strand),
                "comb the hair out of the body: it may stay that deep, and is not seen there"));
  out.add(rowOf(percentOf(buried, looked) > kBuriedFault ? CheckSeverity::kFault : warnIf(buried > 0),
                "strands_buried",
                buried > 0 ? fmt::format("{} strands{} never leave the body", buried, of)
                           : "every strand leaves the body" + of,
                static_cast<double>(buried), "strands", "",
                "delete them, or check unit and place of the body: they are simulated and never seen"));
  return out;
}

// ---- Clip ----

namespace {

/// Names of joints, the first few.
std::string namesText(const std::vector<std::string>& names) {
  constexpr size_t kShown = 8;
  const std::vector<std::string> shown(
      names.begin(), names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kShown)));
  return fmt::format("{}{}", fmt::join(shown, ", "), names.size() > kShown ? ", ..." : "");
}

/// Joints that carry skin and that a .bvh clip lacks: those that a joint above carries along, and the others.
void checkJoints(const SkinnedMesh& skin, const std::string& clip, CheckReport& out) {
  const BvhClip bvh = readBvh(std::filesystem::path(clip));
  const BvhMatch match(bvh, skin.skeleton);
  const std::vector<SkeletonJoint>& joints = skin.skeleton.joints;
  std::vector<bool> moves(joints.size());
  for (size_t j = 0; j < joints.size(); ++j)
    moves[j] =
        match.namesakes[j] >= 0 || (joints[j].parent >= 0 && moves[static_cast<size_t>(joints[j].parent)]);
  std::set<uint32_t> carriers;
  for (const SkinBinding& binding : skin.bindings) carriers.insert(binding.joint);
  std::vector<std::string> still, carried;
  for (const uint32_t joint : carriers)
    if (match.namesakes[joint] < 0) (moves[joint] ? carried : still).push_back(joints[joint].name);
  out.add(rowOf(warnIf(!still.empty()), "joints_still",
                still.empty() ? fmt::format("the clip moves all {} joints that carry skin", carriers.size())
                              : fmt::format("{} of {} joints that carry skin are not moved by the clip: {}",
                                            still.size(), carriers.size(), namesText(still)),
                static_cast<double>(still.size()), "joints", "",
                "name the joints of the clip as those of the body"));
  if (!carried.empty())
    out.add(rowOf(CheckSeverity::kOk, "joints_carried",
                  fmt::format("{} joints are not in the clip and follow the joint above: {}", carried.size(),
                              namesText(carried)),
                  static_cast<double>(carried.size()), "joints", "", ""));
}

/// A root on its triangle of the skin.
struct RootOnSkin {
  std::array<uint32_t, 3> corners;
  Vec3 barycentric;
  size_t strand;
};

std::vector<RootOnSkin> rootsOnSkin(const Scene& scene, const MeshQuery& query) {
  std::vector<RootOnSkin> out;
  const StrandSet& strands = scene.groom.strands;
  for (size_t s = 0; s < strands.strands(); ++s) {
    const MeshPoint on = query.closest(strands.strand(s).front());
    if (on.distance <= kFarthestFromSkin)
      out.push_back({scene.body.triangles[on.triangle], on.barycentric, s});
  }
  return out;
}

/// How many roots each joint carries, by the largest weight under them: "head 812, neck 31".
std::string carriersText(const SkinnedMesh& skin, const std::vector<RootOnSkin>& roots) {
  std::map<uint32_t, size_t> counts;
  for (const RootOnSkin& root : roots) {
    std::map<uint32_t, float> weights;
    for (int c = 0; c < 3; ++c)
      for (const auto& [binding, weight] : skin.influences[root.corners[static_cast<size_t>(c)]])
        if (weight > 0) weights[skin.bindings[binding].joint] += weight * root.barycentric[c];
    const auto most = std::max_element(weights.begin(), weights.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != weights.end()) ++counts[most->first];
  }
  std::vector<std::pair<size_t, uint32_t>> order;
  for (const auto& [joint, count] : counts) order.emplace_back(count, joint);
  std::sort(order.rbegin(), order.rend());
  std::vector<std::string> parts;
  for (const auto& [count, joint] : order)
    parts.push_back(fmt::format("{} {}", skin.skeleton.joints[joint].name, count));
  return namesText(parts);
}

/// The largest value over a clip, and where it is.
struct ClipPeak {
  double value = 0, seconds = 0;
  size_t strand = 0;
  void see(double now, double at, size_t of) {
    if (now > value) *this = {now, at, of};
  }
};

/// Stretch of the skin and motion of the roots over the frames of a clip.
class RootTracker {
 public:
  RootTracker(const Scene& scene, const std::vector<RootOnSkin>& roots)
      : roots_(roots), rest_(scene.body.positions), stretches_(roots.size(), 1) {}

  /// The skin at the next frame, `interval` s after the one before.
  void see(const std::vector<Vec3>& skin, double seconds, double interval) {
    std::vector<Vec3> now;
    double largest = 0;
    for (size_t r = 0; r < roots_.size(); ++r) {
      const RootOnSkin& root = roots_[r];
      Vec3 place = Vec3::Zero();
      for (int c = 0; c < 3; ++c) {
        const uint32_t a = root.corners[static_cast<size_t>(c)],
                       b = root.corners[static_cast<size_t>(c + 1) % 3];
        place += root.barycentric[c] * skin[a];
        const float rest = (rest_[b] - rest_[a]).norm();
        if (!(rest > 0)) continue;
        const auto factor = static_cast<double>((skin[b] - skin[a]).norm() / rest);
        stretches_[r] = std::max(stretches_[r], factor);
        stretch_.see(factor, seconds, root.strand);
      }
      now.push_back(place);
      if (before_.empty()) continue;
      const Vec3 step = place - before_[r];
      speed_.see(static_cast<double>(step.norm()) / interval, seconds, root.strand);
      if (!steps_.empty()) {
        const auto change = static_cast<double>((step - steps_[r]).norm());
        largest = std::max(largest, change);
        jump_.see(change, seconds, root.strand);
      }
    }
    if (!steps_.empty()) changes_.push_back(largest);
    if (!before_.empty()) {
      steps_.resize(now.size());
      for (size_t r = 0; r < now.size(); ++r) steps_[r] = now[r] - before_[r];
    }
    before_ = std::move(now);
  }

  const ClipPeak& stretch() const { return stretch_; }
  const ClipPeak& speed() const { return speed_; }
  const ClipPeak& jump() const { return jump_; }
  /// m, the change of motion from frame to frame of the root that changes most, median of all frames.
  double usualChange() const { return quantileOf(changes_, 0.5); }
  /// The largest factor of each root over the clip, of which 95 % are below.
  double mostStretch() const { return quantileOf(stretches_, 0.95); }

 private:
  const std::vector<RootOnSkin>& roots_;
  const std::vector<Vec3>& rest_;
  std::vector<double> stretches_, changes_;
  std::vector<Vec3> before_, steps_;
  ClipPeak stretch_, speed_, jump_;
};

}  // namespace

CheckReport checkClip(const Scene& scene, const std::string& clip, double rate, const MeshQuery& query,
                      const Progress& progress) {
  constexpr double kOfUsual = 8;  // times the usual change of motion
  CheckReport out;
  const SkinnedBody& skinned = *scene.skinned;
  if (isBvh(clip)) checkJoints(skinned.skin(), clip, out);
  const std::vector<RootOnSkin> roots = rootsOnSkin(scene, query);
  out.add(rowOf(CheckSeverity::kOk, "root_joints",
                roots.empty()
                    ? "no root is on the skin"
                    : fmt::format("{} of {} roots are on the skin, by joint: {}", roots.size(),
                                  scene.groom.strands.strands(), carriersText(skinned.skin(), roots)),
                static_cast<double>(roots.size()), "strands", "", ""));
  if (!skinned.hasClip() || roots.empty()) return out;
  const auto whole = static_cast<size_t>(std::ceil(skinned.duration() * rate)) + 1;
  const size_t frames = std::min(whole, kMaxClipFrames);
  RootTracker tracker(scene, roots);
  for (size_t frame = 0; frame < frames; ++frame) {
    reportCheck(progress, "following the skin through the clip",
                static_cast<double>(frame) / static_cast<double>(frames));
    const double seconds = kStartSeconds + static_cast<double>(frame) / rate;
    tracker.see(skinned.surface(seconds, scene.motion ? scene.motion(seconds) : Pose{}), seconds, 1 / rate);
  }
  const std::string of = frames < whole ? fmt::format(" in the first {} of {} frames", frames, whole) : "";
  const auto at = [&](const ClipPeak& peak) {
    return fmt::format("{:.2f} s after the start, {}", peak.seconds, strandAt(scene, peak.strand));
  };
  out.add(rowOf(warnIf(tracker.stretch().value > kSkinStretch), "skin_stretch",
                fmt::format("skin under roots stretches by up to {:.2f} (95 % of the roots below {:.2f}){}",
                            tracker.stretch().value, tracker.mostStretch(), of),
                tracker.stretch().value, "", at(tracker.stretch()),
                "paint the weights there: hair spreads and bunches with the skin"));
  out.add(rowOf(warnIf(tracker.speed().value > kFastRoot), "root_speed",
                fmt::format("roots move at up to {:.2f} m/s{}", tracker.speed().value, of),
                tracker.speed().value, "m/s", at(tracker.speed()),
                "look at the clip there, and at its unit (--clip-unit-meters)"));
  const bool jumps =
      tracker.jump().value > kRootJump && tracker.jump().value > kOfUsual * tracker.usualChange();
  out.add(
      rowOf(warnIf(jumps), "root_jump",
            fmt::format(
                "motion of roots changes by up to {:.1f} mm from one frame to the next, usually {:.2f} mm{}",
                1e3 * tracker.jump().value, 1e3 * tracker.usualChange(), of),
            1e3 * tracker.jump().value, "mm", at(tracker.jump()),
            "smooth the clip there, or cut it: hair overshoots after a jump"));
  return out;
}

// ---- All ----

CheckedScene loadForCheck(SceneOptions options, const Progress& progress) {
  if (options.groom.empty())
    throw Error("no groom file is given", "checking a scene", "name one or more files (GROOM or --groom)");
  options.body_contact = BodyContact::kNone;
  options.primitives.clear();
  options.pins.clear();
  options.materials.clear();
  options.strands = options.vertices = 0;
  options.warns_early = nullptr;
  CheckedScene out;
  out.scene = makeScene(options, progress);
  GroomReadOptions units = options.units;
  units.unit_meters = out.scene.groom.report.unit_meters;
  out.as_read = loadUncleanedGroom(options.groom, units).strands;
  return out;
}

CheckReport checkScene(const CheckedScene& checked, const SceneOptions& options, double rate,
                       const Progress& progress) {
  const Scene& scene = checked.scene;
  reportCheck(progress, "checking the groom", 0);
  CheckReport out = checkGroom(checked.as_read, scene.groom, scene.part_names);
  for (const std::string& warning : scene.warnings)
    if (std::find(scene.groom.report.warnings.begin(), scene.groom.report.warnings.end(), warning) ==
        scene.groom.report.warnings.end())
      out.add({CheckSeverity::kWarning, "reader", warning, 1});
  if (scene.body.empty()) {
    out.add({CheckSeverity::kWarning, "body", "no body is given: roots and contact are not checked", 0, "",
             "", "name the body mesh (BODY or --body)"});
    return out;
  }
  reportCheck(progress, "checking the body", 0);
  const MeshQuery query(scene.body);
  out.add(checkPlacement(scene, options, query));
  out.add(checkBodyMesh(scene.body));
  reportCheck(progress, "checking the roots", 0);
  out.add(checkRoots(scene, query));
  out.add(checkHairInside(scene, query, progress));
  if (scene.skinned)
    out.add(checkClip(scene, options.skinned ? options.skinned->clip : "", rate, query, progress));
  return out;
}

}  // namespace strandcast
