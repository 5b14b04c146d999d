// A comparison with made-up figures and pictures, without rendering.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sequences/compare/compare_page.h"
#include "sequences/files/ldr_image.h"

namespace eigenlight {

/// Three contenders, frames 4 to 6 after four of history.
inline ComparePlan fake_plan(std::vector<int> spp) {
  ComparePlan plan;
  for (const char* name : {"eigenlight", "mean", "noisy"}) {
    plan.contenders.push_back({name, name, "", {}});
  }
  plan.spp = std::move(spp);
  plan.measured = {4, 5, 6};
  plan.frames = {0, 1, 2, 3, 4, 5, 6};
  plan.extent = {96, 54};
  plan.reference_spp = 64;
  return plan;
}

/// Each contender is four times as bad as the one before, at a quarter of its time and memory.
inline Cell fake_cell(const ComparePlan& plan, std::size_t contender, int spp) {
  const double bad = std::pow(4.0, static_cast<double>(contender));
  Cell cell;
  cell.contender = plan.contenders[contender].label;
  cell.spp = spp;
  cell.render_ms = 100.0 * spp;
  cell.denoise_ms = 40.0 / bad;
  cell.memory_mb = 30.0 / bad;
  for (const int number : plan.measured) {
    FrameFigures frame;
    frame.frame = number;
    for (Figures& figures : frame.sets) {
      figures.pixels = 1000;
      figures[Metric::kRelmse] = 0.01 * bad / spp * (1.0 + 0.1 * number);
      figures[Metric::kMse] = 0.002 * bad / spp;
      figures[Metric::kLight] = 0.49 * bad;
      figures[Metric::kReferenceLight] = 0.5;
      figures[Metric::kPsnr] = 30.0 - std::log(bad);
      figures[Metric::kSsim] = 0.9 / bad;
      if (number > plan.measured.front()) figures[Metric::kTemporalError] = 0.001 * bad / spp;
    }
    cell.frames.push_back(frame);
  }
  return cell;
}

inline CaseResults fake_results(const ComparePlan& plan, const std::string& name) {
  CaseResults results;
  results.scene = {name, name, "none"};
  results.title = "A <made-up> " + name;
  for (const int spp : plan.spp) {
    for (std::size_t i = 0; i < plan.contenders.size(); ++i) {
      results.cells.push_back(fake_cell(plan, i, spp));
    }
  }
  return results;
}

/// Squares of one gray each, a different one for each frame and tile.
inline PageGallery fake_gallery(const ComparePlan& plan) {
  PageGallery gallery{"Pictures", "", plan.measured, {{"crop", "a square"}}, {}};
  gallery.kinds.push_back({"error", "how much", {"rgb(0 0 0)", "rgb(255 255 255)"}, "0", "1"});
  std::vector<std::string> names{"reference"};
  for (const Contender& contender : plan.contenders) names.push_back(contender.label);
  int gray = 20;
  for (const std::string& name : names) {
    GalleryTile tile{name, {{}, {}}};
    for (auto& pictures : tile.pictures) {
      for (std::size_t i = 0; i < plan.measured.size(); ++i) {
        Plane<std::uint8_t> square({32, 32}, 3);
        square.fill(static_cast<std::uint8_t>(gray));
        gray = 20 + (gray + 7) % 220;
        pictures.push_back(jpeg_data_uri(encode_jpeg(square, 80)));
      }
    }
    gallery.tiles.push_back(std::move(tile));
  }
  return gallery;
}

}  // namespace eigenlight
