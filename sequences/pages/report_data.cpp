#include "sequences/pages/report_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

// A JSON object, and where it stands for messages.
struct Record {
  Json json;
  std::string where;
};

Record parse_record(std::string_view text, std::string where) {
  Record record{Json::parse(text, nullptr, false), std::move(where)};
  if (!record.json.is_object()) {
    throw std::runtime_error(fmt::format("{}: expected a JSON object", record.where));
  }
  return record;
}

template <typename T>
T field(const Record& record, const char* pointer) {
  try {
    return record.json.at(Json::json_pointer(pointer)).get<T>();
  } catch (const nlohmann::json::exception&) {
    throw std::runtime_error(fmt::format("{}: field '{}' is missing or of a wrong type",
                                         record.where, std::string_view(pointer).substr(1)));
  }
}

std::vector<Record> read_lines(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  std::vector<Record> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) {
      lines.push_back(parse_record(std::string_view(text).substr(begin, end - begin),
                                   fmt::format("{}: line {}", path.string(), lines.size() + 1)));
    }
    begin = end + 1;
  }
  if (lines.empty()) {
    throw std::runtime_error(fmt::format("{}: no frame is done yet", path.string()));
  }
  return lines;
}

template <typename T>
std::vector<T> column(const std::vector<Record>& lines, const std::string& pointer) {
  std::vector<T> values;
  for (const Record& line : lines) values.push_back(field<T>(line, pointer.c_str()));
  return values;
}

template <typename T>
T total(const std::vector<T>& values) {
  T sum{};
  for (const T value : values) sum += value;
  return sum;
}

Json stages_of(const std::vector<Record>& lines) {
  Json stages = Json::array();
  // Named, because items() does not keep a temporary alive.
  const Json first = field<Json>(lines.front(), "/stages");
  for (const auto& [name, time] : first.items()) {
    const auto wall = column<double>(lines, "/stages/" + name + "/wall_ms");
    const auto cpu = column<double>(lines, "/stages/" + name + "/cpu_ms");
    if (total(wall) == 0.0 && total(cpu) == 0.0) continue;
    stages.push_back({{"name", name}, {"wall_ms", wall}, {"cpu_ms", cpu}});
  }
  return stages;
}

Json skips_of(const std::vector<Record>& lines) {
  constexpr std::pair<const char*, const char*> kNames[] = {
      {"warp", "nothing moved: no reprojection"},
      {"surface", "tiles without a surface"},
      {"filter", "quiet enough: no spatial passes"},
      {"guided", "tiles without young pixels: no guided filter"}};
  Json skips = Json::array();
  for (const auto& [key, name] : kNames) {
    skips.push_back(
        {{"name", name}, {"pixels", column<std::int64_t>(lines, std::string("/skipped/") + key)}});
  }
  return skips;
}

// Shares and ranks exist only where there is a surface.
Json new_shares(const std::vector<Record>& lines) {
  Json shares = Json::array();
  for (const Record& line : lines) {
    const auto surface = field<std::int64_t>(line, "/surface_pixels");
    shares.push_back(surface > 0 ? Json(field<double>(line, "/new_share")) : Json());
  }
  return shares;
}

Json ranks(const std::vector<Record>& lines) {
  Json values = Json::array();
  for (const Record& line : lines) {
    const auto surface = field<std::int64_t>(line, "/surface_pixels");
    values.push_back(surface > 0 ? Json(field<double>(line, "/rank")) : Json());
  }
  return values;
}

std::string rays_per_second(const std::vector<Record>& lines) {
  const auto rays = static_cast<double>(total(column<std::int64_t>(lines, "/rays")));
  const double ms = total(column<double>(lines, "/stages/source/wall_ms")) +
                    total(column<double>(lines, "/stages/resample/wall_ms"));
  return ms > 0.0 && rays > 0.0 ? fmt::format("{:.3g} million", rays / ms / 1e3) : "none traced";
}

Json summary_of(const Record& run, const std::vector<Record>& lines) {
  const auto frames = static_cast<double>(lines.size());
  const auto samples = static_cast<double>(total(column<std::int64_t>(lines, "/samples")));
  const auto surface = static_cast<double>(total(column<std::int64_t>(lines, "/surface_pixels")));
  Json rows = Json::array();
  const auto row = [&](const char* name, const std::string& value) {
    rows.push_back({name, value});
  };
  row("scene", field<std::string>(run, "/scene"));
  row("perturbation", field<std::string>(run, "/perturb"));
  row("method", field<std::string>(run, "/method"));
  row("antialiasing", field<std::string>(run, "/antialias"));
  if (total(column<double>(lines, "/rank")) > 0.0) {
    row("bases", fmt::format("up to {}", field<int>(run, "/bases")));
  }
  row("size", fmt::format("{} × {} pixels", field<int>(run, "/width"), field<int>(run, "/height")));
  row("frames", fmt::format("{} of {} ({})", lines.size(), field<int>(run, "/frame_count"),
                            field<std::string>(run, "/frames")));
  row("samples per pixel", fmt::format("{}", field<int>(run, "/spp")));
  if (surface > 0) row("with resampling", fmt::format("{:.2f} on surfaces", samples / surface));
  row("rays per second", rays_per_second(lines));
  row("rays per frame",
      fmt::format("{:.3g} million",
                  static_cast<double>(total(column<std::int64_t>(lines, "/rays"))) / frames / 1e6));
  row("excluded as NaN or Inf",
      fmt::format("{} pixels, {} samples", total(column<std::int64_t>(lines, "/non_finite_pixels")),
                  total(column<std::int64_t>(lines, "/non_finite_samples"))));
  row("seed", fmt::format("{}", field<std::uint32_t>(run, "/seed")));
  row("software", field<std::string>(run, "/software"));
  return rows;
}

}  // namespace

ReportData read_report_data(const std::filesystem::path& dir) {
  const std::filesystem::path run_path = dir / "run.json";
  const Record run = parse_record(read_whole_file(run_path), run_path.string());
  const std::vector<Record> lines = read_lines(dir / "frames.jsonl");

  ReportData data;
  const auto title = field<std::string>(run, "/title");
  const auto method = field<std::string>(run, "/method");
  data.title =
      fmt::format("{}: {}", title.empty() ? field<std::string>(run, "/scene") : title, method);
  data.frames = column<int>(lines, "/frame");
  data.exposure = field<float>(run, "/exposure");
  data.frames_per_second = field<float>(run, "/frames_per_second");
  data.page = {{"subtitle", "Eigenlight: temporal denoising of path-traced indirect light"},
               {"method", method},
               {"pixels", field<std::int64_t>(run, "/width") * field<std::int64_t>(run, "/height")},
               {"summary", summary_of(run, lines)},
               {"frames", data.frames},
               {"cut", column<bool>(lines, "/cut")},
               {"stages", stages_of(lines)},
               {"new_share", new_shares(lines)},
               {"rank", ranks(lines)},
               {"skips", skips_of(lines)}};
  return data;
}

}  // namespace eigenlight
