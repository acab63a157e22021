#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"

namespace strandcast::gpu {

/// Cache of programs by name and defines, compiled on first use. Lives as long as its context, so that all
/// models share programs.
class ProgramCache {
 public:
  /// The program of compute shader `text` with `defines`; `name` is the key and appears in errors. The
  /// reference is valid as long as the cache. Throws Error with the driver's log if it does not build.
  const gl::Program& get(const char* name, const char* text, const std::string& defines);

 private:
  std::map<std::string, gl::Program> programs_;
};

/// Caches one lookup in a ProgramCache, which must outlive it.
class LazyProgram {
 public:
  const gl::Program& get(ProgramCache& programs, const char* name, const char* text,
                         const char* defines = "") {
    if (found_ == nullptr) found_ = &programs.get(name, text, defines);
    return *found_;
  }

 private:
  const gl::Program* found_ = nullptr;
};

/// Least number of invocations per workgroup of the solvers' shaders.
constexpr uint32_t kWorkgroup = 32;
/// A kind of fewer strands than this gets no shader variant of its own if a more general one can solve it.
constexpr size_t kMinVariantStrands = 512;

/// Strands that one dispatch of one shader variant solves.
struct StrandGroup {
  uint32_t key;    ///< what they have in common: selects the variant
  uint32_t first;  ///< index in StrandGroups::order()
  uint32_t count;
};

/// The strands of a model, sorted by the key that selects their shader variant. Immutable.
class StrandGroups {
 public:
  explicit StrandGroups(std::span<const uint32_t> keys);  ///< one key per strand

  std::span<const StrandGroup> groups() const { return groups_; }
  std::span<const uint32_t> strandsOf(const StrandGroup& group) const {
    return {order_.data() + group.first, group.count};
  }
  /// All strand numbers, group after group.
  std::span<const uint32_t> order() const { return order_; }

 private:
  std::vector<uint32_t> order_;
  std::vector<StrandGroup> groups_;
};

/// Dispatches `program` over `strands` strands, `per_workgroup` of them per workgroup. More than 65,535
/// workgroups continue along y.
void dispatch(const gl::Program& program, uint32_t strands, uint32_t per_workgroup);

}  // namespace strandcast::gpu
