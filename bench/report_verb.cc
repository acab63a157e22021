#include "bench/verbs.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/console.h"
#include "bench/performance_page.h"
#include "bench/text_file.h"

namespace strandcast {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  fs::path results = "bench/results", page = "docs/performance.md", images = "docs/images";
  bool check = false;
};

int report(const ReportOptions& o) {
  const PerformancePage page = performancePage(o.results);
  bool same = true;
  const auto put = [&](const fs::path& file, const std::string& text) {
    if (textOf(file) == text) return;
    same = false;
    fmt::print("{} {}\n", o.check ? "differs:" : "written:", file.string());
    if (!o.check) writeText(file, text);
  };
  put(o.page, page.text);
  for (const auto& [name, svg] : page.images) put(o.images / name, svg);
  return o.check && !same ? kExitCheckFailed : 0;
}

}  // namespace

std::function<int()> addReport(CLI::App& app) {
  const auto o = std::make_shared<ReportOptions>();
  app.footer("Run it in the project's root folder: the default paths are relative to it.");
  app.add_option("--results", o->results, "folder with a folder of CSV files per machine")
      ->capture_default_str();
  app.add_option("--page", o->page)->capture_default_str();
  app.add_option("--images", o->images, "folder of the page's plots")->capture_default_str();
  app.add_flag("--check", o->check,
               "write nothing; exit code 1 if a file differs from what would be written");
  return [o] { return report(*o); };
}

}  // namespace strandcast
