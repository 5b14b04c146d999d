// Fig. 4 and 6 of Xu 2024: the filter with parts of it left out.
#include <fmt/format.h>

#include <array>

#include "sequences/likeness.h"
#include "sequences/paper_xu2024.h"
#include "sequences/paper_xu2024_uses.h"

namespace eigenlight {
namespace {

constexpr std::array<std::string_view, 3> kScenes{"atrium", "cornell", "gallery"};

// All pixels alike.
template <typename Edge>
struct WithoutRange : Edge {
  [[nodiscard]] float energy(const float*, const float*, float) const { return 0.0f; }
};
// A coarser pixel has the mean of its attributes.
template <typename Edge>
struct WithMeans : Edge {
  static constexpr bool kKeepsMajor = false;
};
// Finer samples never stand in for coarser ones.
template <typename Edge>
struct WithoutCompensation : Edge {
  [[nodiscard]] static float gamma() { return 0.0f; }
};

// Pyramid::process() with one edge-stopping function on the way down, and another on the way up.
template <typename Down, typename Up>
Planes<3> filter(const Down& down, const Up& up, const PyramidInputs& in) {
  const Extent extent = in.weight.extent();
  const int passes = pyramid_passes(kUseRadius);
  auto levels = make_pyramid_levels(extent, Down::kAttributes, passes);
  const auto level = [&](int l) -> PyramidLevel& { return levels[static_cast<std::size_t>(l)]; };
  level(0).attributes.copy_from(in.attributes);
  const Tile all{0, 0, extent.width, extent.height, 0};
  load_pyramid_values(in.signal, in.weight, all, level(0).values);
  for (int l = 0; l < passes; ++l) {
    downsample_pyramid(down, level(l), static_cast<float>(1 << (2 * l)), level(l + 1));
  }
  level(passes).result.copy_from(level(passes).values);
  for (int l = passes; l-- > 0;) {
    PyramidLevel& fine = level(l);
    for (int y = 0; y < fine.values.height(); ++y) {
      for (int x = 0; x < fine.values.width(); ++x) {
        const float* own = fine.attributes.at(x, y);
        if (!up.exists(own)) continue;
        PyramidPass pass = trained_pyramid_table().at(up.radius(own), l);
        pass.gamma *= up.gamma();
        blend_pyramid_pixel(pyramid_energies(up, fine, level(l + 1), {1 << (2 * l), x, y}), pass,
                            levels, {l, x, y});
      }
    }
  }
  Planes<3> out = make_planes<3>(extent);
  store_pyramid_result(level(0).result, all, out);
  return out;
}

// One way to leave something out, or nothing.
struct Omission {
  std::string name;
  double paper_psnr, paper_ssim;  // Fig. 4 or 6
  Likeness mean;
};

void add_likeness(const Frame& frame, std::array<Omission, 5>& parts) {
  using Edge = ReflectionEdge;
  const PyramidUse<Edge> use = reflection_use(frame);
  Planes<3> wanted = make_planes<3>(frame.extent());
  bilateral_filter(use.edge, use.inputs(), wanted);
  const Edge& edge = use.edge;
  const WithMeans<Edge> means{edge};
  const std::array<Planes<3>, 5> found{
      filter(WithoutRange<WithMeans<Edge>>{means}, edge, use.inputs()),
      filter(means, edge, use.inputs()), filter(edge, WithoutRange<Edge>{edge}, use.inputs()),
      filter(edge, WithoutCompensation<Edge>{edge}, use.inputs()),
      filter(edge, edge, use.inputs())};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Likeness one = likeness(found[i], wanted, use.weight);
    parts[i].mean.psnr += one.psnr / static_cast<double>(kScenes.size());
    parts[i].mean.ssim += one.ssim / static_cast<double>(kScenes.size());
  }
}

void claim_parts(const std::array<Omission, 5>& parts, PaperReport& report) {
  const auto claim = [&](const char* where, const char* what, const std::string& theirs,
                         std::size_t without) {
    const double full = parts.back().mean.psnr, less = parts[without].mean.psnr;
    report.claims.push_back({where, what, theirs,
                             fmt::format("{:.2f} against {:.2f} dB", full, less),
                             full > less ? Verdict::kHeld : Verdict::kNot});
  };
  claim("Fig. 4", "closer with the range function on the way down", "43.69 against 28.32 dB", 0);
  claim("Fig. 4", "closer with the major pixel's attributes than with means",
        "43.69 against 41.72 dB", 1);
  claim("Fig. 6", "closer with the range function on the way up", "42.05 against 21.60 dB", 2);
  claim("Fig. 6", "closer with finer samples in place of coarser ones beyond an edge",
        "42.05 against 30.86 dB", 3);
}

}  // namespace

void xu_parts(const PaperRun& run, PaperReport& report) {
  const Extent extent{run.extent.width * kXuPictureScale, run.extent.height * kXuPictureScale};
  std::array<Omission, 5> parts{{{"down: no range function", 28.32, 0.96672, {}},
                                 {"down: means of attributes", 41.72, 0.99514, {}},
                                 {"up: no range function", 21.60, 0.79829, {}},
                                 {"up: no compensation", 30.86, 0.95641, {}},
                                 {"all of it", 42.05, 0.99441, {}}}};
  for (const std::string_view name : kScenes) {
    run.step(fmt::format("Fig. 4 and 6, {}", name));
    const PaperScene scene(name, Perturbation::kNone, extent, PaperScene::View::kFlight);
    add_likeness(scene.render(1, {run.frames.back()}).front(), parts);
  }
  claim_parts(parts, report);
  PageTable table{
      "Reflection against brute force, parts left out",
      "Trained weights, means over three scenes. The paper has other pictures for the "
      "way down (where all of it gets 43.69 dB) and for the way up.",
      "what is left out",
      {{"the paper, dB"}, {"dB", TableColumn::Best::kHighest}, {"the paper, SSIM"}, {"SSIM"}},
      {}};
  for (const Omission& part : parts) {
    table.rows.push_back(
        {part.name, {part.paper_psnr, part.mean.psnr, part.paper_ssim, part.mean.ssim}});
  }
  report.sections.push_back({"Fig. 4 and 6: parts", "", {}, {std::move(table)}, {}});
}

}  // namespace eigenlight
