#include "apps/output_folder.h"

#include "core/error.h"

namespace strandcast {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(const fs::path& folder) {
  std::error_code failed;
  for (fs::path path = folder; !path.empty() && fs::status(path, failed).type() == fs::file_type::not_found;
       path = path.parent_path())
    made_.push_back(path);
  fs::create_directories(folder, failed);
  if (failed) throw Error("the folder cannot be made", folder.string(), failed.message());
}

OutputFolder::~OutputFolder() {
  std::error_code is_used;
  for (const fs::path& path : made_) fs::remove(path, is_used);
}

}  // namespace strandcast
