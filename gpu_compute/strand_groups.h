#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "gl/buffer.h"
#include "gl/program.h"

namespace strandcast::gpu {

/// Programs by name and defines, compiled when first asked for. As long-lived as its context, so that a
/// program serves every model that needs it.
class ProgramCache {
 public:
  /// Throws Error with the driver's log when it does not build.
  const gl::Program& get(const char* name, const char* text, const std::string& defines);

 private:
  std::map<std::string, gl::Program> programs_;
};

/// A program that is looked up at its first use only.
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

/// Invocations of a workgroup of the solvers' programs, at least.
constexpr uint32_t kWorkgroup = 32;
/// Fewer strands of a kind than this are not worth a program of their own where others can do them too.
constexpr size_t kOwnProgram = 512;

/// Strands that one dispatch does.
struct StrandGroup {
  uint32_t key;    ///< what they have in common
  uint32_t first;  ///< in the order of StrandGroups
  uint32_t count;
};

/// The strands of a model sorted by what decides on their program.
class StrandGroups {
 public:
  explicit StrandGroups(std::span<const uint32_t> keys);

  std::span<const StrandGroup> groups() const { return groups_; }
  std::span<const uint32_t> strandsOf(const StrandGroup& group) const {
    return {order_.data() + group.first, group.count};
  }
  /// Strands by group.
  std::span<const uint32_t> order() const { return order_; }

 private:
  std::vector<uint32_t> order_;
  std::vector<StrandGroup> groups_;
};

/// Dispatches `program`, which has `per_workgroup` strands in a workgroup, over so many of them.
void dispatch(const gl::Program& program, uint32_t strands, uint32_t per_workgroup);

}  // namespace strandcast::gpu
