#include "bench/text_file.h"

#include <fstream>
#include <iterator>

#include "core/error.h"

namespace strandcast {

std::string textOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void writeText(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw Error("the file cannot be written", file.string(), "check the folder and the disk");
}

}  // namespace strandcast
