// What a comparison found, for machines and for terminals.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sequences/compare/compare_cell.h"
#include "sequences/compare/compare_plan.h"

namespace eigenlight {

struct CaseResults {
  CompareCase scene;
  std::string title;
  std::uint64_t scene_hash = 0;
  std::string references;   ///< the directory of its references
  std::vector<Cell> cells;  ///< by sample count, then in the order of the contenders

  [[nodiscard]] const Cell* find(const std::string& contender, int spp) const;
  /// The cells of a contender, by sample count.
  [[nodiscard]] std::vector<const Cell*> curve(const std::string& contender) const;
};

/// The time that all are read at, and what each contender's curve says there.
struct EqualTime {
  double ms = 0.0;  ///< plan.equal_time, else total of plan.ours() at its lowest sample count
  std::map<std::string, std::optional<double>> relmse;  ///< error_at_time(), by contender
};
[[nodiscard]] EqualTime equal_time(const ComparePlan& plan, const CaseResults& results);

/// `software`, `machine`, `settings`, and by scene `equal_time` and `cells` (to_json(Cell)).
[[nodiscard]] nlohmann::ordered_json to_json(const ComparePlan& plan,
                                             const std::vector<CaseResults>& results);
/// One line a cell, with a heading; a figure that was not measured is empty. Of recorded frames
/// `render_cpu_ms` is the time of files.
[[nodiscard]] std::string to_csv(const std::vector<CaseResults>& results);
/// For a terminal: a table a scene, at plan.shown_spp().
[[nodiscard]] std::string to_table(const ComparePlan& plan,
                                   const std::vector<CaseResults>& results);

}  // namespace eigenlight
