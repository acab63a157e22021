#include "io/gltf_extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace strandcast {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 2> kMeshopt{"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// Supported extensions.
constexpr std::array<std::string_view, 3> kRead{"KHR_mesh_quantization", "EXT_mesh_gpu_instancing",
                                                "KHR_node_visibility"};
/// Name prefixes of extensions that do not affect a body's surface or motion.
constexpr std::array<std::string_view, 37> kHarmless{"KHR_materials_",
                                                     "EXT_materials_",
                                                     "ADOBE_materials_",
                                                     "MSFT_materials_",
                                                     "FB_materials_",
                                                     "KHR_texture_",
                                                     "EXT_texture_",
                                                     "MSFT_texture_",
                                                     "GOOGLE_texture_",
                                                     "MSFT_packing_",
                                                     "KHR_lights_",
                                                     "EXT_lights_",
                                                     "KHR_techniques_webgl",
                                                     "KHR_xmp",
                                                     "KHR_audio",
                                                     "MSFT_audio",
                                                     "MSFT_lod",
                                                     "KHR_node_selectability",
                                                     "KHR_node_hoverability",
                                                     "KHR_interactivity",
                                                     "KHR_physics_",
                                                     "MSFT_physics",
                                                     "KHR_implicit_shapes",
                                                     "KHR_environment_map",
                                                     "KHR_binary_glTF",
                                                     "KHR_blend",
                                                     "OMI_",
                                                     "VRM",
                                                     "EXT_mesh_features",
                                                     "EXT_instance_features",
                                                     "EXT_structural_metadata",
                                                     "EXT_feature_metadata",
                                                     "EXT_mesh_manifold",
                                                     "CESIUM_primitive_outline",
                                                     "FB_ngon_encoding",
                                                     "AGI_stk_metadata",
                                                     "GODOT_single_root"};
/// Unsupported extensions that change the surface or its motion.
constexpr std::array<std::string_view, 8> kChanging{
    "CESIUM_RTC",        "KHR_animation_pointer",      "EXT_primitive_voxels",       "KHR_gaussian_splatting",
    "AGI_articulations", "KHR_mesh_primitive_restart", "EXT_mesh_primitive_restart", "MPEG_"};

enum class Extension : uint8_t { kIsRead, kIsHarmless, kIsCompression, kIsChanging, kIsUnknown };

Extension meaningOf(std::string_view name) {
  const auto begins = [&](std::string_view with) { return name.starts_with(with); };
  if (std::find(kRead.begin(), kRead.end(), name) != kRead.end()) return Extension::kIsRead;
  if (name == kDraco || std::find(kMeshopt.begin(), kMeshopt.end(), name) != kMeshopt.end())
    return Extension::kIsCompression;
  if (std::any_of(kHarmless.begin(), kHarmless.end(), begins)) return Extension::kIsHarmless;
  if (std::any_of(kChanging.begin(), kChanging.end(), begins)) return Extension::kIsChanging;
  return Extension::kIsUnknown;
}

std::vector<std::string> namesIn(const GltfDocument& document, const char* key) {
  std::vector<std::string> names;
  const auto list = document.root().find(key);
  if (list == document.root().end()) return names;
  if (!list->is_array()) document.fail("this is not an array", key);
  for (const json& name : *list) {
    if (!name.is_string()) document.fail("it holds something that is not a name", key);
    names.push_back(printable(name.get_ref<const std::string&>()));
  }
  return names;
}

}  // namespace

void checkRequiredExtensions(const GltfDocument& document) {
  for (const std::string& name : namesIn(document, "extensionsRequired")) {
    const Extension meaning = meaningOf(name);
    if (meaning == Extension::kIsRead || meaning == Extension::kIsHarmless) continue;
    document.fail(fmt::format("the file requires the extension {}, which is not read", name),
                  "extensionsRequired",
                  meaning == Extension::kIsCompression ? kUncompressed : "export it without that extension");
  }
}

void tellOfAsset(const GltfDocument& document, GltfReport& report) {
  for (const std::string& doubt : document.doubts()) report.warn(doubt);
  for (const std::string& name : namesIn(document, "extensionsUsed")) {
    const Extension meaning = meaningOf(name);
    if (meaning == Extension::kIsChanging) report.leaveOut(fmt::format("the extension {}", name));
    if (meaning == Extension::kIsUnknown) report.leaveOut(fmt::format("the unknown extension {}", name));
  }
}

const json* extensionOf(const json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(name);
  return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

const char* meshoptOf(const json& view) {
  for (const char* name : kMeshopt)
    if (extensionOf(view, name) != nullptr) return name;
  return nullptr;
}

bool isMeshoptFallback(const json& buffer) { return meshoptOf(buffer) != nullptr; }

}  // namespace strandcast
