// Reads every source file of the project and fails where an #include violates the dependency direction of
// docs/architecture.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace fs = std::filesystem;

namespace {

using Folders = std::set<std::string>;

// Folders that each folder may include besides itself.
const std::map<std::string, Folders> kAllowed = {
    {"kernels", {}},
    {"core", {"kernels"}},
    {"gl", {"core"}},
    {"light", {"core", "kernels", "io"}},
    {"simd", {"core", "kernels"}},
    {"air", {"core", "kernels"}},
    {"gpu_compute", {"core", "kernels", "gl", "air"}},
    {"collision", {"core", "kernels", "io"}},
    {"io", {"core", "kernels"}},
    {"groom", {"core", "kernels", "io"}},
    {"scenes", {"core", "kernels", "collision", "io", "groom"}},
    {"transport", {"core", "kernels"}},
    {"render", {"core", "kernels", "io", "groom", "light", "transport", "gl"}},
    {"options",
     {"core", "kernels", "light", "air", "collision", "io", "groom", "scenes", "transport", "render"}},
    {"service",
     {"core", "kernels", "simd", "air", "gpu_compute", "collision", "io", "groom", "scenes", "transport",
      "options"}},
    {"validation",
     {"core", "kernels", "light", "air", "gl", "collision", "io", "groom", "scenes", "transport", "render",
      "options", "service"}},
    {"bench",
     {"core", "kernels", "light", "simd", "air", "gl", "gpu_compute", "collision", "io", "groom", "scenes",
      "transport", "render", "options", "service", "validation"}},
    {"examples", {"core", "kernels", "transport"}},
};
const Folders kAnything = {"apps", "tests"};

// A library whose headers only the named folders may include.
struct Confined {
  Folders headers;  ///< first component of the include path
  std::string what;
  Folders folders;  ///< relative to the project root
};
const std::vector<Confined> kConfined = {
    {{"fcl"}, "FCL", {"collision"}},
    {{"fastdds", "fastrtps", "fastcdr"}, "DDS", {"transport"}},
    {{"lcm", "strandcast_v7"}, "LCM", {"transport"}},
    {{"openssl"}, "OpenSSL", {"transport"}},
    {{"epoxy", "GL", "EGL", "GLES2", "GLES3", "KHR"}, "GL", {"gl", "gpu_compute", "render", "apps/viewer"}},
    {{"GLFW", "imgui"}, "the window", {"apps/viewer"}},
    {{"embree3"}, "Embree", {"light"}},
    {{"OpenEXR"}, "OpenEXR", {"io"}},
};

std::string folderOf(const std::string& path) { return path.substr(0, path.find('/')); }

// Path of the line's #include directive, preceded by its opening quote or bracket. Empty without a directive.
std::string included(const std::string& line) {
  size_t at = line.find_first_not_of(" \t");
  if (at == std::string::npos || line[at] != '#') return "";
  at = line.find_first_not_of(" \t", at + 1);
  if (at == std::string::npos || line.compare(at, 7, "include") != 0) return "";
  at = line.find_first_of("\"<", at);
  if (at == std::string::npos) return "";
  const size_t end = line.find_first_of("\">", at + 1);
  return end == std::string::npos ? "" : line.substr(at, end - at);
}

bool isIn(const std::string& path, const Folders& folders) {
  return std::any_of(folders.begin(), folders.end(),
                     [&](const std::string& folder) { return path.rfind(folder + "/", 0) == 0; });
}

// Violations of the rules in the file `path` (relative to the project root), one message each.
std::vector<std::string> violations(const std::string& path, const std::string& text) {
  const std::string folder = folderOf(path);
  const bool free = kAnything.count(folder) > 0;
  std::vector<std::string> found;
  std::istringstream stream(text);
  std::string line;
  size_t number = 0;
  while (std::getline(stream, line)) {
    ++number;
    const std::string include = included(line);
    if (include.empty()) continue;
    const std::string header = include.substr(1);
    const std::string where = path + ":" + std::to_string(number) + " includes " + header;
    const std::string target = folderOf(header);
    if (header.rfind("../", 0) == 0) found.push_back(where + ", which is not a path from the root");
    const bool ours = kAllowed.count(target) > 0 || kAnything.count(target) > 0;
    if (!free && include[0] == '"' && ours && target != folder && kAllowed.at(folder).count(target) == 0)
      found.push_back(where + ", but " + folder + " does not depend on " + target);
    if (folder == "tests") continue;
    for (const Confined& confined : kConfined)
      if (confined.headers.count(target) > 0 && !isIn(path, confined.folders))
        found.push_back(where + ", but " + confined.what + " does not belong in " + folder);
  }
  return found;
}

bool isSource(const fs::path& path) {
  static const Folders kinds = {".h",    ".cc",   ".cpp",  ".inl",  ".c",    ".hpp", ".comp",
                                ".vert", ".frag", ".tesc", ".tese", ".geom", ".glsl"};
  return kinds.count(path.extension().string()) > 0;
}

TEST(Dependencies, PointOneWay) {
  const fs::path root = STRANDCAST_SOURCE_DIR;
  size_t files = 0;
  Folders folders = kAnything;
  for (const auto& [folder, allowed] : kAllowed) folders.insert(folder);
  for (const std::string& folder : folders) {
    if (!fs::is_directory(root / folder)) continue;
    for (const auto& entry :
         fs::recursive_directory_iterator(root / folder, fs::directory_options::follow_directory_symlink)) {
      if (!entry.is_regular_file() || !isSource(entry.path())) continue;
      std::ifstream file(entry.path());
      const std::string text(std::istreambuf_iterator<char>(file), {});
      for (const std::string& violation :
           violations(entry.path().lexically_relative(root).generic_string(), text))
        ADD_FAILURE() << violation;
      ++files;
    }
  }
  EXPECT_GT(files, 50u) << "the sources must be under " << root;
}

TEST(Dependencies, EveryFolderWithSourcesHasARule) {
  const fs::path root = STRANDCAST_SOURCE_DIR;
  const Folders besides = {"build", "cmake", "docs", "demo"};
  for (const auto& entry : fs::directory_iterator(root)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name.front() == '.' || besides.count(name) > 0 || kAnything.count(name) > 0)
      continue;
    bool sources = false;
    for (const auto& inner : fs::recursive_directory_iterator(entry.path()))
      sources |= isSource(inner.path());
    EXPECT_TRUE(!sources || kAllowed.count(name) > 0) << "say what " << name << " may include";
  }
}

