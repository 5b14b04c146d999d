#include "sequences/compare/compare_cell.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sequences/files/atomic_file.h"
#include "sequences/metrics/figures_json.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json to_json(const Cell& cell) {
  Json json = {
      {"contender", cell.contender},
      {"spp", cell.spp},
      {"cpu_ms",
       {{cell.spp == 0 ? "files" : "render", cell.spp == 0 ? cell.files_ms : cell.render_ms},
        {"denoise", cell.denoise_ms},
        {"total", cell.total_ms()}}},
      {"extra_spp", cell.extra_spp},
      {"memory_mb", cell.memory_mb},
      {"bad_pixels", cell.bad_pixels}};
  if (cell.antialias) {
    json["antialias"] = {{"cpu_ms", cell.antialias->ms},
                         {"reference_cpu_ms", cell.antialias->reference_ms},
                         {"unmatched", cell.antialias->unmatched}};
  }
  json.update(to_json(cell.mean()));
  json["per_frame"] = Json::array();
  for (const FrameFigures& frame : cell.frames) json["per_frame"].push_back(to_json(frame));
  return json;
}

Cell cell_from_json(const Json& json) {
  Cell cell;
  cell.contender = json.at("contender").get<std::string>();
  cell.spp = json.at("spp").get<int>();
  const bool is_recorded = cell.spp == 0;
  (is_recorded ? cell.files_ms : cell.render_ms) =
      json.at("cpu_ms").at(is_recorded ? "files" : "render").get<double>();
  cell.denoise_ms = json.at("cpu_ms").at("denoise").get<double>();
  cell.extra_spp = json.at("extra_spp").get<double>();
  cell.memory_mb = json.at("memory_mb").get<double>();
  cell.bad_pixels = json.at("bad_pixels").get<std::int64_t>();
  if (const auto cost = json.find("antialias"); cost != json.end()) {
    cell.antialias = {cost->at("cpu_ms").get<double>(), cost->at("reference_cpu_ms").get<double>(),
                      cost->at("unmatched").get<double>()};
  }
  for (const Json& frame : json.at("per_frame")) {
    cell.frames.push_back(frame_figures_from_json(frame));
  }
  return cell;
}

CellStore::CellStore(std::filesystem::path directory, const Json& shared)
    : directory_(std::move(directory)), shared_(shared.dump()) {
  std::error_code error;
  std::filesystem::create_directories(directory_, error);
  if (std::filesystem::is_directory(directory_)) return;
  throw std::runtime_error(fmt::format("{}: cannot make the directory: {}", directory_.string(),
                                       error ? error.message() : "Not a directory"));
}

std::filesystem::path CellStore::file(const Json& identity) const {
  const std::string text = shared_ + identity.dump();
  return directory_ / fmt::format("{:016x}.json", XXH3_64bits(text.data(), text.size()));
}

std::optional<Cell> CellStore::load(const Json& identity) const {
  const std::filesystem::path path = file(identity);
  if (!std::filesystem::exists(path)) return std::nullopt;
  try {
    return cell_from_json(Json::parse(read_whole_file(path)));
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // measured again, and the file replaced
  }
}

void CellStore::save(const Json& identity, const Cell& cell) const {
  write_file_atomically(file(identity), to_json(cell).dump(1) + "\n");
}

}  // namespace eigenlight
