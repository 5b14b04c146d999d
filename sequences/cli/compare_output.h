// What every comparison writes at its end.
#pragma once

#include <string>
#include <vector>

#include "sequences/cli/job.h"
#include "sequences/compare/compare_pictures.h"
#include "sequences/compare/compare_results.h"

namespace eigenlight {

/// Of this program: another build may measure other numbers.
[[nodiscard]] std::string program_hash();

/// crops-NAME.jpg, if the plan has a crop.
void write_crops(const ComparePictures& pictures, const std::string& name, const Job& job);

/// results.json, results.csv, index.html and the tables, which are also printed. `markdown`: as
/// add_markdown_option() leaves it.
void write_comparison(const ComparePlan& plan, const std::vector<CaseResults>& results,
                      std::vector<PageGallery> galleries, const std::string& markdown,
                      const Job& job);

}  // namespace eigenlight
