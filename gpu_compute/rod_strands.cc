#include "gpu_compute/rod_strands.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/strand_block.h"
#include "gpu_compute/driver.h"
#include "gpu_compute/shaders.h"
#include "kernels/scalar_strands.h"

namespace strandcast::gpu {
namespace {

using Vec4 = std::array<float, 4>;

// Edges per invocation. With four, contact, or factors that differ along curls, exceed the registers: on an
// H100 3.9 ms instead of 2.3 for 100,000 strands on a sphere, 1.70 instead of 1.29 with factors.
constexpr uint32_t kPerThread = 4, kReducedPerThread = 2;

// A group's key: the number of invocations per strand with kPerThread edges each, in the low 6 bits, and
// traits of its strands that decide on the variant of shaders/rod.comp.
constexpr uint32_t kGeneral = 64;    // lengths, masses and stiffnesses may all differ along the strand
constexpr uint32_t kPinned = 128;    // vertices besides the root are pinned
constexpr uint32_t kGroomed = 256;   // StrandModel::hasFactors()
constexpr uint32_t kStraight = 512;  // straight at rest, and only the root is pinned
constexpr uint32_t kTapered = 1024;  // lengths are equal; masses, or of straight strands joints, differ
constexpr uint32_t kCurved = 2048;   // groomed, and factors of damping and friction differ along strands
constexpr uint32_t kUneven =
    4096;  // lengths differ; the ratio of twisting to bending stiffness is constant; only the root is pinned
constexpr uint32_t kKeys = 8192;
uint32_t threadsOf(uint32_t key) { return key & 63; }
constexpr uint32_t kGenericKey = kGeneral | kPinned, kGrooming = kGroomed | kCurved;

// How a group's strands are spread over invocations: PER_THREAD and THREADS of shaders/rod.comp.
struct Spread {
  uint32_t per_thread;  // edges per invocation
  uint32_t threads;     // invocations per strand
};
Spread spreadOf(uint32_t key, bool bodies) {
  const uint32_t threads = threadsOf(key), more = threads * (kPerThread / kReducedPerThread);
  const bool many_values = bodies || (key & (kCurved | kStraight)) == kCurved;
  return many_values && more <= kWorkgroup ? Spread{kReducedPerThread, more} : Spread{kPerThread, threads};
}

// Strands of rare kinds use the generic variant with 8 or 32 invocations per strand. Where compilation is
// slow all of them share the one with 32.
constexpr uint32_t sharedThreads(uint32_t threads) { return threads <= 8 ? 8 : kWorkgroup; }

// Groups of at least this many strands solve those with a stale contact cache in a dispatch of their own. It
// costs 0.03 ms of each substep on an H100, and saves 1.1 ms per step with 100,000 strands.
constexpr uint32_t kMinStaleCacheGroup = 32768;

constexpr GLuint kWholeGroup = 0xFFFFFFFF;  // as in shaders/rod_strand.glsl

// kShapeKinds: by Needs::shape_kinds. kQueryVariants: by shape_kinds + 3 x SORTING of query_contacts.comp.
constexpr std::array<const char*, 3> kShapeKinds = {"#define SHAPE_KINDS 0\n", "#define SHAPE_KINDS 1\n",
                                                    "#define SHAPE_KINDS 2\n"};
constexpr std::array<const char*, 9> kQueryVariants = {
    "#define SHAPE_KINDS 0\n#define SORTING 0\n", "#define SHAPE_KINDS 1\n#define SORTING 0\n",
    "#define SHAPE_KINDS 2\n#define SORTING 0\n", "#define SHAPE_KINDS 0\n#define SORTING 1\n",
    "#define SHAPE_KINDS 1\n#define SORTING 1\n", "#define SHAPE_KINDS 2\n#define SORTING 1\n",
    "#define SHAPE_KINDS 0\n#define SORTING 2\n", "#define SHAPE_KINDS 1\n#define SORTING 2\n",
    "#define SHAPE_KINDS 2\n#define SORTING 2\n"};

/// StrandRest of shaders/rod_work.glsl, which has the units.
struct StrandRest {
  float edge_length, inverse_length, twist_per_bend, shortest, free_mass, arc_length, stiffest, bend,
      root_bend, traits;
};

float restLength(const StrandModel& model, uint32_t edge) {
  return (model.rest_local[edge + 1] - model.rest_local[edge]).norm();
}
uint32_t edgesOf(const StrandModel& model, uint32_t strand) {
  return static_cast<uint32_t>(model.verticesOf(strand)) - 1;
}

bool isPinned(const StrandModel& model, uint32_t strand) {
  for (uint32_t v = model.offsets[strand] + 1; v < model.offsets[strand + 1]; ++v)
    if (model.isPinned(strand, v)) return true;
  return false;
}

StrandRest strandRest(const StrandModel& model, uint32_t strand) {
  const uint32_t first = model.offsets[strand], edges = edgesOf(model, strand);
  const float length = arcLength({model.rest_local.data() + first, edges + 1});
  const float mean = length / static_cast<float>(edges);
  float free_mass = 0, stiffest = 0, shortest = mean;
  for (uint32_t v = first + 1; v <= first + edges; ++v) {
    shortest = std::min(shortest, restLength(model, v - 1));
    if (model.isPinned(strand, v)) continue;
    const float bends_over = std::max(restLength(model, v - 1), kShortestEdge * mean);
    free_mass += model.mass[v];
    stiffest = std::max(stiffest,
                        kernels::f32::stiffnessOf(model.bend[v - 1], 1 / bends_over, 1, 1 / model.mass[v]));
  }
  const RestBends rest = restBends(model, strand);
  const int traits = (rest.uneven ? 1 : 0) + (rest.sharp ? 8 : 0) +
                     (kernels::f32::isCutUnevenly(shortest, mean) ? 2 : 0) +
                     (hangsBetweenPins(model, strand) ? 4 : 0);
  return {mean,
          1 / mean,
          model.twist[first] / model.bend[first],
          kShortestEdge * mean,
          free_mass,
          length,
          stiffest,
          model.bend[first + edges - 1],
          model.bend[first],
          static_cast<float>(traits)};
}

/// edge_rest[] of shaders/rod_strand.glsl: per vertex a row of one, two or four numbers.
std::vector<float> packEdges(const StrandModel& model, size_t row) {
  std::vector<float> edges(row * model.vertices());
  for (uint32_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v + 1 < model.offsets[s + 1]; ++v) {
      const bool pinned = model.isPinned(s, v + 1);
      const Vec4 all = {restLength(model, v), model.twist[v], pinned ? kPinnedMass : model.mass[v + 1],
                        pinned ? 0.0f : 1 / model.mass[v + 1]};
      float* own = edges.data() + row * v;
      if (row == 4) std::copy(all.begin(), all.end(), own);
      if (row == 2) own[0] = all[0];
      own[row - 1] = all[3];
    }
  }
  return edges;
}

// A joint is straight below this rest strain, which is within the rounding of positions: see evenTolerance().
constexpr float kStraightStrain = 1e-4f;
bool isStraight(const StrandModel& model, uint32_t strand) {
  const auto first = model.rest_strain.begin() + model.offsets[strand];
  return std::all_of(first, first + edgesOf(model, strand),
                     [](const Vec3& strain) { return strain.norm() < kStraightStrain; });
}

// kGeneral, kUneven, kTapered or 0. `straight`: 0 also requires equal bending stiffness of joints.
uint32_t unevennessOf(const StrandModel& model, uint32_t strand, bool straight) {
  const StrandRest rest = strandRest(model, strand);
  const float tolerance = evenTolerance(model, strand);
  auto equal = [&](float a, float b) { return std::fabs(a - b) <= tolerance * std::fabs(b); };
  const uint32_t first = model.offsets[strand], tip = model.offsets[strand + 1] - 1;
  uint32_t found = 0;
  for (uint32_t e = first; e < tip; ++e) {
    if (!equal(model.twist[e], rest.twist_per_bend * model.bend[e])) return kGeneral;
    if (!equal(restLength(model, e), rest.edge_length))
      found = kUneven;
    else if (found == 0 && (!equal(model.mass[e + 1], e + 1 < tip ? 1.0f : 0.5f) ||
                            (straight && e > first && !equal(model.bend[e], rest.bend))))
      found = kTapered;
  }
  return found;
}

uint32_t keyOf(const StrandModel& model, uint32_t strand) {
  const uint32_t threads = std::bit_ceil((edgesOf(model, strand) + kPerThread - 1) / kPerThread);
  const bool pinned = isPinned(model, strand);
  const bool straight = !pinned && isStraight(model, strand);
  const bool groomed = model.hasFactors(strand), curved = groomed && !model.friction_along.empty();
  return threads | (pinned ? kGeneral : unevennessOf(model, strand, straight)) | (pinned ? kPinned : 0) |
         (groomed ? kGroomed : 0) | (curved ? kCurved : 0) | (straight ? kStraight : 0);
}

std::vector<uint32_t> keysOf(const StrandModel& model, bool compiles_slowly) {
  std::vector<uint32_t> keys(model.strands());
  std::array<size_t, kKeys> count{};
  for (uint32_t s = 0; s < keys.size(); ++s) ++count[keys[s] = keyOf(model, s)];
  const auto isRare = [&](uint32_t key) { return count[key] < kMinVariantStrands; };
  uint32_t grooming = 0;  // kGrooming bits of all rare kinds
  for (const uint32_t key : keys)
    if (isRare(key)) grooming |= key & kGrooming;
  for (uint32_t& key : keys) {
    if (!isRare(key)) continue;
    key = kGenericKey |
          (compiles_slowly ? kWorkgroup | grooming : sharedThreads(threadsOf(key)) | (key & kGrooming));
  }
  return keys;
}

// STRAND_UNIFORMITY of shaders/rod.comp.
int uniformityOf(uint32_t key, bool goal) {
  if ((key & kGeneral) != 0) return 0;
  return (key & kUneven) != 0 ? 1 : goal || (key & (kTapered | kGroomed)) != 0 ? 2 : 3;
}

// Entry of an empty list in work_: an indirect dispatch of no workgroups, and a count of 0.
constexpr std::array<GLuint, 4> kEmptyDispatch = {0, 1, 1, 0};
constexpr size_t kMaxSubsteps = 64;

// Strands per workgroup of the shaders:
constexpr uint32_t kStrandsPerQuery = 8;      // query_contacts.comp
constexpr uint32_t kRootsPerGroup = 64;       // roots.comp
constexpr uint32_t kClassifyWorkgroup = 128;  // contact_free_strands.comp
constexpr uint32_t kFramesWorkgroup = 32;     // straight_frames.comp
// Workgroups of resolve_penetration.comp, which loop over a list of any length: enough to fill any GPU.
constexpr uint32_t kPenetrationGroups = 2048;

}  // namespace

