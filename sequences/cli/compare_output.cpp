#include "sequences/cli/compare_output.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <nlohmann/json.hpp>

#include "sequences/cli/markdown_option.h"
#include "sequences/compare/compare_crops.h"
#include "sequences/compare/compare_markdown.h"
#include "sequences/compare/compare_page.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/ldr_image.h"

namespace eigenlight {
namespace {

constexpr int kCropQuality = 88;

}  // namespace

std::string program_hash() {
  const std::string program = read_whole_file("/proc/self/exe");
  return fmt::format("{:016x}", XXH3_64bits(program.data(), program.size()));
}

void write_crops(const ComparePictures& pictures, const std::string& name, const Job& job) {
  const ComparePlan& plan = pictures.plan;
  if (!plan.crop) return;
  const std::filesystem::path path = plan.directory / fmt::format("crops-{}.jpg", name);
  const std::vector<unsigned char> jpeg = encode_jpeg(crop_rows(pictures), kCropQuality);
  write_file_atomically(path, {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  job.say(fmt::format("{}: {}", path.string(), crop_names(plan)));
}

void write_comparison(const ComparePlan& plan, const std::vector<CaseResults>& results,
                      std::vector<PageGallery> galleries, const std::string& markdown,
                      const Job& job) {
  const std::string json = to_json(plan, results).dump(1) + "\n";
  write_file_atomically(plan.directory / "results.json", json);
  write_file_atomically(plan.directory / "results.csv", to_csv(results));
  write_file_atomically(plan.directory / "index.html",
                        to_html(compare_page(plan, results, std::move(galleries))));
  const std::string tables = to_markdown(plan, results);
  write_markdown(markdown, tables);
  const std::string table =
      fmt::format("{}\n{}\n", to_table(plan, results), (plan.directory / "index.html").string());
  job.print_results(json, is_printed(markdown) ? tables : table);
}

}  // namespace eigenlight