// Qualified names of the classes that a header defines.
std::vector<std::string> classesOf(const std::string& text) {
  const std::regex space("namespace ([\\w:]+) \\{.*"),
      definition("(?:class|struct) (?:alignas\\(\\w+\\) )?(\\w+)[^;]*");
  std::vector<std::string> found;
  std::string line, inside;
  for (std::istringstream stream(text); std::getline(stream, line);) {
    std::smatch name;
    if (std::regex_match(line, name, space))
      inside = name[1].str() + "::";
    else if (std::regex_match(line, name, definition))
      found.push_back(inside + name[1].str());
  }
  return found;
}

// Two classes of one name violate the one-definition rule; linkers merge their functions without a
// diagnostic.
TEST(Dependencies, NoTwoHeadersDefineAClassOfOneName) {
  const fs::path root = STRANDCAST_SOURCE_DIR;
  std::map<std::string, std::string> header_of;
  Folders folders = kAnything;
  for (const auto& [folder, allowed] : kAllowed) folders.insert(folder);
  folders.erase("tests");
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      const std::string path = entry.path().lexically_relative(root).generic_string();
      for (const std::string& name : classesOf({std::istreambuf_iterator<char>(file), {}})) {
        const auto [there, is_new] = header_of.emplace(name, path);
        EXPECT_TRUE(is_new) << name << " is in " << there->second << " and in " << path;
      }
    }
  EXPECT_GT(header_of.size(), 100u);
  EXPECT_EQ(classesOf("namespace a::b {\nclass C;\nstruct D : E {\n  struct F {};\n};\n"),
            std::vector<std::string>{"a::b::D"});
}

// Paths that cmake/ClientPackage.cmake lists, which installs them.
Folders publicHeaders() {
  Folders found;
  std::string path;
  for (std::istringstream list(STRANDCAST_PUBLIC_HEADERS); std::getline(list, path, ',');) found.insert(path);
  return found;
}

// Includes of a text that a client cannot make: headers of the project that are not public, and headers of
// libraries but the standard one and Eigen.
std::vector<std::string> privateIncludes(const std::string& text, const Folders& headers) {
  std::vector<std::string> found;
  std::string line;
  for (std::istringstream stream(text); std::getline(stream, line);) {
    const std::string include = included(line);
    if (include.empty()) continue;
    const std::string header = include.substr(1);
    const bool is_library = header.find_first_of("./") == std::string::npos || folderOf(header) == "Eigen";
    if (include[0] == '"' ? headers.count(header) == 0 : !is_library) found.push_back(header);
  }
  return found;
}

TEST(PublicApi, IsWhatIsMarkedAndIncludesNothingElse) {
  const fs::path root = STRANDCAST_SOURCE_DIR;
  const Folders headers = publicHeaders();
  Folders marked;
  for (const auto& [folder, allowed] : kAllowed)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !isSource(entry.path())) continue;
      const std::string path = entry.path().lexically_relative(root).generic_string();
      std::ifstream file(entry.path());
      const std::string text(std::istreambuf_iterator<char>(file), {});
      const bool is_marked = text.rfind("// Public API\n", 0) == 0;
      if (is_marked) marked.insert(path);
      if (!is_marked && folder != "examples") continue;
      for (const std::string& header : privateIncludes(text, headers))
        ADD_FAILURE() << path << " includes " << header << ", which is not public";
    }
  EXPECT_EQ(marked, headers) << "the line // Public API, and the list in cmake/ClientPackage.cmake";

  EXPECT_EQ(
      privateIncludes("#include <vector>\n#include <Eigen/Core>\n#include \"a/b.h\"\n", {"a/b.h"}).size(),
      0u);
  EXPECT_EQ(
      privateIncludes("#include <zstd.h>\n#include <fmt/format.h>\n#include \"a/c.h\"\n", {"a/b.h"}).size(),
      3u);
}