RodStrands::RodStrands(const StrandModel& model, size_t small_model, bool compiles_slowly)
    : model_(model),
      groups_(keysOf(model, compiles_slowly)),
      small_model_vertices_(small_model),
      compiles_slowly_(compiles_slowly),
      shuffled_(isOneSubgroup(subgroupsOfDevice(), static_cast<int>(kWorkgroup))) {
  std::vector<Vec4> joints(model.vertices());
  std::vector<StrandRest> strands(model.strands());
  for (uint32_t s = 0; s < model.strands(); ++s) {
    strands[s] = strandRest(model, s);
    stiffest_ = std::max(stiffest_, strands[s].stiffest);
    between_pins_ = between_pins_ || hangsBetweenPins(model, s);
    for (uint32_t v = model.offsets[s]; v + 1 < model.offsets[s + 1]; ++v) {
      const Vec3& strain = model.rest_strain[v];
      joints[v] = {strain.x(), strain.y(), strain.z(), model.bend[v]};
    }
  }
  std::vector<uint32_t> work(listAt(List::kPenetrating) + model.strands());
  std::copy(groups_.order().begin(), groups_.order().end(), work.begin());
  work_ = gl::Buffer(std::span<const uint32_t>(work));
  joints_ = gl::Buffer(std::span<const Vec4>(joints));
  strands_ = gl::Buffer(std::span<const StrandRest>(strands));
  for (const StrandGroup& group : groups_.groups()) {
    const std::span<const uint32_t> members = groups_.strandsOf(group);
    const size_t vertices = model.verticesOf(members[0]);
    const bool same = members.size() >= kMinVariantStrands &&
                      std::all_of(members.begin(), members.end(),
                                  [&](uint32_t s) { return model.verticesOf(s) == vertices; });
    edges_of_.push_back(same ? static_cast<uint32_t>(vertices) - 1 : 0);
  }
}

