#include "bench/report_verb.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "apps/console.h"
#include "bench/performance_page.h"
#include "core/error.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path results = "bench/results", page = "docs/performance.md", images = "docs/images";
  bool check = false;
};

std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

int report(const Options& o) {
  const PerformancePage page = performancePage(o.results);
  bool same = true;
  const auto put = [&](const fs::path& file, const std::string& text) {
    if (contents(file) == text) return;
    same = false;
    fmt::print("{} {}\n", o.check ? "differs:" : "written:", file.string());
    if (o.check) return;
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush())
      throw Error("the file cannot be written", file.string(), "check the folder and the disk");
  };
  put(o.page, page.text);
  for (const auto& [name, svg] : page.images) put(o.images / name, svg);
  return o.check && !same ? kExitCheckFailed : 0;
}

}  // namespace

std::function<int()> addReport(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.footer("Run it where the project's files are: its paths are from there.");
  app.add_option("--results", o->results, "folders of machines with CSVs")->capture_default_str();
  app.add_option("--page", o->page)->capture_default_str();
  app.add_option("--images", o->images, "folder of its plots")->capture_default_str();
  app.add_flag("--check", o->check, "write nothing; exit code 1 where a file is not as it would be written");
  return [o] { return report(*o); };
}

}  // namespace strandcast