// Words that no source may contain, and why: features that devices and libraries implement differently
// (docs/devices-and-libraries.md). A word matches by its beginning.
const std::vector<std::pair<std::string, std::string>> kDifferent = {
    {"intBitsToFloat(", "a whole number kept as bits of a float may be flushed: small ones are denormals"},
    {"GL_EXT_shader_atomic_float", "sums of floats by atomics differ from run to run"},
    {"GL_NV_shader_atomic_float", "sums of floats by atomics differ from run to run"},
    {"floor(gl_TessCoord", "coordinates are rounded to a grid: add a half"},
    {"GL_LINE_SMOOTH", "nothing is smoothed under multisampling"},
    {"image2D", "some devices have eight image units only: take buffers"},
    {"image3D", "some devices have eight image units only: take buffers"},
    {"imageBuffer", "some devices have eight image units only: take buffers"},
    {"GL_ARB_fragment_shader_interlock", "llvmpipe has none"},
    {"GL_NV_shader_atomic_int64", "llvmpipe has no 64-bit atomics"},
    {"time_based_filter(", "Fast DDS takes a time filter and ignores it"},
    {"KEEP_ALL_HISTORY_QOS", "a slow reader would hold its writer up"},
};

// Whether the code outside of comments has a word that begins with `word`.
bool hasWord(const std::string& text, const std::string& word) {
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const bool begins =
        at == 0 || (std::isalnum(static_cast<unsigned char>(text[at - 1])) == 0 && text[at - 1] != '_');
    const size_t line = text.rfind('\n', at) + 1;
    if (begins && text.substr(line, at - line).find("//") == std::string::npos) return true;
  }
  return false;
}

std::vector<std::string> differences(const std::string& text) {
  std::vector<std::string> found;
  for (const auto& [word, why] : kDifferent)
    if (hasWord(text, word)) found.push_back(word + ": " + why);
  return found;
}

TEST(Sources, UseNothingThatDevicesAndLibrariesDoDifferently) {
  const fs::path root = STRANDCAST_SOURCE_DIR;
  size_t files = 0;
  for (const char* folder : {"core", "gl", "gpu_compute", "render", "transport", "apps/viewer"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !isSource(entry.path())) continue;
      std::ifstream file(entry.path());
      for (const std::string& why : differences({std::istreambuf_iterator<char>(file), {}}))
        ADD_FAILURE() << entry.path().lexically_relative(root).generic_string() << ": " << why;
      ++files;
    }
  EXPECT_GT(files, 100u);
  EXPECT_EQ(differences("float f = intBitsToFloat(n);\nlayout(r32f) uniform image2D grid;\n").size(), 2u);
  EXPECT_EQ(differences("float f = uintBitsToFloat(n);  // not intBitsToFloat(n)\n").size(), 0u);
}

// Tests violations() itself.
TEST(Dependencies, AViolationIsCaught) {
  auto count = [](const std::string& path, const std::string& text) { return violations(path, text).size(); };
  EXPECT_EQ(count("core/a.cc", "#include \"core/b.h\"\n#include \"kernels/c.h\"\n#include <vector>\n"), 0u);
  EXPECT_EQ(count("core/a.cc", "#include \"simd/simd_backend.h\"\n"), 1u);
  EXPECT_EQ(count("kernels/a.h", "  # include \"core/b.h\"\n"), 1u) << "in any spelling";
  EXPECT_EQ(count("transport/a.cc", "#include \"render/renderer.h\"\n"), 1u);
  EXPECT_EQ(count("simd/a.cc", "#include \"gpu_compute/gpu_backend.h\"\n"), 1u);
  EXPECT_EQ(count("render/a.cc", "#include \"apps/window.h\"\n"), 1u);
  EXPECT_EQ(count("groom/a.cc", "#include \"../core/b.h\"\n"), 1u);
  EXPECT_EQ(count("apps/a.cc", "#include \"render/renderer.h\"\n#include \"simd/simd_backend.h\"\n"), 0u);
  EXPECT_EQ(count("groom/a.cc", "#include <fcl/fcl.h>\n"), 1u);
  EXPECT_EQ(count("collision/a.cc", "#include <fcl/fcl.h>\n"), 0u);
  EXPECT_EQ(count("apps/a.cc", "#include <fastdds/dds/domain/DomainParticipant.hpp>\n"), 1u);
  EXPECT_EQ(count("core/a.h", "#include <epoxy/gl.h>\n"), 1u);
  EXPECT_EQ(count("gl/a.h", "#include <epoxy/gl.h>\n"), 0u);
  EXPECT_EQ(count("apps/a.cc", "#include <epoxy/gl.h>\n"), 1u);
  EXPECT_EQ(count("apps/viewer/a.cc", "#include <epoxy/gl.h>\n#include <imgui/imgui.h>\n"), 0u);
  EXPECT_EQ(count("render/a.cc", "#include <imgui/imgui.h>\n"), 1u);
}

}  // namespace