bool RodStrands::anyGroup(uint32_t bits) const {
  const std::span<const StrandGroup> groups = groups_.groups();
  return std::any_of(groups.begin(), groups.end(), [=](const StrandGroup& g) { return (g.key & bits) != 0; });
}

bool RodStrands::isSmallModel(bool bodies) const {
  return model_.vertices() <= (bodies ? small_model_vertices_ / 3 * 2
                                      : small_model_vertices_);  // among bodies a strand needs more threads
}

bool RodStrands::separatesStaleCache(const StrandGroup& group) const {
  return !isSmallModel(true) && group.count >= kMinStaleCacheGroup;
}

bool RodStrands::isStiff(const Needs& needs) const { return kernels::f32::isStiff(stiffest_ * needs.time2); }

bool RodStrands::needsRestShape() const { return anyGroup(kPinned | kGroomed); }

void RodStrands::computeFrames(ProgramCache& programs) {
  if (!frames_stale_) return;
  frames_stale_ = false;
  const gl::Program& find =
      straight_frames_.get(programs, "straight_frames.comp", shaders::kStraightFramesComp);
  work_.bindStorage(5);
  for (const StrandGroup& group : groups_.groups()) {
    if ((group.key & kStraight) == 0) continue;
    glProgramUniform1ui(find.id(), 0, group.first);
    glProgramUniform1ui(find.id(), 1, group.count);
    dispatch(find, group.count, kFramesWorkgroup);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void RodStrands::prepare(bool goal, bool bodies) {
  const uint32_t row = bodies || anyGroup(kGeneral)            ? 4
                       : anyGroup(kUneven)                     ? 2
                       : goal || anyGroup(kTapered | kGroomed) ? 1
                                                               : 0;
  if (row <= edge_row_) return;
  edge_row_ = row;
  edges_ = gl::Buffer(std::span<const float>(packEdges(model_, row)));
}

const gl::Program& RodStrands::compile(size_t group, Motion motion, bool stale_cache, const Needs& needs,
                                       ProgramCache& programs) const {
  const uint32_t key = groups_.groups()[group].key;
  const bool groomed = needs.goal || (key & kGroomed) != 0, curved = (key & kCurved) != 0;
  const bool contact_free = motion == Motion::kContactFree, dense_metric = motion == Motion::kDenseMetric;
  const bool bodies = needs.bodies && !contact_free;
  const bool pinned = (key & kPinned) != 0, shared = compiles_slowly_ && (key & kGenericKey) == kGenericKey;
  const bool stiff = shared || isStiff(needs) || (pinned && between_pins_);
  const bool straight = (key & kStraight) != 0 && !needs.bodies;
  const Spread spread = spreadOf(key, bodies);
  return programs.get(
      "rod.comp", shaders::kRodComp,
      fmt::format(
          "#define PER_THREAD {}\n#define THREADS {}\n#define EDGES {}\n#define STRAND_UNIFORMITY {}\n"
          "#define PINNED {:d}\n#define STRAIGHT {:d}\n"
          "#define CONTACT_FREE {:d}\n#define BODIES {:d}\n#define SHAPE_KINDS {}\n"
          "#define GROOMED {}\n#define DAMPED {:d}\n#define DENSE_METRIC {:d}\n#define STIFF {:d}\n"
          "#define STALE_CACHE {:d}\n#define SHUFFLED {:d}\n#define ACCELERATED {:d}\n",
          spread.per_thread, spread.threads, edges_of_[group], uniformityOf(key, needs.goal), pinned,
          straight, contact_free, bodies, stale_cache ? needs.shape_kinds : 0, curved ? 2 : int{groomed},
          needs.damping, dense_metric, dense_metric && stiff, stale_cache, shuffled_, needs.accelerated));
}

RodStrands::Programs RodStrands::compile(const Needs& needs, ProgramCache& programs) const {
  auto get = [&](size_t group, Motion motion, bool stale_cache) {
    return &compile(group, motion, stale_cache, needs, programs);
  };
  Programs out;
  for (size_t g = 0; g < edges_of_.size(); ++g) {
    const bool apart = needs.bodies && separatesStaleCache(groups_.groups()[g]);
    out.tridiagonal.push_back(isSmallModel(needs.bodies) ? nullptr : get(g, Motion::kTridiagonal, false));
    out.dense_metric.push_back(get(g, Motion::kDenseMetric, needs.bodies && !apart));
    out.stale_cache.push_back(apart ? get(g, Motion::kDenseMetric, true) : nullptr);
  }
  return out;
}

void RodStrands::step(const Needs& needs, int substeps, ProgramCache& programs) {
  const int dispatches = needs.bodies ? substeps : 1;
  if (needs.bodies)
    computeFrames(programs);
  else
    frames_stale_ = frames_stale_ || anyGroup(kStraight);
  Programs& mine = programs_[(needs.bodies ? 1 : 0) + (needs.goal ? 2 : 0) + (needs.accelerated ? 4 : 0) +
                             (needs.damping ? 8 : 0) + 16 * static_cast<size_t>(needs.shape_kinds) +
                             (isStiff(needs) ? 48 : 0)];
  if (mine.dense_metric.empty()) mine = compile(needs, programs);
  work_.bindStorage(5);
  joints_.bindStorage(10);
  if (edges_.bytes() > 0) edges_.bindStorage(11);
  strands_.bindStorage(12);
  if (!needs.bodies && isSmallModel(false)) {  // one variant solves all strands: no lists
    solve(mine, needs, 0, substeps);
    return;
  }
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, work_.id());
  glClearNamedBufferSubData(
      work_.id(), GL_RGBA32UI, static_cast<GLintptr>(contactFreeAt(0) * sizeof(uint32_t)),
      static_cast<GLsizeiptr>((denseMetricAt(0, dispatches) - contactFreeAt(0)) * sizeof(uint32_t)),
      GL_RGBA_INTEGER, GL_UNSIGNED_INT, kEmptyDispatch.data());
  if (!needs.bodies) {
    solve(mine, needs, 0, substeps);
    return;
  }
  const bool sorted = separatesContactFree(needs);
  const auto shape_kinds = static_cast<size_t>(needs.shape_kinds);
  const gl::Program& roots =
      roots_[shape_kinds].get(programs, "roots.comp", shaders::kRootsComp, kShapeKinds[shape_kinds]);
  const gl::Program& resolve = resolve_penetration_[shape_kinds].get(
      programs, "resolve_penetration.comp", shaders::kResolvePenetrationComp, kShapeKinds[shape_kinds]);
  const auto strands = static_cast<uint32_t>(groups_.order().size());
  for (int substep = 0; substep < substeps; ++substep) {
    glProgramUniform1i(roots.id(), 0, substep);
    glProgramUniform1i(roots.id(), 1, sorted);
    dispatch(roots, strands, kRootsPerGroup);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    const size_t variant = shape_kinds + (!sorted ? 0 : substep == 0 ? 3 : 6);
    const gl::Program& query = query_contacts_[variant].get(
        programs, "query_contacts.comp", shaders::kQueryContactsComp, kQueryVariants[variant]);
    glProgramUniform1i(query.id(), 0, substep);
    glProgramUniform1i(query.id(), 1, substep == 0 && !needs.same_bodies);
    dispatch(query, strands, kStrandsPerQuery);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    if (sorted && substep == 0) stepContactFree(needs, substeps, programs);
    solve(mine, needs, substep, substep + 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    glProgramUniform1ui(resolve.id(), 2, static_cast<GLuint>(penetratingCount(substep)));
    glProgramUniform1ui(resolve.id(), 3, static_cast<GLuint>(listAt(List::kPenetrating)));
    glProgramUniform1i(resolve.id(), 4, substep);
    dispatch(resolve, std::min(kPenetrationGroups, strands), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }
}

void RodStrands::stepContactFree(const Needs& needs, int substeps, ProgramCache& programs) {
  const std::span<const StrandGroup> groups = groups_.groups();
  GroupPrograms& mine =
      contact_free_[(needs.goal ? 1 : 0) + (needs.accelerated ? 2 : 0) + (needs.damping ? 4 : 0)];
  for (size_t g = mine.size(); g < groups.size(); ++g)
    mine.push_back(&compile(g, Motion::kContactFree, false, needs, programs));
  const gl::Program& sort =
      contact_free_strands_.get(programs, "contact_free_strands.comp", shaders::kContactFreeStrandsComp);
  for (size_t g = 0; g < groups.size(); ++g) {
    const StrandList contact_free = listed(List::kContactFree, g), near = listed(List::kNear, g);
    glProgramUniform1ui(sort.id(), 0, groups[g].first);
    glProgramUniform1ui(sort.id(), 1, groups[g].count);
    glProgramUniform2ui(sort.id(), 2, contact_free.count, near.count);
    glProgramUniform2ui(sort.id(), 3, contact_free.list, near.list);
    dispatch(sort, groups[g].count, kClassifyWorkgroup);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  for (size_t g = 0; g < groups.size(); ++g) {
    setUniforms(*mine[g], needs, false, g, listed(List::kContactFree, g), listed(List::kNear, g), 0,
                substeps);
    dispatch(*mine[g], groups[g].count, kWorkgroup / spreadOf(groups[g].key, false).threads);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void RodStrands::solve(const Programs& programs, const Needs& needs, int first, int end) const {
  const std::span<const StrandGroup> groups = groups_.groups();
  const bool small_model = isSmallModel(needs.bodies);
  for (size_t g = 0; g < groups.size(); ++g) {
    const gl::Program& program = small_model ? *programs.dense_metric[g] : *programs.tridiagonal[g];
    const StrandList own = separatesContactFree(needs) ? listed(List::kNear, g) : wholeGroup(g);
    setUniforms(program, needs, needs.bodies, g, own, listed(List::kDenseMetric, g, first), first, end);
    dispatch(program, groups[g].count, kWorkgroup / spreadOf(groups[g].key, needs.bodies).threads);
  }
  if (small_model) return;
  auto doAll = [&](const GroupPrograms& left, List list) {
    if (std::all_of(left.begin(), left.end(), [](auto program) { return program == nullptr; })) return;
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    for (size_t g = 0; g < groups.size(); ++g) {
      if (left[g] == nullptr) continue;
      const StrandList own = listed(list, g, first);
      setUniforms(*left[g], needs, needs.bodies, g, own, own, first, end);
      left[g]->use();
      glDispatchComputeIndirect(static_cast<GLintptr>((own.count - 3) * sizeof(uint32_t)));
    }
  };
  doAll(programs.dense_metric, List::kDenseMetric);
  doAll(programs.stale_cache, List::kStaleCache);
}

size_t RodStrands::denseMetricAt(size_t group, int substep) const {
  const size_t all = groups_.groups().size(), dispatches = 2 * all + 1;
  return contactFreeAt(2 * all) + 4 * (dispatches * static_cast<size_t>(substep) + group);
}

size_t RodStrands::listAt(List list, size_t group) const {
  const size_t first = list == List::kPenetrating ? 0 : groups_.groups()[group].first;
  return denseMetricAt(0, kMaxSubsteps) + static_cast<size_t>(list) * groups_.order().size() + first;
}

RodStrands::StrandList RodStrands::listed(List list, size_t group, int substep) const {
  const size_t dispatch = list == List::kContactFree   ? contactFreeAt(group)
                          : list == List::kNear        ? nearAt(group)
                          : list == List::kDenseMetric ? denseMetricAt(group, substep)
                                                       : staleCacheAt(group, substep);
  return {static_cast<GLuint>(dispatch + 3), static_cast<GLuint>(listAt(list, group))};
}

RodStrands::StrandList RodStrands::wholeGroup(size_t group) const {
  return {kWholeGroup, groups_.groups()[group].first};
}

void RodStrands::setUniforms(const gl::Program& program, const Needs& needs, bool bodies, size_t group,
                             StrandList own, StrandList left, int first, int end) const {
  glProgramUniform1ui(program.id(), 0, own.count);
  glProgramUniform1ui(program.id(), 1, own.list);
  glProgramUniform1ui(program.id(), 2, left.count);
  glProgramUniform1ui(program.id(), 3, left.list);
  glProgramUniform1i(program.id(), 4, first);
  glProgramUniform1i(program.id(), 5, end);
  glProgramUniform1ui(program.id(), 10, groups_.groups()[group].count);
  const int uniform = uniformityOf(groups_.groups()[group].key, needs.goal);
  if (!bodies && (uniform == 1 || uniform == 2)) glProgramUniform1ui(program.id(), 11, edge_row_);
  if (!bodies) return;
  const List to = separatesStaleCache(groups_.groups()[group]) ? List::kStaleCache : List::kDenseMetric;
  const StrandList stale_cache = isSmallModel(true) ? own : listed(to, group, first);
  glProgramUniform1ui(program.id(), 6, static_cast<GLuint>(penetratingCount(first)));
  glProgramUniform1ui(program.id(), 7, static_cast<GLuint>(listAt(List::kPenetrating)));
  glProgramUniform1ui(program.id(), 8, stale_cache.count);
  glProgramUniform1ui(program.id(), 9, stale_cache.list);
}

}  // namespace strandcast::gpu
