// What a paper claims, measured again.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "frame/plane.h"
#include "sequences/pages/page.h"

namespace eigenlight {

enum class Verdict { kHeld, kInPart, kNot };

/// "held", "held in part" or "not".
[[nodiscard]] std::string_view to_text(Verdict verdict);

struct PaperClaim {
  std::string where;   ///< `Table 1`
  std::string claim;   ///< in our words
  std::string theirs;  ///< the paper's figure
  std::string ours;    ///< measured
  Verdict verdict = Verdict::kNot;
};

struct PaperReport {
  std::vector<PaperClaim> claims;
  std::vector<PageSection> sections;
};

/// How to rerun a paper.
struct PaperRun {
  Extent extent;            ///< of all that the paper gives no size for
  std::vector<int> frames;  ///< ascending without a gap, 8 or more
  /// Called before each part with what comes next; may throw to end the run.
  std::function<void(const std::string&)> step;
};

struct Paper {
  std::string_view name;      ///< as a user names it
  std::string_view title;     ///< authors, year, title
  std::string_view hardware;  ///< that the paper's figures are of
  PaperReport (*rerun)(const PaperRun&);
  std::string_view size = "128x72";  ///< of PaperRun unless a user says otherwise: a minute or two
};

[[nodiscard]] const std::vector<Paper>& papers();

/// The names of all, with commas.
[[nodiscard]] std::string paper_names();

/// Throws std::invalid_argument listing the known papers if `name` is none.
[[nodiscard]] const Paper& find_paper(std::string_view name);

/// One section a figure or table of the paper, the claims before them.
[[nodiscard]] Page paper_page(const Paper& paper, const PaperRun& run, const PaperReport& report);

/// The paper's title, both sides' hardware and sizes, and the claims as a table in Markdown.
[[nodiscard]] std::string to_markdown(const Paper& paper, const PaperRun& run,
                                      const PaperReport& report);

/// Everything of the page as JSON: paper, hardware, machine, claims, and tables and plots of each
/// section.
[[nodiscard]] std::string paper_json(const Paper& paper, const PaperRun& run,
                                     const PaperReport& report);

}  // namespace eigenlight
